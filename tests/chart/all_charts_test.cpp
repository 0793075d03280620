// What every chart has: points that its axes can show, a picture in which no two series look alike, and a caption that
// follows from the points.

#include <algorithm>
#include <regex>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "apps/bench/peer_embree.h"
#include "apps/chart/charts.h"
#include "apps/chart/csv.h"
#include "apps/chart/gnuplot.h"
#include "apps/chart/measure.h"
#include "apps/chart/style.h"
#include "apps/common/write_file.h"
#include "engine/bvh/build_clusters.h"
#include "engine/math/rng.h"
#include "tests/support/temp_folder.h"

namespace zoe::chart {
namespace {

/// "3.21", "-0.0131", "1,230", "15.2 million".
std::set<std::string> numbers_in(const std::string& text) {
    std::set<std::string> numbers;
    const std::regex number(R"(-?\d[\d,]*(\.\d+)?(e-?\d+)?( million| billion)?)");
    for (std::sregex_iterator it(text.begin(), text.end(), number), end; it != end; ++it) {
        std::string found = it->str();
        while (found.ends_with(',')) found.pop_back();
        numbers.insert(std::move(found));
    }
    return numbers;
}

void add_numbers(const std::string& text, std::set<std::string>* all) {
    all->merge(numbers_in(text));
}

/// Whether x is measured, too, and not where the chart asks.
bool is_price(const Panel& panel) {
    return panel.is_trade || panel.x.unit.starts_with("ns") || panel.x.unit.starts_with("ms");
}

/// What a caption may say that is not measured: names, labels, and places on the axis along which the chart asks.
std::set<std::string> numbers_of_the_question(const Chart& chart) {
    std::set<std::string> numbers;
    for (const Panel& panel : chart.panels) {
        add_numbers(panel.name, &numbers);
        for (const Series& series : panel.series) {
            add_numbers(series.name, &numbers);
            for (const Point& point : series.points) {
                add_numbers(point.label, &numbers);
                if (is_price(panel)) continue;
                add_numbers(short_number(point.x.median), &numbers);
                add_numbers(fmt::format("{}", point.x.median), &numbers);
            }
        }
    }
    return numbers;
}

/// How the charts were made, settings of the engine, and levels that a ring stands at.
std::set<std::string> constants(const std::string& chart) {
    if (chart == "tlas") return {"1", "1,000", fmt::format("{}", ClusterConfig{}.exact_up_to)};
    if (chart == "far") return {"2,208"};
    if (chart == "subdivision") return {"1", "2", "3", "4", "1,000"};
    if (chart == "policy") return {"10"};
    if (chart == "threads") return {"0.05"};
    if (chart == "shutter") return {"0.1", "512"};
    return {};
}

Spread scaled(const Spread& spread, double factor) {
    return {factor * spread.median, factor * spread.low, factor * spread.high};
}

/// The chart's points, all of them measured otherwise.
Table disturbed(const Table& table, const Chart& chart, uint64_t seed) {
    Rng rng(seed);
    Table other = table;
    for (Row& row : other.rows) {
        row.point.y = scaled(row.point.y, rng.uniform(1.3f, 3.0f));
        if (is_price(chart.panel(row.panel))) row.point.x = scaled(row.point.x, rng.uniform(1.3f, 3.0f));
    }
    return other;
}

/// Every number in a caption must change with what was measured. Several times: two of three digits may be equal by chance.
/// folder     where the sweep of `measured` kept its points.
void expect_caption_follows(const ChartInfo& info, const Settings& settings, const test::TempFolder& folder,
                            const Chart& measured) {
    constexpr uint64_t kSeeds = 5;
    const std::filesystem::path file = folder / (std::string(info.name) + ".csv");
    const Table table = *read_csv(file);
    std::set<std::string> kept = numbers_in(measured.caption);
    for (uint64_t seed = 1; seed <= kSeeds; ++seed) {
        write_file(file, to_csv(disturbed(table, measured, seed)));
        Sweep again(settings, folder.path(), {});
        const Chart other = info.make(again);
        EXPECT_EQ(again.measured_count(), 0);
        EXPECT_NE(other.caption, measured.caption);
        const std::set<std::string> now = numbers_in(other.caption);
        std::erase_if(kept, [&](const std::string& number) { return !now.contains(number); });
    }
    std::set<std::string> expected = numbers_of_the_question(measured);
    expected.merge(constants(info.name));
    for (const std::string& number : kept) {
        EXPECT_TRUE(expected.contains(number))
            << number << " stays, whatever was measured (seeds 1 to " << kSeeds << "): " << measured.caption;
    }
}

void expect_points_and_a_picture(const Chart& chart) {
    EXPECT_GT(chart.caption.size(), 50u);
    EXPECT_FALSE(std::regex_search(chart.caption, std::regex(R"(\b(nan|inf)\b)"))) << chart.caption;
    for (const Panel& panel : chart.panels) {
        SCOPED_TRACE(panel.name);
        EXPECT_GE(panel.series.size(), 2u);
        for (const Series& series : panel.series) {
            EXPECT_FALSE(series.points.empty());
            for (const Point& point : series.points) {
                EXPECT_TRUE(!panel.x.is_log || point.x.low > 0.0) << series.name << ' ' << point.x.low;
                EXPECT_TRUE(!panel.y.is_log || point.y.low > 0.0) << series.name << ' ' << point.y.low;
            }
        }
    }
    // In one picture no two series look alike.
    std::set<std::pair<unsigned, int>> looks;
    std::set<std::string> names;
    for (const Panel& panel : chart.panels) {
        for (const Series& series : panel.series) {
            const Style& style = style_of(series.name);
            if (!names.insert(series.name).second) continue;
            EXPECT_TRUE(looks.insert({style.colour, style.shape}).second) << series.name;
        }
    }
    const std::string program = gnuplot_program(chart);
    for (const Panel& panel : chart.panels) EXPECT_NE(program.find(panel.name), std::string::npos) << panel.name;
}

TEST(Charts, AllHavePointsAPictureAndACaptionThatFollows) {
    const Settings settings{.size = Size::kTiny, .has_peer = is_embree_available()};
    for (const ChartInfo& info : charts()) {
        SCOPED_TRACE(info.name);
        const test::TempFolder folder;
        Sweep sweep(settings, folder.path(), {});
        const Chart chart = info.make(sweep);
        sweep.finish(chart, "");
        EXPECT_EQ(chart.name, info.name);
        expect_points_and_a_picture(chart);
        expect_caption_follows(info, settings, folder, chart);
    }
}

TEST(Captions, NumbersAreFound) {
    const std::set<std::string> expected = {"3.21", "-0.5", "1,230", "15.2 million", "6.45e-08", "8", "7"};
    EXPECT_EQ(numbers_in("3.21 times, the power -0.5: 1,230, of 15.2 million (radius 8), 6.45e-08, 7."), expected);
}

}  // namespace
}  // namespace zoe::chart
