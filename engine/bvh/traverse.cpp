#include "engine/bvh/traverse.h"

#include <bit>
#include <limits>
#include <new>
#include <utility>
#include <vector>

// Processors without any vectors run an emulation of them: the compiler error that keeps Highway from it by default
// (GCC 106322) is one of integer products, of which there are none here.
#define HWY_BROKEN_EMU128 0
// Not compiled: targets that differ from the next older one only in what is not used here, and vectors of no fixed size.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "engine/bvh/traverse.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>  // Compiles what follows once an instruction set.
#include <hwy/highway.h>

#include "engine/bvh/wide_kernel.inl"
#include "engine/bvh/wide_packet.inl"

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
    const WideNode* nodes;
    const TriangleBlock* blocks;
    Stack stack;
    RawHit hit;
    float limit;         // Boxes entered behind it hold nothing closer than `hit`.
    uint32_t limit_key;  // The same for entries of the stack.
    float t_floor, t_min;
    uint32_t id;  // Of the instance that the ray is in.
    bool is_in_instance;
    bool is_found;
    TraverseCounts counts;
    Space world, local;

    void start(const WideNode* root, const RawHit& best, float begin) {
        stack.size = 0;
        nodes = root;
        hit = best;
        t_min = begin;
        is_found = false;
        set_limit();
    }
    void set_limit() {
        limit = hit.t * kCullPad;
        limit_key = std::bit_cast<uint32_t>(limit) | kSlotMask;
    }
};

template <bool kIsAny>
HWY_INLINE void test_leaf(Walk<kIsAny>& walk, Space& space, uint32_t child) {
    const TriangleBlock* block = walk.blocks + first_block(child);
    space.need_frame();
    for (const TriangleBlock* end = block + block_count(child); block != end; ++block) {
        walk.counts.triangles += TriangleBlock::kSize;
        test_block(*block, space, walk.t_floor, walk.t_min, walk.hit.t,
                   [&](float t, float u, float v, uint32_t primitive) HWY_ATTR {
                       RawHit& hit = walk.hit;
                       const bool is_closer =
                           t < hit.t ||
                           (t == hit.t && (walk.id < hit.id || (walk.id == hit.id && primitive < hit.primitive)));
                       if (!is_closer) return;
                       hit = {t, u, v, walk.id, primitive};
                       walk.is_found = true;
                       walk.set_limit();
                   });
        if (kIsAny && walk.is_found) return;
    }
}

// Returns false where the ray does not enter the instance's box.
template <bool kIsAny>
HWY_INLINE bool enter_instance(Walk<kIsAny>& walk, const PlacedBlas& placed, const Ray& ray) {
    // Where no transform lies between, the tree's boxes are in the world's: no entry is nearer than the floor would be.
    walk.t_floor = 0.0f;
    if (!placed.is_identity) {
        walk.t_floor = entry(walk.world.frame, placed.bounds_world.lo, placed.bounds_world.hi, walk.hit.t);
        if (!(walk.t_floor < std::numeric_limits<float>::infinity())) return false;
        // The direction is not normalised, so t stays in the world's unit.
        const Ray local{.origin = placed.local_from_world.point(ray.origin),
                        .direction = placed.local_from_world.vector(ray.direction),
                        .t_min = ray.t_min};
        const SlabRay slabs(local);
        if (!slabs.is_valid) return false;
        walk.local.set(slabs, local.direction);
    }
    walk.nodes = placed.blas->tree.nodes.data();
    walk.blocks = placed.blas->blocks.data();
    walk.id = placed.id;
    walk.is_in_instance = true;
    return true;
}

