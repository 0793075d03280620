#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "apps/chart/sweep.h"
#include "engine/bvh/blas.h"
#include "engine/math/ray.h"

namespace zoe::chart {

/// The last frame of the clips that charts play: 4 s.
inline constexpr int kLastFrame = 96;

/// Vertices frame by frame; the triangles stay.
struct Moving {
    std::string series;
    std::vector<glm::uvec3> corners;
    std::function<std::vector<glm::vec3>(int frame)> positions;
};

/// What `make_moving` knows.
std::span<const char* const> moving_names();

/// Requires   one of those names.
Moving make_moving(const std::string& series, const Settings& settings);

/// From around a box to points in it.
std::vector<Ray> make_rays(const Aabb& box, size_t count, uint64_t seed);

/// What a ray takes in the mean: in tests of a node's eight boxes, as the trees' own cost model counts.
double ray_work(const Blas& blas, std::span<const Ray> rays);

}  // namespace zoe::chart
