#include "apps/chart/moving.h"

#include <array>
#include <cmath>
#include <memory>
#include <numbers>

#include "apps/chart/closed_ball.h"
#include "apps/chart/measure.h"
#include "apps/common/open_scene.h"
#include "content/shapes.h"

namespace zoe::chart {
namespace {

constexpr double kFps = 24.0;

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
    const int rings = settings.pick(40, 160, 320);
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

}  // namespace

std::span<const char* const> moving_names() {
    static constexpr std::array kNames = {"ripple", "walk", "twist", "explosion"};
    return kNames;
}

Moving make_moving(const std::string& series, const Settings& settings) {
    if (series == "ripple") return motion_of_scene(series, settings.pick("deforming-30", "deforming-120", "deforming-250"));
    if (series == "walk") return motion_of_scene(series, "skinned-1");
    if (series == "explosion")
        return motion_of_scene(series, settings.pick("arbitrary-1000", "arbitrary-20000", "arbitrary-100000"));
    return twist(settings);
}

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

double ray_work(const Blas& blas, std::span<const Ray> rays) {
    const Work work = work_of_rays(blas, rays);
    return work.nodes + CollapseConfig{}.block_cost * work.triangles / TriangleBlock::kSize;
}

}  // namespace zoe::chart
