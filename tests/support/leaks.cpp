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
    std::vector<glm::dvec3> normals;  ///< Of the triangles that share it.
};

using Edge = std::pair<uint32_t, uint32_t>;

/// Where a mesh is closed: edges that two triangles share, vertices that have no other edges.
struct Targets {
    std::vector<Target> all;
    std::map<uint32_t, size_t> of_vertex;  ///< Positions in `all`.

    Targets(std::span<const glm::vec3> positions, std::span<const glm::uvec3> corners) {
        std::map<Edge, Target> edges, vertices;
        const auto add = [](std::map<Edge, Target>* to, uint32_t a, uint32_t b, const glm::dvec3& normal) {
            to->try_emplace({a, b}, Target{a, b, {}}).first->second.normals.push_back(normal);
        };
        for (const glm::uvec3& t : corners) {
            // In double: in float the normal of a needle may point anywhere.
            const glm::dvec3 a(positions[t.x]), b(positions[t.y]), c(positions[t.z]);
            const glm::dvec3 normal = glm::normalize(glm::cross(b - a, c - a));
            for (int k = 0; k < 3; ++k) {
                add(&vertices, t[k], t[k], normal);
                add(&edges, std::min(t[k], t[(k + 1) % 3]), std::max(t[k], t[(k + 1) % 3]), normal);
            }
        }
        std::set<uint32_t> open;
        for (auto& [key, edge] : edges) {
            if (edge.normals.size() == 2) {
                all.push_back(std::move(edge));
            } else {
                open.insert({key.first, key.second});
            }
        }
        for (auto& [key, vertex] : vertices) {
            if (open.contains(key.first)) continue;
            of_vertex[key.first] = all.size();
            all.push_back(std::move(vertex));
        }
    }

    /// Whether all triangles around the point at `s` of a target face the way, or all face away from it: clearly.
    bool is_crossed(const Target& target, float s, const glm::dvec3& way) const {
        const auto faces = [&](const Target& t, double sign) {
            return std::ranges::all_of(t.normals, [&](const glm::dvec3& n) { return sign * glm::dot(n, way) > 0.02; });
        };
        // So near to an end that rounding may take the ray past it, what is around that end counts, too.
        const Target* end = &target;
        if (target.a != target.b && (s < 0.05f || s > 0.95f)) {
            const auto found = of_vertex.find(s < 0.05f ? target.a : target.b);
            if (found == of_vertex.end()) return false;
            end = &all[found->second];
        }
        return (faces(target, 1.0) && faces(*end, 1.0)) || (faces(target, -1.0) && faces(*end, -1.0));
    }
};

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
    const Targets targets(positions, corners);
    std::atomic<uint64_t> shot = 0, leaked = 0;
    parallel_for(0, ray_count, 4096, [&](size_t begin, size_t end) {
        for (size_t k = begin; k < end; ++k) {
            Rng rng(mix_bits(seed ^ (k * 0x9e3779b97f4a7c15ull)));
            for (int attempt = 0; attempt < 64; ++attempt) {
                const Target& target = targets.all[rng.below(uint32_t(targets.all.size()))];
                const float s = rng.below(4) == 0 ? 0.5f : rng.uniform();
                const glm::vec3 point = glm::mix(positions[target.a], positions[target.b], target.a == target.b ? 0 : s);
                Ray ray;
                ray.origin = origin(rng);
                ray.direction = point - ray.origin;
                if (k % 3 == 0) ray.direction = glm::normalize(ray.direction);
                if (!targets.is_crossed(target, s, glm::normalize(glm::dvec3(ray.direction)))) continue;
                ++shot;
                const float t_point = glm::length(point - ray.origin) / glm::length(ray.direction);
                // The point is rounded to float, and its distance along the ray by that over the cosine.
                const float rounding = 1e-5f * glm::length(point) / glm::length(ray.direction);
                const RayFrame frame(ray);
                if (!is_closest_hit_within(blas, frame, ray, t_point * 1.0001f + rounding)) ++leaked;
                if (!any_hit(blas, frame, 0.0f, ray.t_min, ray.t_max, nullptr)) ++leaked;
                break;
            }
        }
    });
    EXPECT_EQ(leaked, 0u) << "of " << shot << " rays";
    EXPECT_GT(shot, ray_count - ray_count / 10);
}

}  // namespace zoe::test
