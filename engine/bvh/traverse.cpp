#include "engine/bvh/traverse.h"

#include <bit>
#include <limits>
#include <new>
#include <utility>
#include <vector>

// Processors without any vectors run an emulation of them: the compiler error that keeps Highway from it by default
// (GCC 106322) is one of integer products, of which there are none here.
#define HWY_BROKEN_EMU128 0
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "engine/bvh/traverse.cpp"
#include "hwy/foreach_target.h"  // Compiles what follows once an instruction set.
#include "hwy/highway.h"

#include "engine/bvh/wide_kernel.inl"

HWY_BEFORE_NAMESPACE();
namespace zoe {
namespace HWY_NAMESPACE {

// Pushed below the root of an instance's tree: the ray goes back to the world. Never culled.
constexpr uint32_t kLeave = kEmptyChild;
// Vectors are stored whole; what lies above the top is scratch.
constexpr size_t kStackSlack = kWidth;

// A ray on its way.
template <bool kIsAny>
struct Walk {
    Space space;  // Of what `nodes` and `blocks` belong to.
    const WideNode* nodes;
    const TriangleBlock* blocks;
    Stack stack;
    RawHit hit;
    uint32_t limit_key;  // Stack entries with a larger key are behind the closest hit.
    float t_floor, t_min;
    uint32_t id;  // Of the instance that the ray is in.
    bool is_in_instance;
    bool is_found;
    TraverseCounts counts;
    Space world;
    RayFrame world_frame, local_frame;

    explicit Walk(const RayFrame& frame) : world_frame(frame), local_frame(frame) {}

