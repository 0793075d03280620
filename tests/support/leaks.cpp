#include "tests/support/leaks.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "engine/bvh/traverse.h"
#include "engine/math/parallel.h"
#include "tests/support/long_run.h"

namespace zoe::test {
namespace {

/// A vertex, or the two ends of an edge.
struct Target {
    uint32_t a, b;
    std::vector<glm::uvec3> triangles;  ///< That share it: their corners.
};

using Edge = std::pair<uint32_t, uint32_t>;

/// Where a mesh is closed: edges that two triangles share, vertices that have no other edges.
std::vector<Target> closed_targets(std::span<const glm::uvec3> corners) {
    std::map<Edge, Target> edges, vertices;
    const auto add = [](std::map<Edge, Target>* to, uint32_t a, uint32_t b, const glm::uvec3& triangle) {
        to->try_emplace({a, b}, Target{a, b, {}}).first->second.triangles.push_back(triangle);
    };
    for (const glm::uvec3& t : corners) {
        for (int k = 0; k < 3; ++k) {
            add(&vertices, t[k], t[k], t);
            add(&edges, std::min(t[k], t[(k + 1) % 3]), std::max(t[k], t[(k + 1) % 3]), t);
        }
    }
    std::vector<Target> targets;
    std::set<uint32_t> open;
    for (auto& [key, edge] : edges) {
        if (edge.triangles.size() == 2) {
            targets.push_back(std::move(edge));
        } else {
            open.insert({key.first, key.second});
        }
    }
    for (auto& [key, vertex] : vertices) {
        if (!open.contains(key.first)) targets.push_back(std::move(vertex));
    }
    return targets;
}

/// How far beside the point that it is shot at a ray may pass, as the triangles see it. The point is the sum of two
/// products: three roundings of its size. The direction is rounded when it is made and when it is normalised, and corners
/// when they are taken to the ray's origin and sheared: nine roundings of the distance.
double rounding(const glm::vec3& point, float distance) {
    constexpr double kUnit = 6e-8;
    return kUnit * (4.0 * glm::length(glm::dvec3(point)) + 12.0 * distance);
}

/// Whether the triangles of a target all face the way, or all face away from it, clearly, and, seen along it, cover all that
/// is within `reach` of the point on the target. In double: in float a needle's normal may point anywhere.
bool is_crossed(const Target& target, std::span<const glm::vec3> positions, const glm::dvec3& point, const glm::dvec3& way,
                double reach) {
    double side = 0.0;
    for (const glm::uvec3& t : target.triangles) {
        glm::dvec3 corner[3];
        for (int k = 0; k < 3; ++k) corner[k] = glm::dvec3(positions[t[k]]) - point;
        const double faces = glm::dot(glm::normalize(glm::cross(corner[1] - corner[0], corner[2] - corner[0])), way);
        if (side == 0.0) side = faces > 0.0 ? 1.0 : -1.0;
        if (!(side * faces > 0.02)) return false;
        for (int k = 0; k < 3; ++k) {
            const auto is_of_target = [&](uint32_t vertex) { return vertex == target.a || vertex == target.b; };
            const bool has_from = is_of_target(t[k]), has_to = is_of_target(t[(k + 1) % 3]);
            // Beyond these edges the target has another triangle.
            if (target.a == target.b ? has_from || has_to : has_from && has_to) continue;
            const glm::dvec3 along = corner[(k + 1) % 3] - corner[k];
            const double seen_length = glm::length(along - glm::dot(along, way) * way);
            if (!(side * glm::dot(glm::cross(corner[k], along), way) > reach * seen_length)) return false;
        }
    }
    return true;
}

bool is_closest_hit_within(const Blas& blas, const RayFrame& frame, const Ray& ray, float t_limit) {
    BlasHit hit{.t = ray.t_max};
    return closest_hit(blas, frame, 0.0f, ray.t_min, &hit, nullptr) && hit.t <= t_limit;
}

}  // namespace

uint64_t leak_ray_count() {
    // Sanitizers slow a ray down tenfold.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    return 100'000;
#else
    return is_long_run() ? 140'000'000 : 1'400'000;
#endif
}

void expect_no_leaks(const Blas& blas, std::span<const glm::vec3> positions, std::span<const glm::uvec3> corners,
                     const std::function<glm::vec3(Rng&)>& origin, uint64_t seed, uint64_t ray_count) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    const std::vector<Target> targets = closed_targets(corners);
    std::atomic<uint64_t> shot = 0, leaked = 0;
    parallel_for(0, ray_count, 4096, [&](size_t begin, size_t end) {
        for (size_t k = begin; k < end; ++k) {
            Rng rng(mix_bits(seed ^ (k * 0x9e3779b97f4a7c15ull)));
            for (int attempt = 0; attempt < 64; ++attempt) {
                const Target& target = targets[rng.below(uint32_t(targets.size()))];
                const float s = rng.below(4) == 0 ? 0.5f : rng.uniform();
                const glm::vec3 point = glm::mix(positions[target.a], positions[target.b], target.a == target.b ? 0 : s);
                Ray ray;
                ray.origin = origin(rng);
                ray.direction = point - ray.origin;
                if (k % 3 == 0) ray.direction = glm::normalize(ray.direction);
                const float distance = glm::length(point - ray.origin);
                const glm::dvec3 way = glm::normalize(glm::dvec3(point) - glm::dvec3(ray.origin));
                if (!is_crossed(target, positions, point, way, rounding(point, distance))) continue;
                ++shot;
                const float t_point = distance / glm::length(ray.direction);
                // The point is rounded to float, and its distance along the ray by that over the cosine.
                const float slack = 1e-5f * glm::length(point) / glm::length(ray.direction);
                const RayFrame frame(ray);
                if (!is_closest_hit_within(blas, frame, ray, t_point * 1.0001f + slack)) ++leaked;
                if (!any_hit(blas, frame, 0.0f, ray.t_min, ray.t_max, nullptr)) ++leaked;
                break;
            }
        }
    });
    EXPECT_EQ(leaked, 0u) << "of " << shot << " rays";
    EXPECT_GT(shot, ray_count - ray_count / 10);
}

}  // namespace zoe::test
