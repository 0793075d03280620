#include <algorithm>

#include <fmt/format.h>

#include "apps/chart/charts.h"
#include "apps/chart/measure.h"
#include "apps/chart/moving.h"
#include "engine/math/parallel.h"

namespace zoe::chart {
namespace {

constexpr const char* kWork = "Work of a ray: nodes and blocks of triangles";
constexpr const char* kSah = "SAH";
constexpr int kBatches = 5;

std::vector<Row> measure(const std::string& series, const Settings& settings) {
    const Moving moving = make_moving(series, settings);
    const BlasBuilder builder = BlasBuilder::kSweep;
    Blas refitted;
    build_blas(moving.positions(0), moving.corners, builder, &refitted);
    std::vector<Row> rows;
    for (int frame = 0; frame <= kLastFrame; frame += settings.pick(24, 8, 2)) {
        stop_if_interrupted();
        const std::vector<glm::vec3> positions = moving.positions(frame);
        refit_blas(positions, moving.corners, &refitted);
        Blas rebuilt;
        build_blas(positions, moving.corners, builder, &rebuilt);
        std::vector<double> ratios(kBatches);
        parallel_for(0, kBatches, 1, [&](size_t begin, size_t end) {
            for (size_t batch = begin; batch < end; ++batch) {
                const std::vector<Ray> rays =
                    make_rays(rebuilt.tree.bounds(), settings.pick<size_t>(300, 2000, 20'000), batch);
                ratios[batch] = ray_work(refitted, rays) / ray_work(rebuilt, rays);
            }
        });
        const float block_cost = CollapseConfig{}.block_cost;
        const Spread x = Spread::exactly(frame);
        rows.push_back({.panel = kWork, .series = series, .point = {.x = x, .y = spread_of(ratios)}});
        rows.push_back(
            {.panel = kSah,
             .series = series,
             .point = {.x = x,
                       .y = Spread::exactly(sah_cost(refitted.tree, block_cost) / sah_cost(rebuilt.tree, block_cost))}});
    }
    return rows;
}

std::string caption(const Chart& chart) {
    std::string text =
        "Full-sweep trees of frame 0, refitted to each frame, beside trees built for it. At its worst frame a refitted "
        "tree's rays take";
    const Panel& work = chart.panel(kWork);
    for (const Series& series : work.series) {
        const Point& worst = *std::ranges::max_element(series.points, {}, [](const Point& p) { return p.y.median; });
        text += fmt::format("{} {} times the work ({}, frame {})", &series == &work.series.front() ? "" : ",",
                            short_number(worst.y.median), series.name, worst.x.median);
    }
    return text +
           ". Default: skins and morph targets are refitted, and rebuilt once they have lost what that costs (chart "
           "policy); "
           "meshes that are written anew, such as the explosion, are rebuilt in every frame.";
}

}  // namespace

Chart degradation(Sweep& sweep) {
    Chart chart{.name = "degradation", .question = find_chart("degradation").question, .columns = 2};
    const Axis frame{.name = "frame", .unit = ""}, ratio{.name = "refitted / rebuilt", .unit = "", .is_log = true};
    chart.panels = {{.name = kWork, .x = frame, .y = ratio}, {.name = kSah, .x = frame, .y = ratio}};
    std::vector<Step> steps;
    for (const std::string series : moving_names())
        steps.push_back({.name = series, .measure = [=, &sweep] { return measure(series, sweep.settings()); }});
    sweep.run(steps, &chart);
    chart.caption = caption(chart);
    return chart;
}

}  // namespace zoe::chart
