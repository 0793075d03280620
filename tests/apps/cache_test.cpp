// --cache and --no-cache, as a user meets them.

#include <filesystem>
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/apps/run_program.h"
#include "tests/support/temp_folder.h"

namespace zoe::test {
namespace {

namespace fs = std::filesystem;

/// One small picture of a scene whose tree takes long to build.
std::vector<std::string> demo(const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"static-30000", "--headless", "--frames", "0",       "--size",
                                          "32x18",        "--spp",      "1",        "--stats", "stats.json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
}

/// The only frame of the last run.
nlohmann::json stats(const TempFolder& folder) {
    std::ifstream file(folder / "stats.json");
    return nlohmann::json::parse(file)["frames"][0];
}

size_t file_count(const fs::path& folder) {
    return fs::exists(folder) ? static_cast<size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()))
                              : 0;
}

TEST(Cache, SecondRunReadsWhatTheFirstOneKept) {
    const TempFolder folder;
    const Outcome first = run_demo(folder.path(), demo({"--cache", "trees"}));
    ASSERT_EQ(first.exit_code, 0) << first.err;
    const nlohmann::json before = stats(folder);
    EXPECT_GT(before["stored"].get<int>(), 0);
    EXPECT_EQ(before["loaded"], 0);
    EXPECT_NE(first.out.find("trees: 0 read from the cache"), std::string::npos) << first.out;
    EXPECT_EQ(file_count(folder / "trees"), before["stored"].get<size_t>());

    const Outcome second = run_demo(folder.path(), demo({"--cache", "trees"}));
    ASSERT_EQ(second.exit_code, 0) << second.err;
    const nlohmann::json after = stats(folder);
    EXPECT_EQ(after["loaded"], before["stored"]);
    EXPECT_EQ(after["stored"], 0);
    EXPECT_EQ(after["hits_hash"], before["hits_hash"]);
    EXPECT_EQ(second.err, first.err) << "no more warnings than without";

    const Outcome without = run_demo(folder.path(), demo({"--no-cache"}));
    ASSERT_EQ(without.exit_code, 0) << without.err;
    EXPECT_EQ(stats(folder)["loaded"], 0);
    EXPECT_EQ(stats(folder)["stored"], 0);
    EXPECT_EQ(stats(folder)["hits_hash"], before["hits_hash"]);
}

TEST(Cache, IsTheUsersUnlessTold) {
    const TempFolder folder;
    const auto run = [&](const std::vector<std::string>& environment, const std::vector<std::string>& more) {
        std::vector<std::string> arguments = demo(more), variables = environment;
        arguments.insert(arguments.begin(), ZOETROPE_DEMO);
        variables.insert(variables.end(), {"DISPLAY", "WAYLAND_DISPLAY"});
        const Outcome outcome = run_program(arguments, folder.path(), variables);
        EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    };
    const std::string home = "HOME=" + (folder / "home").native(), cache = "XDG_CACHE_HOME=" + (folder / "cache").native();
    run({home, cache}, {"--no-cache"});
    run({"HOME", "XDG_CACHE_HOME"}, {});
    EXPECT_FALSE(fs::exists(folder / "home"));
    EXPECT_FALSE(fs::exists(folder / "cache"));
    run({home, cache}, {});
    EXPECT_FALSE(fs::exists(folder / "home"));
    EXPECT_GT(file_count(folder / "cache/zoetrope"), 0u);
    run({home, "XDG_CACHE_HOME"}, {});
    EXPECT_GT(file_count(folder / "home/.cache/zoetrope"), 0u);
}

TEST(Cache, WhateverIsWrongWithItIsAWarning) {
    const TempFolder folder;
    ASSERT_EQ(run_demo(folder.path(), demo({"--no-cache"})).exit_code, 0);
    const nlohmann::json expected = stats(folder)["hits_hash"];
    const auto expect_warning = [&](const std::string& cache, const std::string& text) {
        SCOPED_TRACE(cache);
        const Outcome outcome = run_demo(folder.path(), demo({"--cache", cache}));
        EXPECT_EQ(outcome.exit_code, 0);
        EXPECT_NE(outcome.err.find("zoetrope-demo: warning: tree cache " + cache), std::string::npos) << outcome.err;
        EXPECT_NE(outcome.err.find(text), std::string::npos) << outcome.err;
        EXPECT_EQ(stats(folder)["hits_hash"], expected);
    };
    folder.write("file", "someone's");
    expect_warning("file", "no more trees are kept");
    expect_warning("/proc/zoetrope", "no more trees are kept");

    ASSERT_EQ(run_demo(folder.path(), demo({"--cache", "trees"})).exit_code, 0);
    ASSERT_GT(file_count(folder / "trees"), 0u);
    for (const fs::directory_entry& entry : fs::directory_iterator(folder / "trees")) {
        std::ofstream(entry.path(), std::ios::binary) << "garbage, longer than a header would be: " << std::string(100, 'x');
    }
    expect_warning("trees", "is not a tree");
    ASSERT_EQ(run_demo(folder.path(), demo({"--cache", "trees"})).exit_code, 0);
    EXPECT_GT(stats(folder)["loaded"].get<int>(), 0) << "the garbage was replaced";
}

}  // namespace
}  // namespace zoe::test
