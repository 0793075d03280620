#pragma once

#include <cstdint>

namespace zoe {

/// From exact to fast: how a tree is clustered that is built anew every frame.
struct ClusterConfig {
    /// Boxes that are clustered exactly: 0 for never, 0xffffffff for always. Of 64 boxes or fewer the fast form makes the
    /// same tree, off ties, in less time. Of up to 1,000 instances, rays visit as many nodes of either tree, give or take
    /// 4 %; of more, mostly fewer of the fast one's (of 10,000, 6 %; of 100,000, 39 %), and that takes less time the more.
    uint32_t exact_up_to = 0;
    uint32_t search_radius = 8;  ///< How far the fast form looks: more takes longer, and is nearer to exact. Chart `tlas`.
};

}  // namespace zoe
