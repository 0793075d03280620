#pragma once

#include <cstdint>

#include "engine/math/aabb.h"

namespace zoe {

/// What holds for all clusters of each of sixteen subtrees, by component; of a single one, its own box, size and id. The
/// initial values are of no cluster at all: the neutral ones, which make every union infinite.
struct alignas(64) ClusterGroup {
    static constexpr uint32_t kWidth = 16;

    float max_lo[3][kWidth];      ///< No box starts after it,
    float min_hi[3][kWidth];      ///< none ends before it,
    float min_extent[3][kWidth];  ///< and none is smaller.
    int32_t min_count[kWidth];    ///< No cluster has fewer boxes,
    int32_t min_id[kWidth];       ///< and none of so many a lower id; kNoId: no cluster.

    static constexpr int32_t kNoId = 0x7fffffff;

    bool is_empty(uint32_t lane) const { return min_id[lane] == kNoId; }
    /// Of a lane that is one cluster.
    uint32_t id(uint32_t lane) const { return static_cast<uint32_t>(min_id[lane]); }
    /// Places farther than kFarthest count as there, and boxes grow to kSmallest, so that no area overflows, nor comes to a
    /// number below the smallest normal float, which takes some processors a hundred times as long.
    void set(uint32_t lane, const Aabb& box, uint32_t id);
    /// Makes it the union with another one, of a higher id.
    void extend(uint32_t lane, const ClusterGroup& by, uint32_t by_lane);
    void clear(uint32_t lane);
    void copy(uint32_t lane, const ClusterGroup& from, uint32_t from_lane);

    static constexpr float kFarthest = 1e18f, kSmallest = 0x1p-62f;
};

/// Clusters in a tree. In level 0 the lanes are clusters, above they are the groups of the level below: lane k % 16 of group
/// k / 16 sums up group k. The last level is one group.
struct ClusterTree {
    static constexpr uint32_t kMaxLevels = 8;  ///< 16^8 clusters.

    ClusterGroup* levels[kMaxLevels];
    uint32_t level_count;
};

/// Sums up anew what is above a slot, until nothing changes.
void refit_clusters(const ClusterTree& tree, uint32_t slot);

/// Sums up every level, in groups that are full but for the last of each level.
/// slot_count how many slots of level 0 are in use.
void sum_up_clusters(const ClusterTree& tree, uint32_t slot_count);

}  // namespace zoe
