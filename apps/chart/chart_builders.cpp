#include <fmt/format.h>

#include "apps/chart/builders.h"
#include "apps/chart/charts.h"

namespace zoe::chart {
namespace {

constexpr const char* kSpeed = "speed";

struct Measure {
    const char* name;
    bool is_more_better;
};
constexpr Measure kMeasures[] = {{kSpeed, true}, {"nodes a ray visits", false}, {"SAH", false}, {"EPO", false}};

std::string panel_name(const MeshSubject& subject, const std::string& measure) {
    return fmt::format("{}: {}", subject.scene, measure);
}

std::vector<Row> measure(const MeshSubject& subject, const Settings& settings) {
    const MeshSample sample = sample_mesh(subject);
    const char* const by_default = series_of(default_builder(subject.motion, sample.mesh.corners().size()));
    std::vector<Row> rows;
    for (const MeasuredTree& tree : measure_trees(sample, all_builders(), settings)) {
        const bool is_default = tree.series == by_default;
        const auto add = [&](const char* measure, const Spread& y) {
            rows.push_back({.panel = panel_name(subject, measure),
                            .series = tree.series,
                            .point = {.x = tree.build_ms, .y = y, .is_default = is_default}});
        };
        add(kSpeed, {1e3 / tree.ray_ns.median, 1e3 / tree.ray_ns.high, 1e3 / tree.ray_ns.low});
        if (tree.is_peer()) continue;
        add("nodes a ray visits", Spread::exactly(tree.work.nodes));
        add("SAH", Spread::exactly(tree.sah));
        add("EPO", Spread::exactly(tree.epo));
    }
    return rows;
}

const Point& only_point(const Panel& panel, const std::string& series) {
    return panel.find(series)->points.front();
}

std::string caption(const Chart& chart, const std::vector<MeshSubject>& all) {
    std::string text = "Diffuse rays, on all threads.";
    for (const MeshSubject& subject : all) {
        const Panel& panel = chart.panel(panel_name(subject, kSpeed));
        for (const Series& series : panel.series) {
            for (const Point& point : series.points) {
                if (!point.is_default) continue;
                const Point& binned = only_point(panel, "binned");
                text += fmt::format(" {}: the default is {}", subject.scene, series.name);
                if (series.name != "binned") {
                    text += fmt::format(", {} times the build of binned for {} times its rays a second",
                                        short_number(point.x.median / binned.x.median),
                                        short_number(point.y.median / binned.y.median));
                } else {
                    const Point& best = only_point(panel, "reinserted");
                    text += fmt::format(", {} of the build of reinserted for {} of its rays a second",
                                        short_number(point.x.median / best.x.median),
                                        short_number(point.y.median / best.y.median));
                }
                text += fmt::format("; on the front: {}.", names_on_front(panel));
            }
        }
    }
    return text;
}

}  // namespace

Chart builders(Sweep& sweep) {
    const std::vector<MeshSubject> all = mesh_subjects(sweep.settings());
    Chart chart{.name = "builders", .question = find_chart("builders").question, .columns = 3};
    for (const Measure& measure : kMeasures) {
        for (const MeshSubject& subject : all) {
            const bool is_speed = measure.is_more_better;
            chart.panels.push_back({
                .name = panel_name(subject, measure.name),
                .x = {.name = "build", .unit = "ms", .is_log = true},
                .y = {.name = is_speed ? "diffuse rays" : measure.name,
                      .unit = is_speed ? "million/s" : "",
                      .is_more_better = measure.is_more_better},
                .is_trade = true,
            });
        }
    }
    std::vector<Step> steps;
    for (const MeshSubject& subject : all)
        steps.push_back({.name = subject.scene, .measure = [=, &sweep] { return measure(subject, sweep.settings()); }});
    sweep.run(steps, &chart);
    chart.caption = caption(chart, all);
    return chart;
}

}  // namespace zoe::chart
