#include "engine/frame/trace.h"

#include <algorithm>
#include <bit>
#include <cassert>

#include "engine/math/rng.h"

namespace zoe {

namespace {

// Hits are made of the kernels' in batches of this many, which stay in the cache.
constexpr size_t kBatch = 512;

Hit to_hit(const RawHit& raw) {
    return {raw.t, raw.u, raw.v, NodeId{raw.id}, raw.primitive};
}

}  // namespace

Hit closest_hit(const Tlas& tlas, const Ray& ray, TraverseCounts* counts) {
    RawHit hit;
    closest_hits(tlas.levels(), {&ray, 1}, &hit, counts);
    return to_hit(hit);
}

bool any_hit(const Tlas& tlas, const Ray& ray, TraverseCounts* counts) {
    uint8_t is_hit;
    any_hits(tlas.levels(), {&ray, 1}, &is_hit, counts);
    return is_hit;
}

void closest_hits(const Tlas& tlas, std::span<const Ray> rays, std::span<Hit> hits) {
    assert(rays.size() == hits.size());
    const RayBatch batch(tlas.watch.get());
    RawHit raw[kBatch];
    for (size_t begin = 0; begin < rays.size(); begin += kBatch) {
        const size_t count = std::min(kBatch, rays.size() - begin);
        closest_hits(tlas.levels(), rays.subspan(begin, count), raw, nullptr);
        std::transform(raw, raw + count, hits.begin() + begin, to_hit);
    }
}

void any_hits(const Tlas& tlas, std::span<const Ray> rays, std::span<uint8_t> is_hit) {
    assert(rays.size() == is_hit.size());
    const RayBatch batch(tlas.watch.get());
    any_hits(tlas.levels(), rays, is_hit.data(), nullptr);
}

uint64_t hash(const Hit& hit, uint64_t key) {
    uint64_t h = mix_bits(key ^ 0x9e3779b97f4a7c15ull);
    h = mix_bits(h ^ (uint64_t(std::bit_cast<uint32_t>(hit.t)) << 32 | index(hit.node)));
    h = mix_bits(h ^ (uint64_t(std::bit_cast<uint32_t>(hit.u)) << 32 | std::bit_cast<uint32_t>(hit.v)));
    return mix_bits(h ^ hit.primitive);
}

}  // namespace zoe
