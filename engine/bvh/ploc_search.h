#pragma once

#include <cstdint>

namespace zoe {

/// Clusters side by side, by component, with room before and after them.
struct ClusterRow {
    const float* planes[6];  ///< lo.x, hi.x, lo.y, hi.y, lo.z, hi.z, each from the first place on.
    uint32_t first;          ///< Place of cluster 0, even.
    uint32_t count;
};

/// At most so many clusters are looked at side by side.
inline constexpr uint32_t kSearchLanes = 16;
inline constexpr uint32_t kNoCluster = 0xffffffffu;

/// Finds out whom each cluster in [begin, end) makes the box of least area with, of those at most `radius` places away. Of
/// equal areas, the one decides whose place differs in the lowest bits (least place ^ other place): the same on both sides
/// of a pair and no other partner's. So choices lead to ever lesser pairs, some two always choose each other, and where all
/// areas are equal, every two neighbours do.
/// row        boxes without NaN; infinite ones at `radius` places before the first, and after the last one at radius +
///            kSearchLanes.
/// partners   result: [end - begin], with room for kSearchLanes more; kNoCluster where there is none.
/// Cost       O(clusters * radius), by the best instruction set that the processor has; the same choices on all of them.
void find_partners(const ClusterRow& row, uint32_t begin, uint32_t end, uint32_t radius, uint32_t* partners);

}  // namespace zoe