// Takes a ray from the root of `walk.nodes` to its end.
// scene      null where that is no top level.
template <bool kIsAny>
HWY_INLINE void trace(Walk<kIsAny>& walk, const TwoLevels* scene, const Ray* ray) {
    Space* space = &walk.world;
    BoxRay boxes(*space);
    uint32_t at = 0;
    for (;;) {
        bool has_next = false;
        if (HWY_LIKELY(!is_leaf(at))) {
            ++walk.counts.nodes;
            has_next = next_child<kIsAny>(walk.nodes[at], boxes, walk.limit, &walk.stack, &at);
        } else if (at == kLeave) {
            walk.is_in_instance = false;
            space = &walk.world;
            boxes = BoxRay(*space);
            walk.nodes = scene->top->nodes.data();
        } else if (walk.is_in_instance) {
            test_leaf(walk, *space, at);
            if (kIsAny && walk.is_found) return;
        } else {
            const PlacedBlas& placed = scene->instances[first_block(at)];
            has_next = enter_instance(walk, placed, *ray);
            if (has_next) {
                if (walk.stack.size > 0) {
                    walk.stack.keys[walk.stack.size] = 0;
                    walk.stack.children[walk.stack.size++] = kLeave;
                }
                at = 0;
                if (!placed.is_identity) {
                    space = &walk.local;
                    boxes = BoxRay(*space);
                }
            }
        }
        if (has_next) continue;
        do {
            if (walk.stack.size == 0) return;
            --walk.stack.size;
        } while (!kIsAny && walk.stack.keys[walk.stack.size] > walk.limit_key);
        at = walk.stack.children[walk.stack.size];
    }
}

// Room for the stacks of a few rays, in place unless a tree is a degenerate one.
template <size_t kCount>
class StackMemory {
public:
    explicit StackMemory(size_t size) : size_(size + kStackSlack) {
        if (size_ > kInPlace) more_.resize(2 * kCount * size_);
    }
    Stack operator[](size_t k) {
        uint32_t* memory = more_.empty() ? in_place_ + 2 * kInPlace * k : more_.data() + 2 * size_ * k;
        return {memory, memory + (more_.empty() ? kInPlace : size_)};
    }

private:
    static constexpr size_t kInPlace = 248;
    size_t size_;
    uint32_t in_place_[2 * kInPlace * kCount];
    std::vector<uint32_t> more_;
};

void add(const TraverseCounts& more, TraverseCounts* counts) {
    if (!counts) return;
    counts->nodes += more.nodes;
    counts->triangles += more.triangles;
}

// A packet's rays one by one through an instance of a space of its own, each from the hit that it has.
template <bool kIsAny>
HWY_INLINE void trace_one_by_one(const PlacedBlas& placed, Packet& packet, Walk<kIsAny>& walk) {
    for (size_t k = 0; k < kPacketSize; ++k) {
        const Ray& ray = packet.rays[k];
        if (kIsAny && packet.t[k] < 0.0f) continue;
        walk.start(nullptr, {packet.t[k], packet.u[k], packet.v[k], packet.id[k], packet.primitive[k]}, ray.t_min);
        walk.world.set(SlabRay(ray), ray.direction);
        if (!enter_instance(walk, placed, ray)) continue;
        walk.world = walk.local;
        trace<kIsAny>(walk, nullptr, nullptr);
        if (!walk.is_found) continue;
        packet.t[k] = kIsAny ? -1.0f : walk.hit.t;
        packet.u[k] = walk.hit.u;
        packet.v[k] = walk.hit.v;
        packet.id[k] = walk.hit.id;
        packet.primitive[k] = walk.hit.primitive;
    }
}

// Takes sixteen rays through the scene together.
template <bool kIsAny>
HWY_INLINE void trace_packet(const TwoLevels& scene, Packet& packet, Walk<kIsAny>& walk) {
    const Stack bottom = walk.stack;
    Stack stack = bottom;
    stack.size = 0;
    const WideNode* nodes = scene.top->nodes.data();
    const TriangleBlock* blocks = nullptr;
    uint32_t id = 0, at = 0, limit_key = 0;
    float limit = 0.0f;
    bool is_in_instance = false;
    const auto set_limit = [&]() HWY_ATTR {
        limit = range_of(packet.t).high * kCullPad;
        limit_key = std::bit_cast<uint32_t>(limit) | kSlotMask;
        return limit >= 0.0f;
    };
    set_limit();
    for (;;) {
        bool has_next = false;
        if (!is_leaf(at)) {
            ++walk.counts.nodes;
            has_next = next_child<kIsAny>(nodes[at], packet.boxes, limit, &stack, &at);
        } else if (at == kLeave) {
            is_in_instance = false;
            nodes = scene.top->nodes.data();
        } else if (is_in_instance) {
            bool is_found = false;
            for (uint32_t k = 0; k < block_count(at); ++k) {
                walk.counts.triangles += TriangleBlock::kSize;
                is_found |= test_block<kIsAny>(blocks[first_block(at) + k], id, &packet);
            }
            if (is_found && !set_limit()) break;
        } else {
            const PlacedBlas& placed = scene.instances[first_block(at)];
            if (placed.is_identity) {
                if (stack.size > 0) {
                    stack.keys[stack.size] = 0;
                    stack.children[stack.size++] = kLeave;
                }
                nodes = placed.blas->tree.nodes.data();
                blocks = placed.blas->blocks.data();
                id = placed.id;
                is_in_instance = true;
                at = 0;
                has_next = true;
            } else {
                walk.stack.keys = bottom.keys + stack.size;
                walk.stack.children = bottom.children + stack.size;
                trace_one_by_one(placed, packet, walk);
                if (!set_limit()) break;
            }
        }
        if (has_next) continue;
        do {
            if (stack.size == 0) {
                walk.stack = bottom;
                return;
            }
            --stack.size;
        } while (!kIsAny && stack.keys[stack.size] > limit_key);
        at = stack.children[stack.size];
    }
    walk.stack = bottom;
}

