// zoetrope-chart as a user runs it.

#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "apps/chart/charts.h"
#include "apps/chart/csv.h"
#include "tests/apps/run_program.h"
#include "tests/support/temp_folder.h"

namespace zoe::test {
namespace {

Outcome run_chart(const TempFolder& folder, std::vector<std::string> arguments,
                  const std::vector<std::string>& environment = {}) {
    arguments.insert(arguments.begin(), ZOETROPE_CHART);
    return run_program(arguments, folder.path(), environment);
}

TEST(ChartProgram, ListsAndExplains) {
    const TempFolder folder;
    const Outcome list = run_chart(folder, {"--list"}), help = run_chart(folder, {"--help"});
    EXPECT_EQ(list.exit_code, 0);
    EXPECT_EQ(help.exit_code, 0);
    for (const chart::ChartInfo& info : chart::charts()) {
        EXPECT_NE(list.out.find(info.name), std::string::npos) << info.name;
        EXPECT_NE(list.out.find(info.question), std::string::npos) << info.name;
        EXPECT_NE(help.out.find(info.question), std::string::npos) << info.name;
    }
    EXPECT_NE(help.out.find("--quick"), std::string::npos);
    EXPECT_TRUE(list_files(folder.path()).empty());
}

TEST(ChartProgram, BadOptionsAreOneLineAndCodeTwo) {
    const TempFolder folder;
    const std::pair<std::vector<std::string>, const char*> cases[] = {
        {{"no-such-chart"}, "there are tlas"},
        {{"tlas", "--threads", "0"}, "--threads"},
        {{"tlas", "--threads", "many"}, "--threads"},
        {{"tlas", "--threads", "2000"}, "--threads"},
        {{"tlas", "--peer", "other"}, "embree or none"},
        {{"tlas", "--out", ""}, "--out"},
        {{"--no-such-option"}, "--help"},
    };
    for (const auto& [arguments, reason] : cases) {
        SCOPED_TRACE(arguments.back());
        const Outcome outcome = run_chart(folder, arguments);
        EXPECT_EQ(outcome.exit_code, 2);
        EXPECT_EQ(lines(outcome.err).size(), 1u) << outcome.err;
        EXPECT_NE(outcome.err.find(reason), std::string::npos) << outcome.err;
        EXPECT_TRUE(list_files(folder.path()).empty());
    }
}

TEST(ChartProgram, AFolderThatCannotBeMadeIsRefusedBeforeTheWork) {
    const TempFolder folder;
    folder.write("blocked", "a file");
    const Outcome outcome = run_chart(folder, {"tlas", "--quick", "--out", "blocked/charts"});
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_EQ(lines(outcome.err).size(), 1u) << outcome.err;
    EXPECT_NE(outcome.err.find("blocked"), std::string::npos) << outcome.err;
}

TEST(ChartProgram, WithoutGnuplotThePointsAreThereAndNothingIsMeasuredTwice) {
    const TempFolder folder;
    const std::vector<std::string> arguments = {"degradation", "--quick", "--peer", "none", "--out", "c"};
    const Outcome without = run_chart(folder, arguments, {"PATH=/nowhere"});
    EXPECT_EQ(without.exit_code, 1);
    EXPECT_NE(without.err.find("gnuplot-nox"), std::string::npos) << without.err;
    EXPECT_NE(without.out.find("4 steps measured, 0 kept"), std::string::npos) << without.out;
    EXPECT_EQ(list_files(folder / "c"), (std::vector<std::string>{"degradation.csv", "degradation.gp", "index.html"}));
    const std::optional<chart::Table> table = chart::read_csv(folder / "c/degradation.csv");
    EXPECT_EQ(table->note("command"), "zoetrope-chart degradation --quick --peer none");
    EXPECT_GT(table->rows.size(), 50u);

    if (std::system("gnuplot --version >/dev/null 2>&1") != 0) GTEST_SKIP() << "gnuplot is not installed";
    const Outcome with = run_chart(folder, arguments);
    EXPECT_EQ(with.exit_code, 0) << with.err;
    EXPECT_NE(with.out.find("0 steps measured, 4 kept"), std::string::npos) << with.out;
    EXPECT_EQ(list_files(folder / "c"), (std::vector<std::string>{"degradation.csv", "degradation.gp", "degradation.png",
                                                                  "degradation.svg", "index.html"}));
}

TEST(ChartProgram, InterruptedItLeavesWholeFiles) {
    const TempFolder folder;
    // In the foreground: else it gets the signal twice, as itself and as one of a group, and the second ends it at once.
    const Outcome outcome = run_program({"timeout", "--foreground", "--preserve-status", "--signal=INT", "2", ZOETROPE_CHART,
                                         "far", "--peer", "none", "--out", "c"},
                                        folder.path());
    EXPECT_EQ(outcome.exit_code, 130) << outcome.err;
    EXPECT_NE(outcome.err.find("goes on from here"), std::string::npos) << outcome.err;
    const std::vector<std::string> files = list_files(folder / "c");
    if (!files.empty()) {
        EXPECT_EQ(files, std::vector<std::string>{"far.csv"});
        EXPECT_GT(chart::read_csv(folder / "c/far.csv")->rows.size(), 0u);
    }
}

}  // namespace
}  // namespace zoe::test
