#include "apps/chart/closed_ball.h"

#include <glm/geometric.hpp>

#include "content/shapes.h"

namespace zoe::chart {
namespace {

constexpr float kDistance = 3.0f;
/// Of the cosine between a ray and where it is aimed: farther off, what is hit first may be a neighbour.
constexpr float kClearly = 0.2f;

}  // namespace

glm::vec3 random_direction(Rng& rng) {
    glm::vec3 v;
    do {
        v = {rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1)};
    } while (glm::dot(v, v) > 1.0f || glm::dot(v, v) < 0.01f);
    return glm::normalize(v);
}

ClosedBall::ClosedBall(int segments) : mesh(make_sphere(1.0f, segments, segments / 2)), around(mesh.positions.size()) {
    for (uint32_t k = 0; k < mesh.corners.size(); ++k)
        for (int corner = 0; corner < 3; ++corner) around[mesh.corners[k][corner]].push_back(k);
}

Triangle ClosedBall::triangle(uint32_t k) const {
    const glm::uvec3& c = mesh.corners[k];
    return {mesh.positions[c.x], mesh.positions[c.y], mesh.positions[c.z], k};
}

EdgeRay edge_ray(const ClosedBall& ball, uint64_t seed, size_t k) {
    Rng rng(mix_bits(seed ^ (k * 0x9e3779b97f4a7c15ull)));
    for (;;) {
        const glm::uvec3& c = ball.mesh.corners[rng.below(static_cast<uint32_t>(ball.mesh.corners.size()))];
        const uint32_t corner = rng.below(3);
        EdgeRay result{.ray = {}, .a = c[corner], .b = rng.below(2) ? c[corner] : c[(corner + 1) % 3]};
        const glm::vec3 target = glm::mix(ball.mesh.positions[result.a], ball.mesh.positions[result.b], rng.uniform());
        result.ray.origin = kDistance * random_direction(rng);
        result.ray.direction = glm::normalize(target - result.ray.origin);
        if (glm::dot(glm::normalize(target), result.ray.direction) > -kClearly) continue;
        result.t = glm::length(target - result.ray.origin);
        return result;
    }
}

}  // namespace zoe::chart
