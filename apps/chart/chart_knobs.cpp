#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "apps/bench/stopwatch.h"
#include "apps/chart/builder_knobs.h"
#include "apps/chart/builders.h"
#include "apps/chart/charts.h"
#include "apps/chart/moving.h"

namespace zoe::chart {
namespace {

std::vector<MeshSubject> subjects(const Settings& settings) {
    const int side = settings.pick(48, 96, 256);
    return {{settings.pick("static-10000", "static-20000", "static-200000"), Motion::kStatic, side},
            {settings.pick("deforming-40", "deforming-80", "deforming-250"), Motion::kDeforming, side},
            {settings.pick("arbitrary-4000", "arbitrary-10000", "arbitrary-100000"), Motion::kArbitrary, side}};
}

struct Tree {
    Blas blas;
    BlasScratch scratch;
};

/// Logarithms, summed over scenes: of the work of a ray, and of each time that a tree was built.
struct Sums {
    double work = 0.0;
    std::vector<double> build_ms;
};

void add(const MeshSubject& subject, const std::vector<Knob>& knobs, int rounds, std::vector<Sums>* sums) {
    const MeshSample sample = sample_mesh(subject);
    std::vector<Tree> trees(knobs.size());
    std::vector<std::function<double()>> builds;
    for (size_t k = 0; k < knobs.size(); ++k) {
        builds.emplace_back([&, k] {
            Stopwatch watch;
            knobs[k].build(sample.mesh, &trees[k].blas, &trees[k].scratch);
            return watch.restart_ms();
        });
    }
    const std::vector<std::vector<double>> ms = measure_in_turn(builds, rounds);
    for (size_t k = 0; k < knobs.size(); ++k) {
        Sums& sum = (*sums)[k];
        sum.work += std::log(ray_work(trees[k].blas, sample.rays));
        sum.build_ms.resize(ms[k].size());
        for (size_t round = 0; round < ms[k].size(); ++round) sum.build_ms[round] += std::log(ms[k][round]);
    }
}

/// All settings of one builder.
std::vector<Row> measure(const std::vector<Knob>& knobs, const Settings& settings) {
    const std::vector<MeshSubject> scenes = subjects(settings);
    std::vector<Sums> sums(knobs.size());
    for (const MeshSubject& scene : scenes) add(scene, knobs, settings.pick(1, 2, 3), &sums);
    const auto scene_count = static_cast<double>(scenes.size());
    std::vector<Row> rows;
    for (size_t k = 0; k < knobs.size(); ++k) {
        const auto is_its_default = [&](const Knob& other) { return other.series == knobs[k].series && other.is_default; };
        const auto by_default = static_cast<size_t>(std::ranges::find_if(knobs, is_its_default) - knobs.begin());
        const auto ratio = [&](double sum, double base) { return std::exp((sum - base) / scene_count); };
        std::vector<double> builds;
        for (size_t round = 0; round < sums[k].build_ms.size(); ++round)
            builds.push_back(ratio(sums[k].build_ms[round], sums[by_default].build_ms[round]));
        rows.push_back({.panel = knobs[k].panel,
                        .series = knobs[k].series,
                        .point = {.x = spread_of(builds),
                                  .y = Spread::exactly(ratio(sums[k].work, sums[by_default].work)),
                                  .label = fmt::format("{:g}", knobs[k].value),
                                  .is_default = knobs[k].is_default}});
    }
    return rows;
}

std::string caption(const Chart& chart) {
    std::string text =
        "A point a value: the time that trees take to build and the work of their rays, both beside the default's, in the "
        "mean "
        "over a scene of each motion class.";
    for (const Panel& panel : chart.panels) {
        double least = 1.0;
        std::string where, defaults;
        for (const Series& series : panel.series) {
            for (const Point& point : series.points) {
                if (point.is_default)
                    defaults += fmt::format("{}{} {}", defaults.empty() ? "" : ", ", series.name, point.label);
                if (point.y.median >= least) continue;
                least = point.y.median;
                where = fmt::format("{} {}, for {} of the build,", series.name, point.label, short_number(point.x.median));
            }
        }
        text += where.empty() ? fmt::format(" {} (default: {}): no value leaves rays less work.", panel.name, defaults)
                              : fmt::format(" {} (default: {}): {} would leave rays {} of their work.", panel.name, defaults,
                                            where, short_number(least));
    }
    return text;
}

}  // namespace

Chart knobs(Sweep& sweep) {
    const Settings settings = sweep.settings();
    Chart chart{.name = "knobs", .question = find_chart("knobs").question, .columns = 2};
    std::vector<Step> steps;
    std::vector<Knob> all = builder_knobs();
    while (!all.empty()) {
        const std::string panel = all.front().panel;
        const auto others =
            std::stable_partition(all.begin(), all.end(), [&](const Knob& knob) { return knob.panel == panel; });
        const std::vector<Knob> own(all.begin(), others);
        all.erase(all.begin(), others);
        chart.panels.push_back({.name = panel,
                                .x = {.name = "build, beside the default's", .unit = "", .is_log = true},
                                .y = {.name = "work of a ray, beside the default's", .unit = ""},
                                .is_trade = true,
                                .has_labels = true});
        steps.push_back({.name = panel, .measure = [=] { return measure(own, settings); }});
    }
    sweep.run(steps, &chart);
    chart.caption = caption(chart);
    return chart;
}

}  // namespace zoe::chart