    void start(const WideBvh& tree, float t_max) {
        stack.size = 0;
        if (!tree.nodes.empty()) push(0, 0);
        is_found = false;
        hit = RawHit{.t = t_max};
        set_limit();
    }
    void push(uint32_t key, uint32_t child) {
        stack.keys[stack.size] = key;
        stack.children[stack.size++] = child;
    }
    void set_limit() { limit_key = std::bit_cast<uint32_t>(hit.t * kCullPad) | kSlotMask; }
};

template <bool kIsAny>
HWY_INLINE void test_leaf(Walk<kIsAny>& walk, uint32_t child) {
    const TriangleBlock* block = walk.blocks + first_block(child);
    for (const TriangleBlock* end = block + block_count(child); block != end; ++block) {
        walk.counts.triangles += TriangleBlock::kSize;
        test_block(*block, walk.space, walk.t_floor, walk.t_min, walk.hit.t,
                   [&](float t, float u, float v, uint32_t primitive) HWY_ATTR {
                       RawHit& hit = walk.hit;
                       const bool is_closer =
                           t < hit.t || (t == hit.t && (walk.id < hit.id || (walk.id == hit.id && primitive < hit.primitive)));
                       if (!is_closer) return;
                       hit = {t, u, v, walk.id, primitive};
                       walk.is_found = true;
                       walk.set_limit();
                   });
        if (kIsAny && walk.is_found) return;
    }
}

template <bool kIsAny>
HWY_INLINE void enter_instance(Walk<kIsAny>& walk, const PlacedBlas& placed, const Ray& ray) {
    walk.t_floor = entry(walk.world_frame, placed.bounds_world.lo, placed.bounds_world.hi, walk.hit.t);
    if (!(walk.t_floor < std::numeric_limits<float>::infinity())) return;
    if (!placed.is_identity) {
        // The direction is not normalised, so t stays in the world's unit.
        walk.local_frame = RayFrame(Ray{.origin = placed.local_from_world.point(ray.origin),
                                        .direction = placed.local_from_world.vector(ray.direction),
                                        .t_min = ray.t_min});
        if (!walk.local_frame.is_valid) return;
        walk.space.set(walk.local_frame);
    }
    walk.nodes = placed.blas->tree.nodes.data();
    walk.blocks = placed.blas->blocks.data();
    walk.id = placed.id;
    walk.is_in_instance = true;
    walk.push(0, kLeave);
    walk.push(0, 0);
}

// Takes the next entry from the stack. Returns false where there is none.
template <bool kIsAny>
HWY_INLINE bool step(Walk<kIsAny>& walk, const TwoLevels& scene, const Ray* ray) {
    do {
        if (walk.stack.size == 0) return false;
        --walk.stack.size;
    } while (!kIsAny && walk.stack.keys[walk.stack.size] > walk.limit_key);
    const uint32_t child = walk.stack.children[walk.stack.size];
    if (!is_leaf(child)) {
        ++walk.counts.nodes;
        push_children<kIsAny>(walk.nodes[child], walk.space, walk.hit.t, &walk.stack);
    } else if (child == kLeave) {
        walk.is_in_instance = false;
        walk.space = walk.world;
        walk.nodes = scene.top->nodes.data();
    } else if (walk.is_in_instance) {
        test_leaf(walk, child);
        if (kIsAny && walk.is_found) return false;
    } else {
        enter_instance(walk, scene.instances[first_block(child)], *ray);
    }
    return true;
}

// Room for the stack of one ray, in place unless the tree is a degenerate one.
class StackMemory {
public:
    StackMemory(size_t size, Stack* stack) {
        uint32_t* memory = in_place_;
        if (size + kStackSlack > kInPlace) {
            more_.resize(2 * (size + kStackSlack));
            memory = more_.data();
        }
        stack->keys = memory;
        stack->children = memory + (more_.empty() ? kInPlace : size + kStackSlack);
    }

private:
    static constexpr size_t kInPlace = 256;
    uint32_t in_place_[2 * kInPlace];
    std::vector<uint32_t> more_;
};

void closest_hits_batch(const TwoLevels& scene, const Ray* rays, size_t count, RawHit* hits, TraverseCounts* counts) {
    Walk<false> walk{RayFrame(Ray{})};
    const StackMemory memory(scene.stack_size, &walk.stack);
    for (size_t k = 0; k < count; ++k) {
        const Ray& ray = rays[k];
        hits[k] = RawHit{};
        walk.world_frame = RayFrame(ray);
        if (!walk.world_frame.is_valid || !(ray.t_min <= ray.t_max)) continue;
        walk.world.set(walk.world_frame);
        walk.space = walk.world;
        walk.nodes = scene.top->nodes.data();
        walk.t_min = ray.t_min;
        walk.is_in_instance = false;
        walk.start(*scene.top, ray.t_max);
        while (step(walk, scene, &ray)) {}
        if (walk.is_found) hits[k] = walk.hit;
    }
    if (counts) {
        counts->nodes += walk.counts.nodes;
        counts->triangles += walk.counts.triangles;
    }
}

void any_hits_batch(const TwoLevels& scene, const Ray* rays, size_t count, uint8_t* is_hit, TraverseCounts* counts) {
    Walk<true> walk{RayFrame(Ray{})};
    const StackMemory memory(scene.stack_size, &walk.stack);
    for (size_t k = 0; k < count; ++k) {
        const Ray& ray = rays[k];
        is_hit[k] = 0;
        walk.world_frame = RayFrame(ray);
        if (!walk.world_frame.is_valid || !(ray.t_min <= ray.t_max)) continue;
        walk.world.set(walk.world_frame);
        walk.space = walk.world;
        walk.nodes = scene.top->nodes.data();
        walk.t_min = ray.t_min;
        walk.is_in_instance = false;
        walk.start(*scene.top, ray.t_max);
        while (step(walk, scene, &ray)) {}
        is_hit[k] = walk.is_found;
    }
    if (counts) {
        counts->nodes += walk.counts.nodes;
        counts->triangles += walk.counts.triangles;
    }
}

template <bool kIsAny>
bool hit_blas(const Blas& blas, const RayFrame& frame, float t_floor, float t_min, BlasHit* hit, TraverseCounts* counts) {
    if (!frame.is_valid || !(t_min <= hit->t)) return false;
    Walk<kIsAny> walk{frame};
    const StackMemory memory(blas.tree.stack_size(), &walk.stack);
    walk.space.set(frame);
    walk.nodes = blas.tree.nodes.data();
    walk.blocks = blas.blocks.data();
    walk.t_floor = t_floor;
    walk.t_min = t_min;
    walk.id = 0;
    walk.is_in_instance = true;
    walk.start(blas.tree, hit->t);
    walk.hit = {hit->t, hit->u, hit->v, 0, hit->primitive};
    while (step(walk, TwoLevels{}, nullptr)) {}
    if (walk.is_found) *hit = {walk.hit.t, walk.hit.u, walk.hit.v, walk.hit.primitive};
    if (counts) {
        counts->nodes += walk.counts.nodes;
        counts->triangles += walk.counts.triangles;
    }
    return walk.is_found;
}

bool closest_hit_blas(const Blas& blas, const RayFrame& frame, float t_floor, float t_min, BlasHit* hit,
                      TraverseCounts* counts) {
    return hit_blas<false>(blas, frame, t_floor, t_min, hit, counts);
}

bool any_hit_blas(const Blas& blas, const RayFrame& frame, float t_floor, float t_min, BlasHit* hit,
                  TraverseCounts* counts) {
    return hit_blas<true>(blas, frame, t_floor, t_min, hit, counts);
}

const char* target() {
    return hwy::TargetName(HWY_TARGET);
}

}  // namespace HWY_NAMESPACE
}  // namespace zoe
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace zoe {

HWY_EXPORT(closest_hits_batch);
HWY_EXPORT(any_hits_batch);
HWY_EXPORT(closest_hit_blas);
HWY_EXPORT(any_hit_blas);
HWY_EXPORT(target);

void closest_hits(const TwoLevels& scene, std::span<const Ray> rays, RawHit* hits, TraverseCounts* counts) {
    HWY_DYNAMIC_DISPATCH(closest_hits_batch)(scene, rays.data(), rays.size(), hits, counts);
}

void any_hits(const TwoLevels& scene, std::span<const Ray> rays, uint8_t* is_hit, TraverseCounts* counts) {
    HWY_DYNAMIC_DISPATCH(any_hits_batch)(scene, rays.data(), rays.size(), is_hit, counts);
}

bool closest_hit(const Blas& blas, const RayFrame& ray, float t_floor, float t_min, BlasHit* hit, TraverseCounts* counts) {
    return HWY_DYNAMIC_DISPATCH(closest_hit_blas)(blas, ray, t_floor, t_min, hit, counts);
}

bool any_hit(const Blas& blas, const RayFrame& ray, float t_floor, float t_min, float t_max, TraverseCounts* counts) {
    BlasHit hit{.t = t_max};
    return HWY_DYNAMIC_DISPATCH(any_hit_blas)(blas, ray, t_floor, t_min, &hit, counts);
}

const char* simd_target() {
    return HWY_DYNAMIC_DISPATCH(target)();
}

}  // namespace zoe

#endif  // HWY_ONCE
