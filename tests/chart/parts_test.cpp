// What points become: files that can be read back, programs for gnuplot, a page.

#include <cmath>
#include <fstream>
#include <set>
#include <sstream>

#include <gtest/gtest.h>

#include "apps/chart/chart.h"
#include "apps/chart/csv.h"
#include "apps/chart/gnuplot.h"
#include "apps/chart/layout.h"
#include "apps/chart/measure.h"
#include "apps/chart/page.h"
#include "apps/chart/style.h"
#include "apps/chart/sweep.h"
#include "tests/support/temp_folder.h"

namespace zoe::chart {
namespace {

using test::TempFolder;

Row row(const std::string& step, const std::string& series, double x, double y) {
    return {.step = step, .panel = "p", .series = series, .point = {.x = Spread::exactly(x), .y = {y, 0.5 * y, 2.0 * y}}};
}

Chart small_chart() {
    Chart chart{.name = "small", .question = "Is it 'so' & \"thus\" <b>?"};
    chart.panels = {{.name = "p",
                     .x = {.name = "time", .unit = "ms", .is_log = true},
                     .y = {.name = "cost", .unit = ""},
                     .is_trade = true,
                     .has_labels = true}};
    return chart;
}

std::string read(const std::filesystem::path& file) {
    std::ostringstream text;
    text << std::ifstream(file).rdbuf();
    return text.str();
}

TEST(Spread, IsTheMedianAndTheQuartiles) {
    EXPECT_EQ(spread_of({3.0}), Spread::exactly(3.0));
    EXPECT_EQ(spread_of({5, 1, 4, 2, 3}), (Spread{3, 2, 4}));
    EXPECT_EQ(spread_of({1, 2}), (Spread{1.5, 1.25, 1.75}));
}

TEST(ShortNumber, HasThreeDigitsThatCount) {
    const std::pair<double, const char*> cases[] = {
        {0, "0"},       {0.01234, "0.0123"}, {1.0, "1.00"},       {12.34, "12.3"},
        {123.4, "123"}, {1234, "1,234"},     {-56789, "-56,789"}, {2.5e6, "2.50 million"}};
    for (const auto& [number, text] : cases) EXPECT_EQ(short_number(number), text);
}

TEST(ParetoFront, HasWhatNoOtherBeatsAndNoPeer) {
    Panel panel{.name = "p", .x = {.name = "x"}, .y = {.name = "y"}};
    const auto at = [](double x, double y) { return Point{.x = Spread::exactly(x), .y = Spread::exactly(y)}; };
    panel.series = {{.name = "binned", .points = {at(1, 5), at(2, 6), at(3, 2)}},
                    {.name = "sweep", .points = {at(4, 2), at(3, 4)}},
                    {.name = "Embree LOW", .points = {at(0.5, 0.5)}}};
    EXPECT_EQ(pareto_front(panel), (std::vector<Point>{at(1, 5), at(3, 2)}));
    EXPECT_EQ(names_on_front(panel), "binned");
    panel.y.is_more_better = true;
    EXPECT_EQ(pareto_front(panel), (std::vector<Point>{at(1, 5), at(2, 6)}));
}

TEST(Styles, EachHasANameOfItsOwn) {
    std::set<std::string> names;
    for (const Style& style : styles()) {
        EXPECT_EQ(&style_of(style.name), &style);
        EXPECT_TRUE(names.insert(style.name).second) << style.name;
    }
    EXPECT_THROW(style_of("no such method"), std::logic_error);
}

TEST(Csv, WhatIsWrittenIsReadBack) {
    Table table{.notes = {{"chart", "small"}, {"caption", "1: 2, \"3\""}}, .rows = {row("a, b", "binned", 0.1, 1.0 / 3.0)}};
    table.rows[0].point.label = "say \"so\", twice";
    table.rows[0].point.is_default = true;
    table.rows.push_back(row("", "sweep", 1e-300, 12345678901234567.0));
    const Table read = parse_csv(to_csv(table), "t.csv");
    EXPECT_EQ(read.rows, table.rows);
    EXPECT_EQ(read.notes, table.notes);
    EXPECT_EQ(read.note("no such"), "");
}

TEST(Csv, BrokenFilesAreRefusedWithTheLineAndTheReason) {
    const std::string good = to_csv({.notes = {{"chart", "x"}}, .rows = {row("s", "binned", 1, 2)}});
    const size_t last = good.find('\n', good.find("step,")) + 1;
    const std::string head = good.substr(0, last);
    const std::pair<std::string, const char*> cases[] = {
        {"", "t.csv:0: the heading is missing"},
        {"hello\n", "t.csv:1: not a note"},
        {head + "\"s\",\"p\"\n", "t.csv:3: 2 fields in place of 11"},
        {head + "\"s,p\n", "t.csv:3: a quote is not closed"},
        {head + "s,p,binned,1,1,1,nan,1,1,,0\n", "t.csv:3: 'nan' is not a finite number"},
        {head + "s,p,binned,1,1,1,2,3,4,,0\n", "t.csv:3: a median lies outside"},
        {head + "s,p,binned,1,1,1,2,2,2,,yes\n", "t.csv:3: 'yes' is neither 0 nor 1"},
    };
    for (const auto& [text, reason] : cases) {
        SCOPED_TRACE(reason);
        try {
            parse_csv(text, "t.csv");
            ADD_FAILURE() << "was read";
        } catch (const std::runtime_error& error) {
            EXPECT_NE(std::string(error.what()).find(reason), std::string::npos) << error.what();
        }
    }
    for (size_t size = 0; size < good.size(); ++size) {  // none of them crashes
        try {
            parse_csv(good.substr(0, size), "t.csv");
        } catch (const std::runtime_error&) {
        }
    }
}

/// A sweep of three steps, of which one may throw.
struct ThreeSteps {
    std::vector<std::string> measured;
    std::string broken;

