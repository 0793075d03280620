#pragma once

#include <cstdint>

#include "engine/math/aabb.h"

namespace zoe {

inline constexpr uint32_t kNoPartner = 0xffffffffu;

/// What holds for all clusters of each of sixteen subtrees, by component; of a single one, its own box, size and id. The
/// initial values are of no cluster at all: the neutral ones, which make every union infinite.
struct alignas(64) ClusterGroup {
    static constexpr uint32_t kWidth = 16;

    float max_lo[3][kWidth];      ///< No box starts after it,
    float min_hi[3][kWidth];      ///< none ends before it,
    float min_extent[3][kWidth];  ///< and none is smaller.
    uint32_t min_id[kWidth];

    /// Of a lane that is one cluster.
    Aabb box(uint32_t lane) const;
    void set(uint32_t lane, const Aabb& box, uint32_t id);
    void clear(uint32_t lane);
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
