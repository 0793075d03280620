#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include <fmt/format.h>

#include "apps/chart/charts.h"
#include "apps/chart/closed_ball.h"
#include "apps/chart/measure.h"
#include "apps/common/open_scene.h"
#include "content/shapes.h"
#include "engine/math/parallel.h"

namespace zoe::chart {
namespace {

constexpr const char* kWork = "Work of a ray: nodes and blocks of triangles";
constexpr const char* kSah = "SAH";
constexpr double kFps = 24.0;
constexpr int kLastFrame = 96;  ///< Of a clip of 4 s.
constexpr int kBatches = 5;

/// Vertices frame by frame; the triangles stay.
struct Moving {
    std::string series;
    std::vector<glm::uvec3> corners;
    std::function<std::vector<glm::vec3>(int frame)> positions;
};

/// The only mesh of a scene.
Moving motion_of_scene(const std::string& series, const std::string& scene) {
    const auto content = std::make_shared<Content>(open_scene(scene, kFps));
    Moving moving{.series = series, .corners = advance(*content, 0.0, nullptr).instances[0].mesh->corners, .positions = {}};
    moving.positions = [content](int frame) {
        const Tlas& tlas = advance(*content, frame / kFps, nullptr);
        return std::vector<glm::vec3>(tlas.instances[0].positions.begin(), tlas.instances[0].positions.end());
    };
    return moving;
}

/// A column that is wrung: its top makes two turns by the end.
Moving twist(const Settings& settings) {
    constexpr float kHeight = 2.0f, kRadius = 0.3f;
    const int rings = settings.pick(40, 160, 480);
    std::vector<glm::vec3> path;
    for (int k = 0; k <= rings; ++k) path.push_back({0, kHeight * static_cast<float>(k) / static_cast<float>(rings), 0});
    // Three ridges, or turning would change nothing.
    Mesh column = make_tube(path, std::vector<float>(path.size(), kRadius), 48);
    for (glm::vec3& p : column.positions) {
        const float ridge = 1.0f + 0.5f * std::cos(3.0f * std::atan2(p.z, p.x));
        p = {ridge * p.x, p.y, ridge * p.z};
    }
    return {.series = "twist", .corners = column.corners, .positions = [rest = column.positions](int frame) {
                std::vector<glm::vec3> turned = rest;
                const auto turns = 2.0f * static_cast<float>(frame) / kLastFrame;
                for (glm::vec3& p : turned) {
                    const float angle = 2.0f * std::numbers::pi_v<float> * turns * p.y / kHeight;
                    p = {std::cos(angle) * p.x + std::sin(angle) * p.z, p.y, std::cos(angle) * p.z - std::sin(angle) * p.x};
                }
                return turned;
            }};
}

Moving make_moving(const std::string& series, const Settings& settings) {
    if (series == "ripple") return motion_of_scene(series, settings.pick("deforming-30", "deforming-120", "deforming-400"));
    if (series == "walk") return motion_of_scene(series, "skinned-1");
    if (series == "explosion")
        return motion_of_scene(series, settings.pick("arbitrary-1000", "arbitrary-20000", "arbitrary-200000"));
    return twist(settings);
}

/// From around a box to points in it.
std::vector<Ray> make_rays(const Aabb& box, size_t count, uint64_t seed) {
    Rng rng(seed);
    std::vector<Ray> rays(count);
    const float reach = 2.0f * glm::length(box.extent());
    for (Ray& ray : rays) {
        const glm::vec3 target = box.lo + glm::vec3(rng.uniform(), rng.uniform(), rng.uniform()) * box.extent();
        ray.origin = box.centre() + reach * random_direction(rng);
        ray.direction = target - ray.origin;
    }
    return rays;
}

/// In tests of a node's eight boxes, as the trees' own cost model counts.
double work_of(const Blas& blas, std::span<const Ray> rays) {
    const Work work = work_of_rays(blas, rays);
    return work.nodes + CollapseConfig{}.block_cost * work.triangles / TriangleBlock::kSize;
}

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
                ratios[batch] = work_of(refitted, rays) / work_of(rebuilt, rays);
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
           ". Default: skins and morph targets are refitted; meshes that are written anew, such as the explosion, are "
           "rebuilt in every frame.";
}

}  // namespace

Chart degradation(Sweep& sweep) {
    Chart chart{.name = "degradation", .question = find_chart("degradation").question, .columns = 2};
    const Axis frame{.name = "frame", .unit = ""}, ratio{.name = "refitted / rebuilt", .unit = "", .is_log = true};
    chart.panels = {{.name = kWork, .x = frame, .y = ratio}, {.name = kSah, .x = frame, .y = ratio}};
    std::vector<Step> steps;
    for (const std::string series : {"ripple", "walk", "twist", "explosion"})
        steps.push_back({.name = series, .measure = [=, &sweep] { return measure(series, sweep.settings()); }});
    sweep.run(steps, &chart);
    chart.caption = caption(chart);
    return chart;
}

}  // namespace zoe::chart
