#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "tests/support/brute_force.h"

namespace zoe::test {

/// Rays around a scene, the same for the same seed: from outside its bounding sphere to points of its triangles, from
/// inside it in all directions, and parallel to an axis through points of its triangles (not grazing them: where two
/// answers are right, nothing is tested). Directions have any length; one ray in eight is cut at both ends. Empty where no
/// triangle is finite.
std::vector<OracleRay> rays_around(std::span<const WorldTriangle> triangles, size_t count, uint64_t seed);

}  // namespace zoe::test
