#pragma once

#include <cstdint>

namespace zoe {

/// From exact to fast: how a tree is clustered that is built anew every frame.
struct ClusterConfig {
    /// Boxes that are clustered exactly: 0 for never, 0xffffffff for always. That takes longer the more, and rays visit more
    /// nodes of the trees: of 100 boxes, 2 %; of 1,000, 6 %; of 10,000, 14 %, in the mean over kinds of scenes.
    uint32_t exact_up_to = 0;
    uint32_t search_radius = 8;  ///< How far the fast form looks: more takes longer, and is nearer to exact. Chart `tlas`.
};

}  // namespace zoe