template <bool kIsAny, typename Finish>
HWY_INLINE void trace_all(const TwoLevels& scene, const Ray* rays, size_t count, TraverseCounts* counts, Finish&& finish) {
    if (scene.top->nodes.empty()) {
        for (size_t k = 0; k < count; ++k) finish(k, RawHit{}, false);
        return;
    }
    StackMemory<1> memory(scene.stack_size);
    Walk<kIsAny> walk;
    walk.stack = memory[0];
    const auto trace_single = [&](size_t k) HWY_ATTR {
        const Ray& ray = rays[k];
        const SlabRay slabs(ray);
        walk.start(scene.top->nodes.data(), RawHit{.t = ray.t_max}, ray.t_min);
        if (slabs.is_valid && ray.t_min <= ray.t_max) {
            walk.is_in_instance = false;
            walk.world.set(slabs, ray.direction);
            trace(walk, &scene, &ray);
        }
        finish(k, walk.hit, walk.is_found);
    };
    size_t k = 0;
    if (count >= kPacketSize) {
        const glm::vec3 size = scene.top->bounds().extent();
        const float extent = size.x + size.y + size.z;
        Packet packet;
        for (; k + kPacketSize <= count; k += kPacketSize) {
            if (set_packet(rays + k, extent, &packet)) {
                trace_packet(scene, packet, walk);
                for (size_t n = 0; n < kPacketSize; ++n) {
                    finish(k + n, {packet.t[n], packet.u[n], packet.v[n], packet.id[n], packet.primitive[n]},
                           packet.id[n] != kEmptyChild);
                }
            } else {
                for (size_t n = 0; n < kPacketSize; ++n) trace_single(k + n);
            }
        }
    }
    for (; k < count; ++k) trace_single(k);
    add(walk.counts, counts);
}

void closest_hits_batch(const TwoLevels& scene, const Ray* rays, size_t count, RawHit* hits, TraverseCounts* counts) {
    trace_all<false>(scene, rays, count, counts,
                     [&](size_t k, const RawHit& hit, bool is_found) { hits[k] = is_found ? hit : RawHit{}; });
}

void any_hits_batch(const TwoLevels& scene, const Ray* rays, size_t count, uint8_t* is_hit, TraverseCounts* counts) {
    trace_all<true>(scene, rays, count, counts, [&](size_t k, const RawHit&, bool is_found) { is_hit[k] = is_found; });
}

template <bool kIsAny>
bool hit_blas(const Blas& blas, const RayFrame& frame, float t_floor, float t_min, BlasHit* hit, TraverseCounts* counts) {
    if (!frame.is_valid || !(t_min <= hit->t) || blas.tree.nodes.empty()) return false;
    Walk<kIsAny> walk;
    StackMemory<1> memory(blas.tree.stack_size());
    walk.stack = memory[0];
    walk.blocks = blas.blocks.data();
    walk.t_floor = t_floor;
    walk.id = 0;
    walk.is_in_instance = true;
    walk.world.set(frame, glm::vec3(0.0f));
    walk.world.set_frame(frame);
    walk.start(blas.tree.nodes.data(), {hit->t, hit->u, hit->v, 0, hit->primitive}, t_min);
    trace<kIsAny>(walk, nullptr, nullptr);
    if (walk.is_found) *hit = {walk.hit.t, walk.hit.u, walk.hit.v, walk.hit.primitive};
    add(walk.counts, counts);
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
