#pragma once

#include <cstdint>
#include <span>

#include "engine/bvh/blas.h"
#include "engine/math/affine.h"
#include "engine/math/ray.h"

namespace zoe {

/// Work done by a ray, for `--shade cost` and the charts. What a packet of rays does together counts once.
struct TraverseCounts {
    uint64_t nodes = 0;      ///< Nodes whose eight boxes were tested.
    uint64_t triangles = 0;  ///< Triangle tests, whole blocks.
};

/// A tree in the world, or a part of one, as the kernels see it: a cache line.
struct alignas(64) PlacedBlas {
    Affine local_from_world;
    const Blas* blas = nullptr;
    uint32_t start = 0;                ///< The part: a child's word in the tree. 0: all of it.
    uint32_t id : 30 = 0;              ///< Breaks ties before the primitive does.
    uint32_t is_identity : 1 = false;  ///< Local space is world space.
    uint32_t is_shifted : 1 = false;   ///< local_from_world.linear is the identity: directions are the same in both.
};
static_assert(sizeof(PlacedBlas) == 64);

/// How far a ray that was transformed may be off its way in the world: this times the largest coordinate on it, of its
/// origin, or of the instance's translation, where |M| |M^-1| has no row of a sum above kMostSpread. A transform in float is
/// off by 5 units in the last place of those, the test of a local box by 18 more of t: within 64 ulp at this spread.
inline constexpr float kTightSlack = 64.0f * 1.1920929e-7f;
inline constexpr float kMostSpread = 4.5f;

/// A tree over placed trees or parts of them: its leaves are single blocks of one each, instances[k] being block k.
/// bounds     [as many] around the whole tree in the world: where its hits may be. The same for all of its parts.
struct TwoLevels {
    const WideBvh* top = nullptr;
    const PlacedBlas* instances = nullptr;
    const Aabb* bounds = nullptr;
    size_t stack_size = 0;  ///< Of `top` and the deepest of the instances' trees together.
    /// 0 where the boxes of `top` hold the bounds of what is transformed. Else they may be tighter: what is in them,
    /// padded by kTightSlack times their own coordinates and the translation's, and this is kTightSlack: rays see them as
    /// larger by that much of their origin's coordinates.
    float slack = 0.0f;
};

/// Where a ray meets something. The point is (1 - u - v) a + u b + v c.
struct RawHit {
    float t = std::numeric_limits<float>::infinity();
    float u = 0.0f, v = 0.0f;
    uint32_t id = kEmptyChild, primitive = kEmptyChild;
};

/// Finds the closest hit of each ray with t in [t_min, t_max], ties by (t, id, primitive). The kernels are those of the best
/// instruction set that the processor has; all of them give the hits of `intersect` over every triangle, bit for bit.
/// hits       [ray_count]
/// counts     null, or what the work of all rays is added to.
/// Cost       no allocation unless the tree is deeper than a few dozen levels.
/// Source     single rays: Wald, Benthin, Boulos. Getting Rid of Packets: Efficient SIMD Single-Ray Traversal using
///            Multi-Branching BVHs. IEEE RT 2008. Many: Tsakok. Faster Incoherent Rays: Multi-BVH Ray Stream Tracing. HPG
///            2009; Barringer, Akenine-Moller. Dynamic Ray Stream Traversal. TOG 2014: a node is read once for all rays that
///            enter it. Deviation: sets of 64 rays as bits, all in the order of the first entry among them. Coherent ones:
///            Boulos, Wald, Shirley. Geometric and Arithmetic Culling Methods for Entire Ray Packets. Technical report
///            UUCS-06-010, 2006: sixteen rays against a box by intervals of their origins and reciprocal directions.
///            Deviation: intervals alone, and no search for the first ray that enters.
void closest_hits(const TwoLevels& scene, std::span<const Ray> rays, RawHit* hits, TraverseCounts* counts);

/// Tells for each ray whether anything is hit with t in [t_min, t_max]: 1 where `closest_hits` finds a hit, else 0.
/// is_hit     [ray_count]
/// counts, Cost, Source   as there. Children are visited in no order, and a ray that has hit something looks no further.
void any_hits(const TwoLevels& scene, std::span<const Ray> rays, uint8_t* is_hit, TraverseCounts* counts);

struct BlasHit {
    float t = std::numeric_limits<float>::infinity();
    float u = 0.0f, v = 0.0f;
    uint32_t primitive = kEmptyChild;
};

/// The same for one ray and one tree. Hits at t <= hit->t count, ties going to the lower primitive, so the caller sets
/// hit->t to the far end of the ray and hit->primitive to 0xffffffff, or passes a hit to improve on.
/// t_floor    entry into what holds the tree; no hit is nearer (see `intersect`).
/// Returns    true where `hit` was improved.
bool closest_hit(const Blas& blas, const RayFrame& ray, float t_floor, float t_min, BlasHit* hit, TraverseCounts* counts);
bool any_hit(const Blas& blas, const RayFrame& ray, float t_floor, float t_min, float t_max, TraverseCounts* counts);

/// The instruction set that the kernels run with on this processor: "sse4", "avx2", "avx3", "neon", "emu128", ...
const char* simd_target();

}  // namespace zoe
