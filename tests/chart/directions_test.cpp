// What charts say must hold at small size, too: directions, of what depends on counts and never on clocks.

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "apps/chart/charts.h"
#include "apps/chart/measure.h"
#include "apps/chart/rod.h"
#include "engine/math/parallel.h"
#include "tests/chart/tiny_chart.h"

namespace zoe::chart {
namespace {

/// By counted work of rays, of which the sensor sees a prediction only.
TEST(Charts, RebuildsByTheSensorTakeAtMostTwiceTheBestChoice) {
    const Chart chart = make_tiny("policy");
    for (const char* const motion : {"ripple", "walk", "twist", "explosion"}) {
        const auto y = [&](const char* series, double x) { return chart.point(motion, series, x).y.median; };
        for (const char* const series : {"always refitted", "always rebuilt", "by the sensor"})
            EXPECT_GE(y(series, 1.0), 1.0) << motion << ", " << series;
        EXPECT_LE(y("by the sensor", 1.0), 2.0) << motion;
        EXPECT_LE(y("by the sensor", 64.0), 1.05 * y("always refitted", 64.0)) << motion;
    }
}

TEST(Charts, OnlyTheTestThatIsNotWatertightMissesEdges) {
    const Chart chart = make_tiny("triangle");
    const char* const panel = "One test: missed at edges";
    EXPECT_NE(chart.panel(panel).find("ours")->points[0].label, "") << "some were missed";
    EXPECT_GT(y_of(chart, panel, "Moeller-Trumbore"), 1e6);
    const char* const error = "One test: error of t (99 of 100 below)";
    EXPECT_LT(y_of(chart, error, "ours"), y_of(chart, error, "Moeller-Trumbore"));
    EXPECT_NE(chart.panel("Rays through trees: missed at edges").find("ours")->points[0].label, "");
}

TEST(Charts, ErrorsGrowWithTheDistanceUnlessAMatrixOnlyMovesOrTheWorldBeginsThere) {
    const Chart chart = make_tiny("far");
    const Panel& error = chart.panel("Error of where those with the right triangle hit it");
    for (const char* const series : {"instanced, turned", "baked"}) {
        const std::vector<Point>& points = error.find(series)->points;
        for (size_t k = 1; k < points.size(); ++k) EXPECT_GT(points[k].y.median, points[k - 1].y.median) << series;
    }
    for (const char* const series : {"instanced", "re-based, turned"}) {
        for (const Point& point : error.find(series)->points) EXPECT_LT(point.y.median, 1e-6) << series << point.x.median;
    }
}

/// Of a section that follows both joints by halves and so on, linear blending leaves 1 - 2 s (1 - s) (1 - cos a); in the
/// mean over shares from 0 to 1, it loses a third of 1 - cos a.
TEST(Charts, ATwistLosesTheVolumeThatTheFormulaSaysAndNoneByDualQuaternions) {
    const Chart chart = make_tiny("skinning");
    const char* const panel = "Volume lost by a twist";
    const Rod rod(96, 32);
    const double blended = 2.0 * M_PI * 0.25 / rod.volume();  // Of its volume: 2 long, of radius 0.5.
    for (const Point& point : chart.panel(panel).find("linear blend")->points) {
        const double expected = 100.0 * blended * (1.0 - std::cos(glm::radians(point.x.median))) / 3.0;
        EXPECT_NEAR(point.y.median, expected, 0.5) << point.x.median << " degrees";
    }
    EXPECT_GT(chart.panel(panel).find("linear blend")->points.back().y.median, 35.0);
    for (const Point& point : chart.panel(panel).find("dual quaternion")->points) {
        EXPECT_NEAR(point.y.median, 0.0, 0.5) << point.x.median << " degrees";
    }
    const Panel& bend = chart.panel("Volume lost by a bend");
    EXPECT_GT(bend.find("linear blend")->points.back().y.median, bend.find("dual quaternion")->points.back().y.median);
}

TEST(Charts, FinerLevelsAreNearerToTheLimitSurfaceAndThePickedOneIsNearEnough) {
    const Chart chart = make_tiny("subdivision");
    for (const Panel& panel : chart.panels) EXPECT_EQ(panel.series.size(), 6u);
    size_t picked_count = 0;
    for (const Series& series : chart.panels[0].series) {
        const std::vector<Point>& points = series.points;
        ASSERT_EQ(points.size(), 4u) << series.name;
        const bool is_limit = series.name.find("not") == std::string::npos;
        for (size_t k = 0; k < points.size(); ++k) {
            const double error = points[k].y.median;
            if (points[k].is_default) {
                ++picked_count;
                EXPECT_TRUE(is_limit) << series.name;
                EXPECT_LE(error, 1.0) << series.name << ", level " << k + 1;
            }
            // Errors of second order: a quarter a level, but where it is not smooth yet.
            if (k == 0) continue;
            EXPECT_LT(error, (k < 3 ? 1.0 : 0.4) * points[k - 1].y.median) << series.name << ", level " << k + 1;
            EXPECT_GT(error, 0.1 * points[k - 1].y.median) << series.name << ", level " << k + 1;
            EXPECT_DOUBLE_EQ(points[k].x.median, 4.0 * points[k - 1].x.median);
        }
        // Where a crease ends inside of the surface, as the figure's do, the limit is an approximation.
        if (!is_limit || series.name == "figure") continue;
        const std::vector<Point>& refined = chart.panels[0].find(series.name + ", not at the limit")->points;
        for (size_t k = 0; k < points.size(); ++k)
            EXPECT_LT(points[k].y.median, refined[k].y.median) << series.name << ", level " << k + 1;
    }
    EXPECT_GE(picked_count, 1u);
}

TEST(Charts, RefittingCostsNothingAtFirstAndMostWhereMotionScrambles) {
    const Chart chart = make_tiny("degradation");
    const Panel& sah = chart.panel("SAH");
    for (const Series& series : sah.series) EXPECT_DOUBLE_EQ(series.points.front().y.median, 1.0) << series.name;
    const auto worst = [&](const char* series) {
        double most = 0.0;
        for (const Point& point : sah.find(series)->points) most = std::max(most, point.y.median);
        return most;
    };
    EXPECT_GT(worst("explosion"), 1.3);
    EXPECT_GT(worst("explosion"), worst("walk"));
    EXPECT_GT(worst("twist"), worst("ripple"));
    // The explosion comes together again.
    EXPECT_NEAR(sah.find("explosion")->points.back().y.median, 1.0, 0.02);
    EXPECT_LT(worst("twist, rotated"), worst("twist"));
    EXPECT_GT(worst("explosion, rotated"), 1.3) << "rotations do not replace rebuilds";
}

/// The error of a mean of independent samples goes with the power -1/2, and of samples that are spread evenly faster.
TEST(Charts, NoiseGoesWithTheRootOfTheSamples) {
    const Chart chart = make_tiny("picture");
    const Panel& panel = chart.panels[0];
    const Series &random = *panel.find("4 bounces, random"), &spread = *panel.find("4 bounces");
    EXPECT_NEAR(power_of_doubling(random.points), -0.5, 0.05);
    EXPECT_LT(power_of_doubling(spread.points), power_of_doubling(random.points));
    EXPECT_LT(spread.points.back().y.median, random.points.back().y.median);
}

TEST(Charts, LightThatBouncesMoreOftenIsMissedLess) {
    const Chart chart = make_tiny("picture");
    double before = std::numeric_limits<double>::infinity();
    for (const char* const name : {"no bounce", "1 bounce", "2 bounces"}) {
        const double left = chart.panels[0].find(name)->points.back().y.median;
        EXPECT_LT(left, before) << name;
        before = left;
    }
}

/// At equal samples. Lamps are too small for bounces to meet, and mirrors too smooth for rays towards lights: both together
/// are never much worse than the better one.
TEST(Charts, LookingForLightBothWaysIsNoWorseThanEither) {
    const Panel panel = make_tiny("lights").panels[0];
    const Series &both = *panel.find("both ways"), &lights = *panel.find("rays towards lights"),
                 &bounces = *panel.find("bounces alone");
    for (size_t k = 0; k < both.points.size(); ++k) {
        EXPECT_LT(both.points[k].y.median, 1.05 * lights.points[k].y.median) << both.points[k].label;
        EXPECT_LT(both.points[k].y.median, 0.9 * bounces.points[k].y.median) << both.points[k].label;
    }
}

/// At equal samples: coarser levels stand for many samples at once, and what they blur more samples do not bring back.
TEST(Charts, CoarserLevelsSaveSamples) {
    const Panel panel = make_tiny("filtering").panels[0];
    const Series &cones = *panel.find("by ray cones"), &finest = *panel.find("always the finest");
    for (const size_t k : {0u, 1u, 2u}) EXPECT_LT(cones.points[k].y.median, 0.7 * finest.points[k].y.median) << k;
    EXPECT_LT(power_of_doubling(finest.points), power_of_doubling(cones.points));
}

TEST(Charts, MoreSlicesOfTheShutterLeaveLessErrorAndFewSamplesSufferNoneByThem) {
    const Chart chart = make_tiny("shutter");
    const Panel& panel = chart.panel("Samples a pixel");
    const auto left = [&](const char* series) { return panel.find(series)->points.back().y.median; };
    EXPECT_LT(left("4 slices"), left("1 slice"));
    EXPECT_LT(left("16 slices"), 0.5 * left("1 slice"));
    for (const char* const series : {"16 slices", "64 slices"}) {
        const std::vector<Point>& points = panel.find(series)->points;
        EXPECT_LT(points.front().y.median, 1.1 * panel.find("1 slice")->points.front().y.median) << series;
        EXPECT_LT(points.back().y.median, 0.6 * points.front().y.median) << series;
    }
}

TEST(Charts, SamplesWhereTheyAreNeededLeaveTheNoiseThatWasAskedForInNearlyAllBlocks) {
    const Chart chart = make_tiny("noise");
    const Panel &worst = chart.panel("Error that one block in twenty exceeds"),
                &asked = chart.panel("Error: asked for, and there");
    for (const char* const name : {"4 samples at least", "16 samples at least", "64 samples at least"}) {
        const std::vector<Point>&judged = worst.find(name)->points, &had = asked.find(name)->points;
        ASSERT_EQ(judged.size(), had.size());
        for (size_t k = 1; k < had.size(); ++k) EXPECT_GE(judged[k].x.median, judged[k - 1].x.median) << name;
        for (size_t k = 0; k < had.size(); ++k) EXPECT_LT(had[k].y.median, 1.5 * had[k].x.median) << name;
    }
    // Where all pixels get as many as those got in the mean, or a few less, such blocks are noisier.
    const Point& finest = worst.find("16 samples at least")->points.back();
    const std::vector<Point>& uniform = worst.find("all the same")->points;
    const auto more = std::ranges::find_if(uniform, [&](const Point& u) { return u.x.median >= finest.x.median; });
    ASSERT_TRUE(more != uniform.end() && more != uniform.begin());
    EXPECT_LT(finest.y.median, 0.9 * std::prev(more)->y.median);
}

/// Smoothing takes a third of the error of a sample and more (of larger pictures, more than half), whatever its bounces,
/// and more samples take more.
TEST(Charts, SmoothingTakesMostOfTheErrorOfASample) {
    const Chart chart = make_tiny("denoise");
    const Panel& panel = chart.panels[0];
    const double raw = panel.find("4 bounces")->points.front().y.median;
    for (const char* const name : {"2 bounces, smoothed", "4 bounces, smoothed"}) {
        const std::vector<Point>& points = panel.find(name)->points;
        EXPECT_LT(1.5 * points.front().y.median, raw) << name;
        EXPECT_LT(points.back().y.median, points.front().y.median) << name;
    }
}

/// Coarse light that is put on finer surfaces has less error than light that is stretched.
TEST(Charts, FinerSurfacesTakeErrorFromCoarseLight) {
    const Chart chart = make_tiny("upsample");
    const auto error = [&](const char* series, const char* label) {
        const std::vector<Point>& points = chart.panels[0].find(series)->points;
        return std::ranges::find(points, label, &Point::label)->y.median;
    };
    for (const char* const label : {"4", "5", "6", "8", "10", "12"}) {
        for (const char* const series : {"on surfaces of half", "on full surfaces"})
            EXPECT_LT(error(series, label), error("stretched", label)) << series << ", " << label;
    }
}

/// Where a clip goes far from its first frame, a tree that was built over more of it serves it better.
TEST(Charts, TreesOverAClipServeItBetterThanThoseOfItsFirstFrame) {
    const Chart chart = make_tiny("clip");
    const auto mean = [&](const char* motion, double poses) {
        return chart.point(chart.panels[0].name, motion, poses).y.median;
    };
    EXPECT_LT(mean("twist", 8), 0.9 * mean("twist", 1));
    for (const char* const motion : {"ripple", "walk"}) EXPECT_LT(mean(motion, 8), 1.05 * mean(motion, 1)) << motion;
}

/// The one thing of it that no clock tells: what is beside what.
TEST(Charts, OneThreadIsAsFastAsItself) {
    const Chart chart = make_tiny("threads");
    EXPECT_EQ(chart.panels.size(), 3u);
    for (const Panel& panel : chart.panels) {
        for (const Series& series : panel.series) {
            EXPECT_EQ(series.points.front().x.median, 1.0) << panel.name << ", " << series.name;
            EXPECT_EQ(series.points.front().y.median, 1.0) << panel.name << ", " << series.name;
            EXPECT_EQ(series.points.back().x.median, thread_count()) << panel.name << ", " << series.name;
        }
        for (const Point& point : panel.find("ideal")->points) EXPECT_EQ(point.y.median, point.x.median);
    }
}

}  // namespace
}  // namespace zoe::chart
