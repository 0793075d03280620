#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "apps/chart/builders.h"
#include "apps/chart/charts.h"
#include "engine/bvh/build_auto.h"

namespace zoe::chart {
namespace {

/// Rays that go through a tree before it is built anew: 10^3 to 10^10.
std::vector<double> ray_counts() {
    std::vector<double> counts;
    for (int k = 6; k <= 20; ++k) counts.push_back(std::pow(10.0, 0.5 * k));
    return counts;
}

/// Build and rays, ms.
Spread total_ms(const MeasuredTree& tree, double rays) {
    const auto total = [&](double build_ms, double ray_ns) { return build_ms + 1e-6 * ray_ns * rays; };
    return {total(tree.build_ms.median, tree.ray_ns.median), total(tree.build_ms.low, tree.ray_ns.low),
            total(tree.build_ms.high, tree.ray_ns.high)};
}

std::vector<Row> measure(const MeshSubject& subject, const Settings& settings) {
    const MeshSample sample = sample_mesh(subject);
    const std::vector<MeasuredTree> trees = measure_trees(sample, all_builders(), settings);
    std::vector<Row> rows;
    for (const double rays : ray_counts()) {
        double least_ms = std::numeric_limits<double>::infinity();
        for (const MeasuredTree& tree : trees)
            if (!tree.is_peer()) least_ms = std::min(least_ms, total_ms(tree, rays).median);
        const std::string by_default = series_of(choose_builder(sample.mesh.corners().size(), {.rays = rays}));
        for (const MeasuredTree& tree : trees) {
            const Spread ms = total_ms(tree, rays);
            rows.push_back({.panel = subject.scene,
                            .series = tree.series,
                            .point = {.x = Spread::exactly(rays),
                                      .y = {ms.median / least_ms, ms.low / least_ms, ms.high / least_ms},
                                      .is_default = tree.series == by_default}});
        }
    }
    return rows;
}

/// Where `better` takes less than `worse` from then on; none where that is nowhere.
std::optional<double> crossing(const Chart& chart, const std::string& panel, const std::string& better,
                               const std::string& worse) {
    const std::vector<double> counts = ray_counts();
    const auto lead = [&](double rays) {
        return std::log(chart.point(panel, worse, rays).y.median / chart.point(panel, better, rays).y.median);
    };
    if (lead(counts.back()) <= 0.0) return std::nullopt;
    for (size_t k = counts.size() - 1; k-- > 0;) {
        const double before = lead(counts[k]), after = lead(counts[k + 1]);
        if (before <= 0.0) return counts[k] * std::pow(counts[k + 1] / counts[k], -before / (after - before));
    }
    return counts.front();
}

std::string caption(const Chart& chart) {
    std::string text = "The ring is what choose_builder takes when it is told the number of rays.";
    for (const Panel& panel : chart.panels) {
        const std::optional<double> pays = crossing(chart, panel.name, "reinserted", "binned");
        text += fmt::format(" {}: reinsertion ", panel.name);
        text += pays ? fmt::format("pays beside binned from {} rays on", short_number(*pays)) : "does not pay beside binned";
        double worst = 0.0, worst_rays = 0.0;
        for (const Series& series : panel.series) {
            for (const Point& point : series.points) {
                if (!point.is_default || point.y.median <= worst) continue;
                worst = point.y.median;
                worst_rays = point.x.median;
            }
        }
        text += fmt::format("; the default takes at most {} times the best choice (at {} rays).", short_number(worst),
                            short_number(worst_rays));
    }
    return text;
}

}  // namespace

Chart pays_off(Sweep& sweep) {
    Chart chart{.name = "pays-off", .question = find_chart("pays-off").question, .columns = 2};
    std::vector<Step> steps;
    for (const MeshSubject& subject : mesh_subjects(sweep.settings())) {
        chart.panels.push_back({.name = subject.scene,
                                .x = {.name = "rays traced per build", .unit = "", .is_log = true},
                                .y = {.name = "build and rays, beside the best of ours", .unit = "", .is_log = true}});
        steps.push_back({.name = subject.scene, .measure = [=, &sweep] { return measure(subject, sweep.settings()); }});
    }
    sweep.run(steps, &chart);
    chart.caption = caption(chart);
    return chart;
}

}  // namespace zoe::chart
