#include <algorithm>
#include <cmath>
#include <functional>

#include <fmt/format.h>

#include "apps/bench/stopwatch.h"
#include "apps/chart/charts.h"
#include "apps/chart/measure.h"
#include "apps/chart/moving.h"
#include "apps/chart/rotate.h"
#include "engine/math/parallel.h"

namespace zoe::chart {
namespace {

constexpr const char* kWork = "Work of a ray: nodes and blocks of triangles";
constexpr const char* kSah = "SAH";
constexpr const char* kTime = "Time of rotations";
constexpr int kBatches = 5;

std::string rotated(const std::string& series) {
    return series + ", rotated";
}

/// Of one thread: rotations have no other.
double time_of(const std::function<void()>& work) {
    const int threads = thread_count();
    set_thread_count(1);
    Stopwatch watch;
    work();
    const double ms = watch.restart_ms();
    set_thread_count(threads);
    return ms;
}

std::vector<Row> measure(const std::string& series, const Settings& settings) {
    const Moving moving = make_moving(series, settings);
    const BlasBuilder builder = BlasBuilder::kSweep;
    const float block_cost = CollapseConfig{}.block_cost;
    Blas refitted;
    build_blas(moving.positions(0), moving.corners, builder, &refitted);
    Blas turned = refitted;
    std::vector<Row> rows;
    const int step = settings.pick(24, 8, 2);
    for (int frame = 0; frame <= kLastFrame; ++frame) {
        stop_if_interrupted();
        const std::vector<glm::vec3> positions = moving.positions(frame);
        refit_blas(positions, moving.corners, &turned);
        const double rotate_ms = frame == 0 ? 0.0 : time_of([&] { rotate(&turned.tree); });
        if (frame % step != 0) continue;
        refit_blas(positions, moving.corners, &refitted);
        Blas rebuilt, binned;
        BlasScratch scratch;
        build_blas(positions, moving.corners, builder, &rebuilt);
        build_blas(positions, moving.corners, BlasBuilder::kBinned, &binned, &scratch);
        const double build_ms =
            time_of([&] { build_blas(positions, moving.corners, BlasBuilder::kBinned, &binned, &scratch); });
        std::vector<double> ratios(kBatches), turned_ratios(kBatches);
        parallel_for(0, kBatches, 1, [&](size_t begin, size_t end) {
            for (size_t batch = begin; batch < end; ++batch) {
                const std::vector<Ray> rays =
                    make_rays(rebuilt.tree.bounds(), settings.pick<size_t>(300, 2000, 10'000), batch);
                const double least = ray_work(rebuilt, rays);
                ratios[batch] = ray_work(refitted, rays) / least;
                turned_ratios[batch] = ray_work(turned, rays) / least;
            }
        });
        const auto add = [&](const char* panel, const std::string& name, const Spread& y) {
            rows.push_back({.panel = panel, .series = name, .point = {.x = Spread::exactly(frame), .y = y}});
        };
        const double least = sah_cost(rebuilt.tree, block_cost);
        add(kWork, series, spread_of(ratios));
        add(kWork, rotated(series), spread_of(turned_ratios));
        add(kSah, series, Spread::exactly(sah_cost(refitted.tree, block_cost) / least));
        add(kSah, rotated(series), Spread::exactly(sah_cost(turned.tree, block_cost) / least));
        if (frame > 0) add(kTime, rotated(series), Spread::exactly(rotate_ms / build_ms));
    }
    return rows;
}

const Point& worst_of(const Series& series) {
    return *std::ranges::max_element(series.points, {}, [](const Point& p) { return p.y.median; });
}

std::string caption(const Chart& chart) {
    std::string text =
        "Full-sweep trees of frame 0, refitted to each frame, beside trees built for it. At its worst frame a refitted "
        "tree's rays take";
    const Panel& work = chart.panel(kWork);
    for (const std::string name : moving_names()) {
        const Point& worst = worst_of(*work.find(name));
        text += fmt::format("{} {} times the work ({}, frame {}; {} with rotations)", text.ends_with("take") ? "" : ",",
                            short_number(worst.y.median), name, worst.x.median,
                            short_number(worst_of(*work.find(rotated(name))).y.median));
    }
    std::vector<double> times;
    for (const Series& series : chart.panel(kTime).series) {
        for (const Point& point : series.points) times.push_back(point.y.median);
    }
    const double time = spread_of(times).median;
    return text +
           fmt::format(
               ". Rotations after every refit, of all pairs of places on a level, take {} of a binned rebuild's time in "
               "each "
               "frame, on one thread: the engine has none, for a tree that is rebuilt every {:.0f} frames is better at that "
               "price. "
               "Default: skins and morph targets are refitted, and rebuilt once they have lost what that costs (chart "
               "policy); meshes that are written anew, such as the explosion, are rebuilt in every frame.",
               short_number(time), std::ceil(1.0 / time));
}

}  // namespace

Chart degradation(Sweep& sweep) {
    Chart chart{.name = "degradation", .question = find_chart("degradation").question, .columns = 3};
    const Axis frame{.name = "frame", .unit = ""}, ratio{.name = "refitted / rebuilt", .unit = "", .is_log = true};
    const Axis time{.name = "rotated / rebuilt", .unit = "", .is_log = true};
    chart.panels = {{.name = kWork, .x = frame, .y = ratio},
                    {.name = kSah, .x = frame, .y = ratio},
                    {.name = kTime, .x = frame, .y = time}};
    std::vector<Step> steps;
    for (const std::string series : moving_names())
        steps.push_back({.name = series, .measure = [=, &sweep] { return measure(series, sweep.settings()); }});
    sweep.run(steps, &chart);
    chart.caption = caption(chart);
    return chart;
}

}  // namespace zoe::chart
