#include <algorithm>
#include <chrono>
#include <map>

#include <fmt/format.h>

#include "apps/chart/charts.h"
#include "apps/chart/measure.h"
#include "apps/chart/moving.h"
#include "engine/bvh/build_poses.h"
#include "engine/bvh/build_sweep.h"
#include "engine/scene/scene.h"

namespace zoe::chart {
namespace {

constexpr const char* kWork = "Work of a ray over the clip";
constexpr const char* kPrice = "Build, a triangle";

using Positions = std::vector<glm::vec3>;

void add_boxes(const Positions& positions, std::span<const glm::uvec3> corners, std::vector<Aabb>* boxes) {
    for (const glm::uvec3& t : corners)
        boxes->push_back(bounds(Triangle{positions[t.x], positions[t.y], positions[t.z], 0}));
}

struct Built {
    Blas blas;
    std::vector<double> us;  ///< A triangle, each time that it was built.
};

/// By the engine's builder of one pose, or over several.
Built build(const std::vector<Positions>& poses, std::span<const glm::uvec3> corners, int repeats) {
    std::vector<Aabb> boxes;
    for (const Positions& pose : poses) add_boxes(pose, corners, &boxes);
    Built built;
    for (int repeat = 0; repeat < repeats; ++repeat) {
        stop_if_interrupted();
        const auto begin = std::chrono::steady_clock::now();
        const Bvh bvh = poses.size() == 1 ? build_sweep(boxes) : build_poses(boxes, poses.size());
        const std::chrono::duration<double, std::micro> time = std::chrono::steady_clock::now() - begin;
        built.us.push_back(time.count() / static_cast<double>(corners.size()));
        BlasScratch scratch;
        make_blas(bvh, poses[0], corners, &built.blas, &scratch);
    }
    return built;
}

std::vector<Row> measure(const std::string& series, const Settings& settings) {
    const Moving moving = make_moving(series, settings);
    // Frame by frame what a ray takes in a tree of its own.
    struct Frame {
        Positions positions;
        std::vector<Ray> rays;
        double least;
    };
    std::vector<Frame> frames;
    for (int frame = 0; frame <= kLastFrame; frame += settings.pick(24, 8, 4)) {
        stop_if_interrupted();
        Positions positions = moving.positions(frame);
        Blas own;
        build_blas(positions, moving.corners, BlasBuilder::kSweep, &own);
        std::vector<Ray> rays =
            make_rays(own.tree.bounds(), settings.pick<size_t>(1000, 4000, 20'000), static_cast<uint64_t>(frame));
        const double least = ray_work(own, rays);
        frames.push_back({std::move(positions), std::move(rays), least});
    }
    std::vector<Row> rows;
    for (const int pose_count : {1, 2, 4, 8, 16}) {
        std::vector<Positions> poses;
        for (int pose = 0; pose < pose_count; ++pose) poses.push_back(moving.positions(kLastFrame * pose / pose_count));
        // Those over many poses are dear, and scatter little.
        Built built = build(poses, moving.corners, settings.pick(1, 3, pose_count < 8 ? 3 : 2));
        double sum = 0.0, worst = 0.0, best = std::numeric_limits<double>::infinity();
        for (const Frame& frame : frames) {
            refit_blas(frame.positions, moving.corners, &built.blas);
            const double ratio = ray_work(built.blas, frame.rays) / frame.least;
            sum += ratio;
            worst = std::max(worst, ratio);
            best = std::min(best, ratio);
        }
        const bool is_default = static_cast<uint32_t>(pose_count) == Scene{}.clip_poses;
        const Spread x = Spread::exactly(pose_count);
        const double mean = sum / static_cast<double>(frames.size());
        rows.push_back(
            {.panel = kWork, .series = series, .point = {.x = x, .y = {mean, best, worst}, .is_default = is_default}});
        rows.push_back(
            {.panel = kPrice, .series = series, .point = {.x = x, .y = spread_of(built.us), .is_default = is_default}});
    }
    return rows;
}

std::string caption(const Chart& chart) {
    const double poses = Scene{}.clip_poses;
    std::string text =
        "Trees built once for a clip of 4 s and refitted to its frames, beside a full-sweep tree of each frame (bars: best "
        "and "
        "worst frame). One pose: a full-sweep tree of the first frame. In the mean a ray takes";
    double dearest = 0.0;
    for (const Series& series : chart.panel(kWork).series) {
        const double one = chart.point(kWork, series.name, 1.0).y.median,
                     some = chart.point(kWork, series.name, poses).y.median;
        text += fmt::format("{} {} times the work with one pose and {} with {:.0f} ({})",
                            &series == &chart.panel(kWork).series.front() ? "" : ",", short_number(one), short_number(some),
                            poses, series.name);
        dearest = std::max(dearest, chart.point(kPrice, series.name, poses).y.median);
    }
    return text + fmt::format(". Default: {:.0f} poses, up to {} us a triangle once; fewer where triangles are many.", poses,
                              short_number(dearest));
}

}  // namespace

Chart clip(Sweep& sweep) {
    Chart chart{.name = "clip", .question = find_chart("clip").question, .columns = 2};
    const Axis poses{.name = "poses that it is built over", .unit = "", .is_log = true};
    chart.panels = {{.name = kWork, .x = poses, .y = {.name = "beside rebuilt trees", .unit = "", .is_log = true}},
                    {.name = kPrice, .x = poses, .y = {.name = "time", .unit = "us", .is_log = true}}};
    std::vector<Step> steps;
    for (const std::string motion : moving_names())
        steps.push_back({.name = motion, .measure = [=, &sweep] { return measure(motion, sweep.settings()); }});
    sweep.run(steps, &chart);
    chart.caption = caption(chart);
    return chart;
}

}  // namespace zoe::chart
