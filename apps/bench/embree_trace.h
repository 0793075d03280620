#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "apps/bench/embree_layout.h"

namespace zoe {

/// Traces batches of rays. Keeps its memory from call to call.
class EmbreeTracer {
public:
    /// The clock runs while Embree traces, not while rays and hits change their form. In tasks of kRaysATask.
    /// hits       [ray_count]
    /// Returns    ms.
    /// Throws     std::runtime_error where a ray is beyond Embree's range, and as `timed_parallel`; so does the other.
    double closest_hits(const EmbreeTarget& target, std::span<const Ray> rays, EmbreeRays form, std::span<Hit> hits);
    /// is_hit     [ray_count] 1 or 0.
    double any_hits(const EmbreeTarget& target, std::span<const Ray> rays, EmbreeRays form, std::span<uint8_t> is_hit);

private:
    std::vector<RTCRayHit> closest_;
    std::vector<RTCRayHit16> closest_packets_;
    std::vector<RTCRay> any_;
    std::vector<RTCRay16> any_packets_;
};

}  // namespace zoe
