// Ticks and labels: as many as do not touch.

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "apps/chart/labels.h"
#include "apps/chart/layout.h"
#include "engine/math/rng.h"

namespace zoe::chart {
namespace {

Panel labelled() {
    return {.name = "p",
            .x = {.name = "time", .unit = "ms", .is_log = true},
            .y = {.name = "cost", .unit = ""},
            .has_labels = true};
}

TEST(Layout, AxesHaveTicksThatDoNotTouch) {
    Panel panel = labelled();
    for (const double end : {1.5, 3.0, 1e3, 1e9}) {
        panel.series = {
            {.name = "binned", .points = {{.x = Spread::exactly(1.0), .y = {}}, {.x = Spread::exactly(end), .y = {}}}}};
        for (const bool is_log : {true, false}) {
            panel.x.is_log = is_log;
            const Scale scale = x_scale(panel, 210.0);
            EXPECT_LT(scale.begin, 1.0);
            EXPECT_GT(scale.end, end);
            EXPECT_GE(scale.ticks.size(), 2u) << end << is_log;
            EXPECT_LE(scale.ticks.size(), 10u) << end << is_log;
            for (size_t k = 1; k < scale.ticks.size(); ++k) {
                const Tick &a = scale.ticks[k - 1], &b = scale.ticks[k];
                EXPECT_GT(210.0 * (scale.share(b.at) - scale.share(a.at)), 3.0 * double(a.text.size() + b.text.size()))
                    << a.text << " and " << b.text;
            }
        }
    }
    panel.x.is_log = false;
    panel.series = {
        {.name = "binned", .points = {{.x = Spread::exactly(0.0831), .y = {}}, {.x = {0.1, 0.1, 0.12}, .y = {}}}}};
    std::string texts;
    for (const Tick& tick : x_scale(panel, 210.0).ticks) texts += tick.text + ' ';
    EXPECT_EQ(texts, "0.08 0.09 0.1 0.11 0.12 ");
    panel.series = {
        {.name = "binned", .points = {{.x = Spread::exactly(999.6), .y = {}}, {.x = Spread::exactly(1000.4), .y = {}}}}};
    for (const Tick& tick : x_scale(panel, 210.0).ticks) {
        EXPECT_TRUE(tick.at < 1000.0 ? tick.text.starts_with("999") : tick.text.starts_with("1,00")) << tick.text;
    }
}

/// As they are drawn: 8 points, 6 pixels a character.
TEST(Labels, CoverNeitherEachOtherNorPoints) {
    Panel panel = labelled();
    Rng rng(3);
    Series series{.name = "binned", .points = {}};
    for (int k = 0; k < 30; ++k) {
        // Half of them in a heap.
        const double spread = k % 2 ? 1.0 : 0.02;
        series.points.push_back({.x = Spread::exactly(1.0 + spread * rng.uniform()),
                                 .y = Spread::exactly(5.0 + spread * rng.uniform()),
                                 .label = std::to_string(1000 + k)});
    }
    panel.series = {series};
    constexpr double kWidth = 374.0, kHeight = 260.0;
    const Scale x = x_scale(panel, kWidth), y = y_scale(panel, kHeight);
    const std::vector<PlacedLabel> labels = place_labels(panel, x, y, kWidth, kHeight);
    EXPECT_GE(labels.size(), 20u);
    for (const PlacedLabel& label : labels) {
        const auto is_near = [&](double other_x, double other_y, double width, double height) {
            return std::abs(other_x - label.x) * kWidth < width && std::abs(other_y - label.y) * kHeight < height;
        };
        EXPECT_TRUE(label.x * kWidth >= 12.0 && label.x * kWidth <= kWidth - 12.0) << label.text;
        EXPECT_TRUE(label.y * kHeight >= 6.0 && label.y * kHeight <= kHeight - 6.0) << label.text;
        for (const PlacedLabel& other : labels)
            EXPECT_TRUE(&other == &label || !is_near(other.x, other.y, 23.9, 11.9)) << label.text << " on " << other.text;
        for (const Point& point : series.points)
            EXPECT_FALSE(is_near(x.share(point.x.median), y.share(point.y.median), 16.0, 10.0)) << label.text;
    }
}

TEST(Labels, OfDefaultsThatCoincideAreLeftOut) {
    Panel panel = labelled();
    panel.series = {{.name = "binned",
                     .points = {Point{.x = Spread::exactly(1), .y = Spread::exactly(2)},
                                Point{.x = Spread::exactly(3), .y = Spread::exactly(4)}}},
                    {.name = "sweep", .points = {Point{.x = Spread::exactly(1), .y = Spread::exactly(2)}}}};
    for (Series& series : panel.series)
        for (Point& point : series.points) point.label = series.name;
    const Scale x = x_scale(panel, 300.0), y = y_scale(panel, 300.0);
    EXPECT_EQ(place_labels(panel, x, y, 300.0, 300.0).size(), 3u);
    panel.series[0].points[0].is_default = true;
    EXPECT_EQ(place_labels(panel, x, y, 300.0, 300.0).size(), 3u) << "a default with a label of its own";
    panel.series[1].points[0].is_default = true;
    EXPECT_EQ(place_labels(panel, x, y, 300.0, 300.0).size(), 1u);
}

}  // namespace
}  // namespace zoe::chart