    void run(Sweep& sweep, Chart* chart) {
        std::vector<Step> steps;
        for (const std::string name : {"one", "two", "three"}) {
            steps.push_back(
                {.name = name, .measure = [this, name]() -> std::vector<Row> {
                     if (name == broken) throw std::runtime_error("broken");
                     measured.push_back(name);
                     return {row("", "binned", 4.0 - static_cast<double>(name.size()), 1), row("", "sweep", 1, 2)};
                 }});
        }
        sweep.run(steps, chart);
    }
};

TEST(Sweep, GoesOnWhereItWasInterrupted) {
    const TempFolder folder;
    ThreeSteps steps{.measured = {}, .broken = "three"};
    Chart chart = small_chart();
    Sweep first({}, folder.path(), {{"program", "1"}});
    EXPECT_THROW(steps.run(first, &chart), std::runtime_error);
    EXPECT_EQ(steps.measured, (std::vector<std::string>{"one", "two"}));

    steps.measured.clear();
    steps.broken.clear();
    chart = small_chart();
    Sweep second({}, folder.path(), {{"program", "1"}});
    steps.run(second, &chart);
    EXPECT_EQ(steps.measured, std::vector<std::string>{"three"});
    EXPECT_EQ(second.measured_count(), 1);
    EXPECT_EQ(second.kept_count(), 2);
    ASSERT_EQ(chart.panels[0].series.size(), 2u);
    EXPECT_EQ(chart.panels[0].series[0].points.size(), 3u);

    steps.measured.clear();
    chart = small_chart();
    Sweep other({}, folder.path(), {{"program", "2"}});
    steps.run(other, &chart);
    EXPECT_EQ(steps.measured.size(), 3u) << "points of another program were taken";
    for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
        EXPECT_EQ(entry.path().filename(), "small.csv");
}

TEST(Sweep, MeasuresAnewWhereTheFileIsBroken) {
    const TempFolder folder;
    folder.write("small.csv", "no table\n");
    ThreeSteps steps;
    Chart chart = small_chart();
    Sweep sweep({}, folder.path(), {});
    steps.run(sweep, &chart);
    EXPECT_EQ(steps.measured.size(), 3u);
    EXPECT_EQ(read_csv(folder / "small.csv")->rows.size(), 6u);
}

/// A time that was measured tells nothing of which setting it is of.
TEST(Sweep, PointsFollowOneAnotherByXUnlessThatIsAPrice) {
    const std::vector<Row> rows = {row("", "binned", 3, 1), row("", "binned", 1, 2), row("", "binned", 2, 3)};
    for (const bool is_trade : {false, true}) {
        Chart chart = small_chart();
        chart.panels[0].is_trade = is_trade;
        Sweep({}, {}, {}).run({{.name = "one", .measure = [&] { return rows; }}}, &chart);
        std::vector<double> ys;
        for (const Point& point : chart.panels[0].series[0].points) ys.push_back(point.y.median);
        EXPECT_EQ(ys, is_trade ? std::vector({1.0, 2.0, 3.0}) : std::vector({2.0, 3.0, 1.0}));
    }
}

TEST(MeasureInTurn, EveryWorkHasItsTurnAfterAWarmUp) {
    int a = 0, b = 0;
    const std::vector<std::function<double()>> works = {[&] { return a++; }, [&] { return 10 * b++; }};
    EXPECT_EQ(measure_in_turn(works, 3), (std::vector<std::vector<double>>{{1, 2, 3}, {10, 20, 30}}));
}

TEST(Layout, EverythingHasItsPlaceInThePicture) {
    Chart chart = small_chart();
    chart.columns = 2;
    chart.caption = std::string(1000, 'w') + " and " + std::string(200, 'v');
    chart.panels.resize(3, chart.panels[0]);
    const Layout layout(chart);
    for (size_t k = 0; k < 3; ++k) {
        const Layout::Box box = layout.panel(k);
        EXPECT_TRUE(0.0 < box.left && box.left < box.right && box.right < 1.0);
        EXPECT_TRUE(layout.legend().top < box.bottom && box.bottom < box.top && box.top < layout.question_y());
    }
    EXPECT_GT(layout.panel(0).bottom, layout.panel(2).top);
    EXPECT_GT(layout.caption_y(layout.caption_lines().size() - 1), 0.0);
    EXPECT_EQ(wrap("a bb  ccc", 4), (std::vector<std::string>{"a bb", "ccc"}));
    EXPECT_TRUE(wrap("", 4).empty());
}

TEST(Gnuplot, DrawsAndKeepsTheProgram) {
    if (std::system("gnuplot --version >/dev/null 2>&1") != 0) GTEST_SKIP() << "gnuplot is not installed";
    const TempFolder folder;
    Chart chart = small_chart();
    chart.caption = "It's `so`; $x {a} \"b\" 100 %.";
    chart.panels[0].series = {{.name = "binned", .points = {row("", "", 1, 2).point, row("", "", 3, 4).point}}};
    chart.panels[0].series[0].points[0].label = "\"quoted\" 'label'";
    chart.panels[0].series[0].points[0].is_default = true;
    const std::filesystem::path program = folder.write("it's small.gp", gnuplot_program(chart));
    draw(program);
    EXPECT_EQ(read(folder / "it's small.png").substr(1, 3), "PNG");
    const std::string svg = read(folder / "it's small.svg");
    EXPECT_NE(svg.find("</svg>"), std::string::npos);
    for (const char* const text : {"time [ms]", "the default", "binned", "100 %"})
        EXPECT_NE(svg.find(text), std::string::npos) << text;
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 3) << "temporary files are left";
}

TEST(Gnuplot, ABrokenProgramIsAnErrorThatNamesIt) {
    if (std::system("gnuplot --version >/dev/null 2>&1") != 0) GTEST_SKIP() << "gnuplot is not installed";
    const TempFolder folder;
    const std::filesystem::path program = folder.write("x.gp", "plot no_such_thing(\n");
    try {
        draw(program);
        ADD_FAILURE() << "was drawn";
    } catch (const std::runtime_error& error) {
        EXPECT_NE(std::string(error.what()).find("x.gp"), std::string::npos) << error.what();
    }
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
}

TEST(Page, ShowsEveryChartWithItsCommandAndNothingThatItSaysIsMarkup) {
    const TempFolder folder;
    ThreeSteps steps;
    Chart chart = small_chart();
    Sweep sweep({}, folder.path(), {{"processor", "P<1>"}});
    steps.run(sweep, &chart);
    write_page(folder.path(), {"small"});
    EXPECT_EQ(read(folder / "index.html").find("<section"), std::string::npos) << "a chart that is not done is shown";
    chart.caption = "A & B <i>";
    sweep.finish(chart, "zoetrope-chart small --quick");
    write_page(folder.path(), {"small", "absent"});
    std::string page = read(folder / "index.html");
    for (const char* const text : {"Is it 'so' &amp; &quot;thus&quot; &lt;b&gt;?", "A &amp; B &lt;i&gt;",
                                   "<code>zoetrope-chart small --quick</code>", "P&lt;1&gt;", "Not drawn"})
        EXPECT_NE(page.find(text), std::string::npos) << text;
    EXPECT_EQ(page.find("absent"), std::string::npos);
    folder.write("small.svg", "<svg/>");
    write_page(folder.path(), {"small"});
    page = read(folder / "index.html");
    EXPECT_NE(page.find("<img src=\"small.svg\""), std::string::npos);
    EXPECT_EQ(page.find("Not drawn"), std::string::npos);
}

}  // namespace
}  // namespace zoe::chart
