// What the charts of builders say must hold at small size, too: directions, of what depends on counts and never on clocks.

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include <gtest/gtest.h>

#include "apps/chart/builders.h"
#include "apps/chart/charts.h"
#include "apps/common/open_scene.h"
#include "engine/bvh/build_clusters.h"
#include "engine/math/rng.h"
#include "tests/chart/tiny_chart.h"

namespace zoe::chart {
namespace {

std::vector<Aabb> scattered_boxes(size_t count, Rng& rng) {
    std::vector<Aabb> boxes(count);
    for (Aabb& box : boxes) {
        const glm::vec3 place(rng.uniform(), rng.uniform(), rng.uniform());
        box = {place, place + 0.02f * glm::vec3(rng.uniform(), rng.uniform(), rng.uniform())};
    }
    return boxes;
}

/// Tighter boxes and opened instances are there to save nodes. Two in a hundred is what another tree over them may lose.
TEST(TreeCharts, TightBoxesAndOpenedInstancesSaveNodes) {
    const Chart chart = make_tiny("placing");
    for (const char* const scene : {"instances-100: nodes", "default: nodes", "mixed-1: nodes"}) {
        const double plain = y_of(chart, scene, "turned boxes");
        for (const char* const series : {"tight boxes", "turned boxes, opened", "tight boxes, opened"})
            EXPECT_LE(y_of(chart, scene, series), 1.02 * plain) << scene << ", " << series;
    }
    EXPECT_LE(y_of(chart, "instances-100: nodes", "tight boxes"),
              0.97 * y_of(chart, "instances-100: nodes", "turned boxes"));
}

/// Clustered to the top, both are greedy, and neither is the better one everywhere: over boxes scattered evenly, trees of
/// the exact form cost up to 9 % more than those of the fast one, less over few. A binned top makes the fast one's cheaper.
TEST(TreeCharts, ExactAndFastClusteringAreWorthNearlyTheSame) {
    for (const uint64_t seed : {1, 2, 3, 4, 5}) {
        SCOPED_TRACE(::testing::Message() << "seed " << seed);
        Rng rng(seed);
        const std::vector<Aabb> boxes = scattered_boxes(1500, rng);
        PlocScratch scratch;
        const double exact = sah_cost(build_agglomerative(boxes));
        for (const uint32_t radius : {2u, 8u, 32u}) {
            const auto cost = [&](const PlocConfig& config) { return sah_cost(build_ploc(boxes, config, {}, &scratch)); };
            const double fast = cost({.search_radius = radius, .top_count = 1});
            EXPECT_LE(exact, 1.12 * fast) << "radius " << radius;
            EXPECT_LE(fast, 1.12 * exact) << "radius " << radius;
            EXPECT_LE(cost({.search_radius = radius}), 0.99 * fast) << "radius " << radius;
        }
    }
}

TEST(TreeCharts, MoreBinsAreNeverWorseInTheMean) {
    std::vector<MeshSample> samples;
    for (const char* const scene : {"static-30000", "deforming-60", "arbitrary-10000"})
        samples.push_back(sample_mesh({.scene = scene, .motion = Motion::kStatic, .side = 8}));
    double before = std::numeric_limits<double>::infinity();
    for (const int bin_count : {4, 8, 16, 32, 64}) {
        double product = 1.0;
        for (const MeshSample& sample : samples) {
            Blas blas;
            BlasScratch scratch;
            binned(bin_count).build(sample.mesh, &blas, &scratch);
            product *= sah_cost(blas.tree, 1.0f);
        }
        const double mean = std::cbrt(product);
        EXPECT_LE(mean, 1.02 * before) << bin_count << " bins";
        before = std::min(before, mean);
    }
}

TEST(TreeCharts, BinnedWithTheDefaultBinsIsTheEnginesOwn) {
    const MeshSample sample = sample_mesh(mesh_subjects({.size = Size::kTiny})[0]);
    Blas ours, engines;
    BlasScratch scratch;
    binned(blas_binned_config().bin_count).build(sample.mesh, &ours, &scratch);
    builder(BlasBuilder::kBinned).build(sample.mesh, &engines, &scratch);
    ASSERT_EQ(ours.tree.nodes.size(), engines.tree.nodes.size());
    EXPECT_EQ(std::memcmp(ours.tree.nodes.data(), engines.tree.nodes.data(), ours.tree.nodes.size() * sizeof(WideNode)), 0);
}

TEST(TreeCharts, TheDefaultBuilderIsWhatTheEngineUses) {
    for (const MeshSubject& subject : mesh_subjects({.size = Size::kTiny})) {
        SCOPED_TRACE(subject.scene);
        Content content = open_scene(subject.scene, 24.0);
        content.scene.clip_poses = 1;  // Trees over several poses have a chart of their own.
        const Tlas& tlas = advance(content, 0.0, nullptr);
        uint64_t triangle_count = 0;
        for (const Instance& instance : tlas.instances) triangle_count += instance.mesh->corners.size();
        for (const Instance& instance : tlas.instances) {
            EXPECT_EQ(instance.motion, subject.motion);
            Blas blas;
            build_blas(instance.positions, instance.mesh->corners, default_builder(subject.motion, triangle_count), &blas);
            const auto& nodes = instance.blas->tree.nodes;
            ASSERT_EQ(blas.tree.nodes.size(), nodes.size());
            EXPECT_EQ(std::memcmp(blas.tree.nodes.data(), nodes.data(), nodes.size() * sizeof(WideNode)), 0);
        }
    }
}

TEST(TreeCharts, BetterBuildersMakeBetterTrees) {
    const Chart chart = make_tiny("builders");
    for (const MeshSubject& subject : mesh_subjects({.size = Size::kTiny})) {
        SCOPED_TRACE(subject.scene);
        const auto sah = [&](const char* series) { return y_of(chart, (subject.scene + ": SAH").c_str(), series); };
        EXPECT_LT(sah("binned"), sah("median split"));
        EXPECT_LE(sah("sweep"), 1.03 * sah("binned"));
        EXPECT_LE(sah("reinserted"), 1.01 * sah("sweep"));
        EXPECT_LT(sah("SBVH"), sah("median split"));
        const auto nodes = [&](const char* series) {
            return y_of(chart, (subject.scene + ": nodes a ray visits").c_str(), series);
        };
        EXPECT_LT(nodes("reinserted"), nodes("median split"));
    }
}

TEST(TreeCharts, WhatABuilderTakesInAllIsNeverLessThanTheBest) {
    const Chart chart = make_tiny("pays-off");
    for (const Panel& panel : chart.panels) {
        for (const Series& series : panel.series)
            for (const Point& point : series.points) EXPECT_GE(point.y.median, 1.0) << panel.name << ' ' << series.name;
        EXPECT_GT(panel.find("SBVH")->points.front().y.median, 1.0) << "no build is cheaper than SBVH's";
    }
}

/// Over up to some hundred instances no method is far from another: what the chart tells apart there is the build.
TEST(TreeCharts, TreesOverInstancesAreVisitedAlikeWhoeverBuiltThem) {
    const Chart chart = make_tiny("tlas");
    for (const char* const panel : {"Nodes a ray visits: rows", "Nodes a ray visits: scattered"}) {
        for (const Series& series : chart.panel(panel).series) {
            for (const Point& point : series.points) {
                SCOPED_TRACE(::testing::Message() << panel << ", " << series.name << ", " << point.x.median);
                const double ratio = point.y.median;
                EXPECT_LE(ratio, 1.15);
                EXPECT_GE(ratio, 0.8);
                if (series.name == "exact") {
                    EXPECT_EQ(ratio, 1.0) << "the others are beside it";
                }
            }
        }
    }
}

TEST(TreeCharts, OfTheChartOfBinsMoreAreNeverWorseInTheMean) {
    const Panel sah = make_tiny("bins").panel("SAH, beside a full sweep");
    const size_t value_count = sah.series.front().points.size();
    std::vector<double> means(value_count, 0.0);
    for (const Series& series : sah.series) {
        ASSERT_EQ(series.points.size(), value_count) << series.name;
        for (size_t k = 0; k < value_count; ++k) means[k] += std::log(series.points[k].y.median);
    }
    double before = std::numeric_limits<double>::infinity();
    for (size_t k = 0; k < value_count; ++k) {
        const double mean = std::exp(means[k] / static_cast<double>(sah.series.size()));
        EXPECT_LE(mean, 1.02 * before) << sah.series.front().points[k].x.median << " bins";
        before = std::min(before, mean);
    }
    EXPECT_LT(means.back(), means.front());
}

/// Where the least is looked for, rays gain nothing by it; a setting's default is beside itself.
TEST(TreeCharts, BuildersThatLookForLessGiveRaysNothing) {
    const Chart chart = make_tiny("knobs");
    const auto by_label = [&](const std::string& panel, const char* series, const char* label) {
        const std::vector<Point>& points = chart.panel(panel).find(series)->points;
        const auto found = std::ranges::find(points, label, &Point::label);
        EXPECT_NE(found, points.end()) << series << ' ' << label;
        return found == points.end() ? std::nan("") : found->y.median;
    };
    for (const Panel& panel : chart.panels) {
        for (const Series& series : panel.series) {
            const auto found = std::ranges::find_if(series.points, &Point::is_default);
            ASSERT_NE(found, series.points.end()) << panel.name << ", " << series.name;
            EXPECT_EQ(found->y.median, 1.0) << panel.name << ", " << series.name;
        }
    }
    EXPECT_GE(by_label("Sweep and reinsertion", "rounds", "1"), 0.98);
    EXPECT_GE(by_label("Sweep and reinsertion", "share of nodes", "0.125"), 0.98);
    EXPECT_GE(by_label("Sweep and reinsertion", "visits a search", "25"), 0.98);
    EXPECT_GE(by_label("Spatial splits and reinsertion", "references", "1"), 0.98);
    EXPECT_GE(by_label("Spatial splits and reinsertion", "spatial bins", "8"), 0.98);
}

}  // namespace
}  // namespace zoe::chart
