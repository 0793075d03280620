#include "engine/bvh/traverse.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>
#include <new>
#include <string>
#include <utility>
#include <vector>

#include "engine/math/simd_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "engine/bvh/traverse.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>  // Compiles what follows once an instruction set.
#include <hwy/highway.h>

#include "engine/bvh/wide_space.inl"
// Which all of these read.
#include "engine/bvh/wide_kernel.inl"
#include "engine/bvh/wide_packet.inl"
#include "engine/bvh/wide_packet_triangle.inl"
#include "engine/bvh/wide_triangle.inl"
#include "engine/bvh/wide_walk.inl"
// Which these read.
#include "engine/bvh/wide_stream.inl"
// Which this one reads.
#include "engine/bvh/wide_packet_walk.inl"

HWY_BEFORE_NAMESPACE();
namespace zoe {
namespace HWY_NAMESPACE {

// Fewer rays than this don't pay for what a stream takes to set up.
constexpr size_t kFewestTogether = 8;

// A packet that tests more blocks of triangles than this with all its rays is wider than the triangles are. So will be
// those that follow it: the next rays go as streams.
constexpr uint32_t kDenseBlocks = 24;
constexpr size_t kRaysAfterDense = 4 * kStreamSize;

// Room for a stack, in place unless a tree is a degenerate one.
// Entry      anything that a stack is made of.
template <typename Entry>
class StackMemory {
public:
    explicit StackMemory(size_t size) {
        if (size + kSlack > kInPlace) more_.resize(size + kSlack);
    }
    Entry* data() { return more_.empty() ? in_place_ : more_.data(); }

private:
    // Vectors are stored whole; what lies above the top of a stack is scratch. At the bottom there is one entry more.
    static constexpr size_t kInPlace = 248, kSlack = kWidth + 1;
    Entry in_place_[kInPlace];
    std::vector<Entry> more_;
};

// Of a single ray or a packet.
struct WalkMemory {
    explicit WalkMemory(size_t size) : keys(size), children(size) {}
    Stack stack() { return {keys.data(), children.data()}; }
    StackMemory<uint32_t> keys, children;
};

void add(const TraverseCounts& more, TraverseCounts* counts) {
    if (!counts) return;
    counts->nodes += more.nodes;
    counts->triangles += more.triangles;
}

// A single tree in the world's space needs no level above it. Null where the scene is another one.
const PlacedBlas* only_tree(const TwoLevels& scene) {
    const uint32_t* child = scene.top->nodes[0].child;
    if (child[0] == kEmptyChild || !is_leaf(child[0]) || child[1] != kEmptyChild) return nullptr;
    const PlacedBlas& placed = scene.instances[first_block(child[0])];
    const bool is_whole = placed.start == 0 && !placed.blas->tree.nodes.empty();
    return placed.is_identity && is_whole ? &placed : nullptr;
}

template <bool kIsAny, typename Finish>
HWY_INLINE void trace_one_by_one(const TwoLevels& scene, const Ray* rays, size_t count, TraverseCounts* counts,
                                 Finish&& finish) {
    WalkMemory memory(scene.stack_size);
    Walk<kIsAny> walk;
    walk.stack = memory.stack();
    const PlacedBlas* only = only_tree(scene);
    if (only) {
        walk.blocks = only->blas->blocks.data();
        walk.id = only->id;
        walk.t_floor = 0.0f;
    }
    const WideNode* root = only ? only->blas->tree.nodes.data() : scene.top->nodes.data();
    for (size_t k = 0; k < count; ++k) {
        const Ray& ray = rays[k];
        walk.start(root, RawHit{.t = ray.t_max}, ray.t_min);
        if (walk.world.set(ray) && ray.t_min <= ray.t_max) {
            walk.world.widen(scene.slack);
            walk.is_in_instance = only != nullptr;
            trace(walk, &scene, 0);
        }
        finish(k, walk.hit, walk.is_found);
    }
    add(walk.counts, counts);
}

// Sixteen coherent rays in a row as a packet, all others in streams.
template <bool kIsAny, typename Finish>
HWY_INLINE void trace_together(const TwoLevels& scene, const Ray* rays, size_t count, TraverseCounts* counts,
                               Finish&& finish) {
    WalkMemory memory(scene.stack_size);
    StackMemory<StreamEntry> stream_memory(scene.stack_size);
    Stream stream(stream_memory.data());
    TraverseCounts work;
    const glm::vec3 size = scene.top->bounds().extent();
    const float extent = size.x + size.y + size.z;
    PacketHits found;
    Packet world(&found), local(&found);
    // The stream holds the rays before rays[end].
    const auto finish_stream = [&](size_t end) HWY_ATTR {
        trace_stream<kIsAny>(scene, &stream, &work);
        for (size_t n = 0; n < stream.size; ++n) finish(end - stream.size + n, stream.hits[n], (stream.found >> n & 1) != 0);
        stream.clear();
    };
    size_t next_packet = 0;  // Rays before this one are not tried as packets.
    for (size_t k = 0; k < count;) {
        const size_t end = std::min(k + kPacketSize, count);
        if (k >= next_packet && end - k == kPacketSize && set_packet(rays + k, extent, scene.slack, &world)) {
            finish_stream(k);
            const uint32_t blocks = trace_packet<kIsAny>(scene, world, local, memory.stack(), &stream, &work);
            if (blocks > kDenseBlocks) next_packet = end + kRaysAfterDense;
            stream.clear();
            for (size_t n = 0; n < kPacketSize; ++n) {
                finish(k + n, {found.t[n], found.u[n], found.v[n], found.id[n], found.primitive[n]},
                       found.id[n] != kEmptyChild);
            }
        } else {
            for (size_t n = k; n < end; ++n) stream.add(rays[n], scene.slack);
            if (stream.size == kStreamSize) finish_stream(end);
        }
        k = end;
    }
    finish_stream(count);
    add(work, counts);
}

template <bool kIsAny, typename Finish>
HWY_INLINE void trace_all(const TwoLevels& scene, const Ray* rays, size_t count, TraverseCounts* counts, Finish&& finish) {
    if (scene.top->nodes.empty()) {
        for (size_t k = 0; k < count; ++k) finish(k, RawHit{}, false);
    } else if (count < kFewestTogether) {
        trace_one_by_one<kIsAny>(scene, rays, count, counts, finish);
    } else {
        trace_together<kIsAny>(scene, rays, count, counts, finish);
    }
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
    WalkMemory memory(blas.tree.stack_size());
    walk.stack = memory.stack();
    walk.blocks = blas.blocks.data();
    walk.t_floor = t_floor;
    walk.id = 0;
    walk.is_in_instance = true;
    walk.world.set(frame);
    walk.start(blas.tree.nodes.data(), {hit->t, hit->u, hit->v, 0, hit->primitive}, t_min);
    trace<kIsAny>(walk, nullptr, 0);
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
    static const std::string name = [] {
        std::string lower = hwy::TargetName(HWY_TARGET);
        for (char& c : lower) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
        return lower;
    }();
    return name.c_str();
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
