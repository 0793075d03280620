#pragma once

#include <limits>
#include <span>

#include "engine/bvh/traverse.h"
#include "engine/frame/build_tlas.h"
#include "engine/math/ray.h"

namespace zoe {

/// Where a ray meets the scene. The point is (1 - u - v) a + u b + v c of the triangle's corners a, b, c.
struct Hit {
    float t = std::numeric_limits<float>::infinity();  ///< In lengths of the ray's direction.
    float u = 0.0f, v = 0.0f;
    NodeId node = kNone<NodeId>;
    uint32_t primitive = 0xffffffffu;  ///< Triangle of what the node shows: of `tlas[node].mesh`.

    explicit operator bool() const { return node != kNone<NodeId>; }
    friend bool operator==(const Hit&, const Hit&) = default;
};

/// The closest hit with t in [t_min, t_max], both sides of every triangle; ties go by (t, node, primitive).
Hit closest_hit(const Tlas& tlas, const Ray& ray, TraverseCounts* counts = nullptr);

/// Tells whether anything is hit with t in [t_min, t_max].
bool any_hit(const Tlas& tlas, const Ray& ray, TraverseCounts* counts = nullptr);

/// The same for many rays, on the calling thread. Meanwhile the scene's next frame cannot be made, nor the scene edited.
/// hits       [ray_count]
/// Throws     std::logic_error while another thread makes the next frame; any_hits, too.
void closest_hits(const Tlas& tlas, std::span<const Ray> rays, std::span<Hit> hits);
/// is_hit     [ray_count] 1 or 0.
void any_hits(const Tlas& tlas, std::span<const Ray> rays, std::span<uint8_t> is_hit);

/// 64 bits that depend on everything in a hit; `key` tells rays apart (0 hits and misses included). Sum over the rays of a
/// frame, modulo 2^64, for a hash that does not depend on their order.
uint64_t hash(const Hit& hit, uint64_t key);

}  // namespace zoe
