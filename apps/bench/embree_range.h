#pragma once

#include <span>

#include "engine/frame/build_tlas.h"
#include "engine/math/ray.h"

namespace zoe {

/// What a ray's numbers may grow to on the way into an instance: |local| <= stretch * |world| + shift, by component.
struct EmbreeReach {
    double stretch = 1.0, shift = 0.0;
};

/// Of all instances of a frame.
EmbreeReach reach_into(const Tlas& tlas);

/// Embree leaves out triangles with a coordinate beyond about 1.8e18, and Debian's build ends the program at a ray with one.
/// These refuse both, before Embree sees them.
/// Throws     std::runtime_error in one line.
void require_in_embree_range(const Tlas& tlas);
void require_in_embree_range(std::span<const glm::vec3> positions);
void require_in_embree_range(std::span<const Ray> rays, const EmbreeReach& reach);

}  // namespace zoe
