#pragma once

#include <cstdint>

#include "engine/bvh/blas.h"

namespace zoe {

/// Work done by a ray, for `--shade cost` and the charts.
struct TraverseCounts {
    uint32_t nodes = 0;      ///< Box tests.
    uint32_t triangles = 0;  ///< Triangle tests.
};

struct BlasHit {
    float t = std::numeric_limits<float>::infinity();
    float u = 0.0f, v = 0.0f;
    uint32_t primitive = 0xffffffffu;
};

/// Finds the closest hit; ties in t go to the lower primitive. Hits at t <= hit->t count, so the caller sets hit->t to the
/// far end of the ray and hit->primitive to 0xffffffff, or passes a hit to improve on.
/// t_floor    entry into what holds this BLAS; no hit is nearer (see `intersect`).
/// Returns    true where `hit` was improved.
bool closest_hit(const Blas& blas, const RayFrame& ray, float t_floor, float t_min, BlasHit* hit, TraverseCounts* counts);

/// Tells whether anything is hit with t in [t_min, t_max]. Stops at the first.
bool any_hit(const Blas& blas, const RayFrame& ray, float t_floor, float t_min, float t_max, TraverseCounts* counts);

}  // namespace zoe
