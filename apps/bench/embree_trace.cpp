#include "apps/bench/embree_trace.h"

#include <algorithm>
#include <array>
#include <cassert>

#if defined(__SSE2__)
#include <immintrin.h>
#endif

#include "apps/bench/timed_parallel.h"
#include "engine/math/parallel.h"

namespace zoe {
namespace {

constexpr size_t kLanes = 16;
static_assert(kRaysATask % kLanes == 0, "a packet lies in one task");

/// Flushes denormal numbers to zero on this thread while it lives, as Embree's manual asks; the engine must not see that.
class FlushDenormals {
public:
#if defined(__SSE2__)
    FlushDenormals() : saved_(_mm_getcsr()) {
        constexpr unsigned flush_to_zero = 1u << 15, denormals_are_zero = 1u << 6;
        _mm_setcsr(saved_ | flush_to_zero | denormals_are_zero);
    }
    ~FlushDenormals() {
        _mm_setcsr(saved_);
    }
    FlushDenormals(const FlushDenormals&) = delete;
    FlushDenormals& operator=(const FlushDenormals&) = delete;

private:
    unsigned saved_;
#else
    FlushDenormals() {}
#endif
};

RTCIntersectContext context_for(EmbreeRays form) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags =
        form == EmbreeRays::kCoherentPackets ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    return context;
}

RTCRay to_single(const Ray& ray) {
    return {.org_x = ray.origin.x,
            .org_y = ray.origin.y,
            .org_z = ray.origin.z,
            .tnear = ray.t_min,
            .dir_x = ray.direction.x,
            .dir_y = ray.direction.y,
            .dir_z = ray.direction.z,
            .time = 0.0f,
            .tfar = ray.t_max,
            .mask = 0xffffffffu,
            .id = 0,
            .flags = 0};
}

void put(const Ray& ray, size_t lane, RTCRay16* packet) {
    packet->org_x[lane] = ray.origin.x;
    packet->org_y[lane] = ray.origin.y;
    packet->org_z[lane] = ray.origin.z;
    packet->tnear[lane] = ray.t_min;
    packet->dir_x[lane] = ray.direction.x;
    packet->dir_y[lane] = ray.direction.y;
    packet->dir_z[lane] = ray.direction.z;
    packet->time[lane] = 0.0f;
    packet->tfar[lane] = ray.t_max;
    packet->mask[lane] = 0xffffffffu;
    packet->id[lane] = 0;
    packet->flags[lane] = 0;
}

/// Ids are instance ids where there are instances.
Hit to_hit(const EmbreeTarget& target, float t, float u, float v, unsigned primitive, unsigned geometry, unsigned instance) {
    if (geometry == RTC_INVALID_GEOMETRY_ID) return {};
    const NodeId node = target.nodes[instance != RTC_INVALID_GEOMETRY_ID ? instance : geometry];
    return {.t = t, .u = u, .v = v, .node = node, .primitive = primitive};
}

/// Calls `one(k, context)` for items 0 to item_count in tasks. Returns ms.
template <typename One>
double timed_tasks(size_t item_count, size_t items_a_task, EmbreeRays form, One&& one) {
    return timed_parallel(item_count, items_a_task, [&](size_t begin, size_t end) {
        const FlushDenormals flush;
        RTCIntersectContext context = context_for(form);
        for (size_t k = begin; k < end; ++k) one(k, &context);
    });
}

size_t packet_count(size_t ray_count) {
    return (ray_count + kLanes - 1) / kLanes;
}

/// Which lanes of a packet hold rays: all but in the last.
struct alignas(64) Lanes {
    std::array<int, kLanes> is_valid;
    Lanes(size_t ray_count, size_t packet) {
        const size_t count = std::min(kLanes, ray_count - packet * kLanes);
        for (size_t lane = 0; lane < kLanes; ++lane) is_valid[lane] = lane < count ? -1 : 0;
    }
};

/// Changes the form of many rays or hits at once.
template <typename One>
void for_all(size_t count, One&& one) {
    parallel_for(0, count, kRaysATask, [&](size_t begin, size_t end) {
        for (size_t k = begin; k < end; ++k) one(k);
    });
}

}  // namespace

