#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "engine/bvh/blas.h"
#include "engine/math/rng.h"

namespace zoe::test {

/// Rays that a test of leaks shoots: over a million, fewer under sanitizers, a hundred times as many where `is_long_run`.
uint64_t leak_ray_count();

/// Shoots at vertices and edges that are closed all around. The triangles around such a target all face the ray the same
/// way, and reach farther to its sides than rounding can move the ray: so the ray crosses the surface there, and must not
/// get past it, by closest or by any hit. Nearer to a silhouette a ray that passes may have been moved off it. origin     of
/// a ray.
void expect_no_leaks(const Blas& blas, std::span<const glm::vec3> positions, std::span<const glm::uvec3> corners,
                     const std::function<glm::vec3(Rng&)>& origin, uint64_t seed, uint64_t ray_count);

}  // namespace zoe::test
