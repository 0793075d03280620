#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "apps/chart/builders.h"
#include "apps/chart/charts.h"
#include "apps/chart/clip_ways.h"
#include "apps/chart/measure.h"
#include "apps/chart/moving.h"
#include "engine/math/parallel.h"

namespace zoe::chart {
namespace {

constexpr const char *kRefitted = "always refitted", *kRebuilt = "always rebuilt", *kSensor = "by the sensor",
                     *kHindsight = "in hindsight";
constexpr double kRaysATriangle = 10.0;
constexpr double kRefitsABuild = 16.0;  ///< That take as long as a rebuild.

/// 1/64 to 64, in units of a rebuild's work.
std::vector<double> thresholds() {
    std::vector<double> all;
    for (int k = -6; k <= 6; ++k) all.push_back(std::exp2(k));
    return all;
}

/// The trees of all frames, at all later frames.
ClipTrees make_trees(const Moving& moving, const Settings& settings) {
    std::vector<std::vector<glm::vec3>> frames;
    for (int frame = 0; frame <= kLastFrame; frame += settings.pick(12, 4, 2)) frames.push_back(moving.positions(frame));
    const auto triangle_count = static_cast<uint32_t>(moving.corners.size());
    const double build_work = RebuildConfig{}.triangle_work * triangle_count;
    ClipTrees trees{.triangle_count = triangle_count,
                    .rays = kRaysATriangle * triangle_count,
                    .build_work = build_work,
                    .refit_work = build_work / kRefitsABuild,
                    .readings = std::vector<std::vector<TreeReading>>(frames.size()),
                    .ray_work = std::vector<std::vector<double>>(frames.size())};
    parallel_for(0, frames.size(), 1, [&](size_t built, size_t) {
        stop_if_interrupted();
        Blas blas;
        build_blas(frames[built], moving.corners, built == 0 ? BlasBuilder::kSweep : BlasBuilder::kBinned, &blas);
        for (size_t frame = built; frame < frames.size(); ++frame) {
            if (frame > built) refit_blas(frames[frame], moving.corners, &blas);
            const std::vector<Ray> rays = make_rays(blas.tree.bounds(), settings.pick<size_t>(300, 1000, 4000), frame);
            trees.readings[built].push_back(read_tree(blas));
            trees.ray_work[built].push_back(ray_work(blas, rays));
        }
    });
    return trees;
}

std::vector<Row> measure(const std::string& motion, const Settings& settings) {
    const ClipTrees trees = make_trees(make_moving(motion, settings), settings);
    const double least = in_hindsight(trees);
    std::vector<Row> rows;
    for (const double threshold : thresholds()) {
        const auto add = [&](const char* series, double work, bool is_default) {
            rows.push_back(
                {.panel = motion,
                 .series = series,
                 .point = {.x = Spread::exactly(threshold), .y = Spread::exactly(work / least), .is_default = is_default}});
        };
        add(kRefitted, always_refitted(trees), false);
        add(kRebuilt, always_rebuilt(trees), false);
        add(kHindsight, least, false);
        add(kSensor, by_sensor(trees, threshold), threshold == 1.0);
    }
    return rows;
}

constexpr const char *kPrice = "What a rebuild takes a triangle", *kMeasured = "binned", *kCounted = "as the engine counts";

/// In tests of a node's eight boxes, by the time that diffuse rays take for one.
std::vector<Row> measure_price(const MeshSubject& subject, const Settings& settings) {
    const MeshSample sample = sample_mesh(subject);
    const MeasuredTree tree = measure_trees(sample, {builder(BlasBuilder::kBinned)}, settings).front();
    const double work = tree.work.nodes + CollapseConfig{}.block_cost * tree.work.triangles / TriangleBlock::kSize;
    const auto triangle_count = static_cast<double>(sample.mesh.corners().size());
    const auto price = [&](double build_ms, double ray_ns) { return 1e6 * build_ms / triangle_count / (ray_ns / work); };
    const Spread x = Spread::exactly(triangle_count);
    return {{.panel = kPrice,
             .series = kMeasured,
             .point = {.x = x,
                       .y = {price(tree.build_ms.median, tree.ray_ns.median), price(tree.build_ms.low, tree.ray_ns.high),
                             price(tree.build_ms.high, tree.ray_ns.low)},
                       .label = subject.scene}},
            {.panel = kPrice,
             .series = kCounted,
             .point = {.x = x, .y = Spread::exactly(RebuildConfig{}.triangle_work), .is_default = true}}};
}

std::string caption(const Chart& chart) {
    double of_best = 0.0, of_fixed = 0.0, dearest = 0.0, cheapest = std::numeric_limits<double>::infinity();
    int below_count = 0, motion_count = 0;
    std::string at_best, at_fixed;
    for (const Panel& panel : chart.panels) {
        if (panel.name == kPrice) continue;
        const auto y = [&](const char* series) { return chart.point(panel.name, series, 1.0).y.median; };
        const double fixed = y(kSensor) / std::min(y(kRefitted), y(kRebuilt));
        ++motion_count;
        below_count += fixed < 1.0;
        if (y(kSensor) > of_best) {
            of_best = y(kSensor);
            at_best = panel.name;
        }
        if (fixed > of_fixed) {
            of_fixed = fixed;
            at_fixed = panel.name;
        }
    }
    for (const Point& point : chart.panel(kPrice).find(kMeasured)->points) {
        dearest = std::max(dearest, point.y.median);
        cheapest = std::min(cheapest, point.y.median);
    }
    return fmt::format(
        "A clip's rays ({} a triangle and frame), refits and rebuilds, in tests of a node's eight boxes. Default: a tree is "
        "rebuilt once it has lost what that takes, or later while that is dear beside all other work. That costs at most {} "
        "times the best choice of frames in hindsight ({}), "
        "and {} times the better of always refitting and always rebuilding ({}); it is below both in {} of {} motions. A "
        "rebuild is taken for {} tests a triangle; measured, it takes {} to {}.",
        kRaysATriangle, short_number(of_best), at_best, short_number(of_fixed), at_fixed, below_count, motion_count,
        RebuildConfig{}.triangle_work, short_number(cheapest), short_number(dearest));
}

}  // namespace

Chart policy(Sweep& sweep) {
    Chart chart{.name = "policy", .question = find_chart("policy").question, .columns = 3};
    std::vector<Step> steps;
    for (const std::string motion : moving_names()) {
        chart.panels.push_back({.name = motion,
                                .x = {.name = "lost before a rebuild, in rebuilds", .unit = "", .is_log = true},
                                .y = {.name = "work, beside hindsight", .unit = ""}});
        steps.push_back({.name = motion, .measure = [=, &sweep] { return measure(motion, sweep.settings()); }});
    }
    chart.panels.push_back({.name = kPrice,
                            .x = {.name = "triangles", .unit = "", .is_log = true},
                            .y = {.name = "tests of a node's boxes", .unit = "", .is_log = true},
                            .has_labels = true});
    for (const MeshSubject& subject : mesh_subjects(sweep.settings()))
        steps.push_back(
            {.name = subject.scene, .measure = [=, &sweep] { return measure_price(subject, sweep.settings()); }});
    sweep.run(steps, &chart);
    chart.caption = caption(chart);
    return chart;
}

}  // namespace zoe::chart
