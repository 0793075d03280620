#include <fmt/format.h>

#include "apps/bench/stopwatch.h"
#include "apps/chart/builders.h"
#include "apps/chart/charts.h"

namespace zoe::chart {
namespace {

constexpr const char* kSah = "SAH, beside a full sweep";
constexpr const char* kNodes = "Nodes a diffuse ray visits, beside a full sweep";
constexpr const char* kBuild = "Build";
constexpr int kBinCounts[] = {2, 4, 8, 16, 32, 64};

struct Tree {
    Blas blas;
    BlasScratch scratch;
};

std::vector<Row> measure(const MeshSubject& subject, const Settings& settings) {
    const MeshSample sample = sample_mesh(subject);
    const size_t triangle_count = sample.mesh.corners().size();
    Tree sweep;
    builder(BlasBuilder::kSweep).build(sample.mesh, &sweep.blas, &sweep.scratch);
    const double sweep_sah = sah_cost(sweep.blas.tree, 1.0f), sweep_nodes = work_of_rays(sweep.blas, sample.rays).nodes;
    std::vector<Tree> trees(std::size(kBinCounts));
    std::vector<std::function<double()>> builds;
    for (size_t k = 0; k < trees.size(); ++k) {
        builds.emplace_back([&, k, with_bins = binned(kBinCounts[k])] {
            Stopwatch watch;
            with_bins.build(sample.mesh, &trees[k].blas, &trees[k].scratch);
            return 1e6 * watch.restart_ms() / static_cast<double>(triangle_count);
        });
    }
    const std::vector<std::vector<double>> ns = measure_in_turn(builds, settings.pick(3, 9, 15));
    std::vector<Row> rows;
    for (size_t k = 0; k < trees.size(); ++k) {
        const auto add = [&](const char* panel, const Spread& y) {
            rows.push_back({.panel = panel,
                            .series = name(subject.motion),
                            .point = {.x = Spread::exactly(kBinCounts[k]),
                                      .y = y,
                                      .is_default = kBinCounts[k] == blas_binned_config().bin_count}});
        };
        add(kSah, Spread::exactly(sah_cost(trees[k].blas.tree, 1.0f) / sweep_sah));
        add(kNodes, Spread::exactly(work_of_rays(trees[k].blas, sample.rays).nodes / sweep_nodes));
        add(kBuild, spread_of(ns[k]));
    }
    return rows;
}

std::string caption(const Chart& chart) {
    const int bins = blas_binned_config().bin_count, most = kBinCounts[std::size(kBinCounts) - 1];
    std::string text = fmt::format("Default: {} bins (small nodes take fewer).", bins);
    for (const Series& series : chart.panel(kSah).series) {
        const auto y = [&](const char* panel, int count) { return chart.point(panel, series.name, count).y.median; };
        text += fmt::format(
            " {}: SAH {} times a full sweep's; {} bins would make that {} for {} times the build, 4 bins {} for {}.",
            series.name, short_number(y(kSah, bins)), most, short_number(y(kSah, most)),
            short_number(y(kBuild, most) / y(kBuild, bins)), short_number(y(kSah, 4)),
            short_number(y(kBuild, 4) / y(kBuild, bins)));
    }
    return text;
}

}  // namespace

Chart bins(Sweep& sweep) {
    const Settings settings = sweep.settings();
    const Axis bin_count{.name = "bins", .unit = "", .is_log = true}, ratio{.name = "ratio", .unit = ""};
    Chart chart{.name = "bins", .question = find_chart("bins").question, .columns = 3};
    chart.panels = {{.name = kSah, .x = bin_count, .y = ratio},
                    {.name = kNodes, .x = bin_count, .y = ratio},
                    {.name = kBuild, .x = bin_count, .y = {.name = "build", .unit = "ns a triangle"}}};
    std::vector<Step> steps;
    for (const MeshSubject& subject : mesh_subjects(settings))
        steps.push_back({.name = subject.scene, .measure = [=] { return measure(subject, settings); }});
    sweep.run(steps, &chart);
    chart.caption = caption(chart);
    return chart;
}

}  // namespace zoe::chart