double EmbreeTracer::closest_hits(const EmbreeTarget& target, std::span<const Ray> rays, EmbreeRays form,
                                  std::span<Hit> hits) {
    assert(rays.size() == hits.size());
    require_in_embree_range(rays, target.reach);
    const RTCScene scene = target.scene;
    if (form == EmbreeRays::kSingle) {
        closest_.resize(rays.size());
        for_all(rays.size(), [&](size_t k) {
            closest_[k].ray = to_single(rays[k]);
            closest_[k].hit.geomID = RTC_INVALID_GEOMETRY_ID;
            closest_[k].hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
        });
        const double ms = timed_tasks(rays.size(), kRaysATask, form, [&](size_t k, RTCIntersectContext* context) {
            rtcIntersect1(scene, context, &closest_[k]);
        });
        for_all(rays.size(), [&](size_t k) {
            const RTCHit& hit = closest_[k].hit;
            hits[k] = to_hit(target, closest_[k].ray.tfar, hit.u, hit.v, hit.primID, hit.geomID, hit.instID[0]);
        });
        return ms;
    }
    const size_t count = packet_count(rays.size());
    closest_packets_.resize(count);
    for_all(rays.size(), [&](size_t k) {
        RTCRayHit16& packet = closest_packets_[k / kLanes];
        put(rays[k], k % kLanes, &packet.ray);
        packet.hit.geomID[k % kLanes] = RTC_INVALID_GEOMETRY_ID;
        packet.hit.instID[0][k % kLanes] = RTC_INVALID_GEOMETRY_ID;
    });
    const double ms = timed_tasks(count, kRaysATask / kLanes, form, [&](size_t k, RTCIntersectContext* context) {
        const Lanes lanes(rays.size(), k);
        rtcIntersect16(lanes.is_valid.data(), scene, context, &closest_packets_[k]);
    });
    for_all(rays.size(), [&](size_t k) {
        const size_t lane = k % kLanes;
        const RTCRayHit16& packet = closest_packets_[k / kLanes];
        const RTCHit16& hit = packet.hit;
        hits[k] = to_hit(target, packet.ray.tfar[lane], hit.u[lane], hit.v[lane], hit.primID[lane], hit.geomID[lane],
                         hit.instID[0][lane]);
    });
    return ms;
}

double EmbreeTracer::any_hits(const EmbreeTarget& target, std::span<const Ray> rays, EmbreeRays form,
                              std::span<uint8_t> is_hit) {
    assert(rays.size() == is_hit.size());
    require_in_embree_range(rays, target.reach);
    const RTCScene scene = target.scene;
    // A ray that hits something comes back with a far end of minus infinity.
    constexpr float kHitMark = -std::numeric_limits<float>::infinity();
    if (form == EmbreeRays::kSingle) {
        any_.resize(rays.size());
        for_all(rays.size(), [&](size_t k) { any_[k] = to_single(rays[k]); });
        const double ms = timed_tasks(rays.size(), kRaysATask, form, [&](size_t k, RTCIntersectContext* context) {
            rtcOccluded1(scene, context, &any_[k]);
        });
        for_all(rays.size(), [&](size_t k) { is_hit[k] = any_[k].tfar == kHitMark; });
        return ms;
    }
    const size_t count = packet_count(rays.size());
    any_packets_.resize(count);
    for_all(rays.size(), [&](size_t k) { put(rays[k], k % kLanes, &any_packets_[k / kLanes]); });
    const double ms = timed_tasks(count, kRaysATask / kLanes, form, [&](size_t k, RTCIntersectContext* context) {
        const Lanes lanes(rays.size(), k);
        rtcOccluded16(lanes.is_valid.data(), scene, context, &any_packets_[k]);
    });
    for_all(rays.size(), [&](size_t k) { is_hit[k] = any_packets_[k / kLanes].tfar[k % kLanes] == kHitMark; });
    return ms;
}

}  // namespace zoe
