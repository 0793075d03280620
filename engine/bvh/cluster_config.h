#pragma once

#include <cstdint>

namespace zoe {

/// From exact to fast: how a tree is clustered that is built anew every frame.
struct ClusterConfig {
    uint32_t exact_up_to = 64;   ///< Boxes that are clustered exactly: 0 for never, 0xffffffff for always.
    uint32_t search_radius = 8;  ///< How far the fast form looks: more takes longer and comes nearer to the exact one.
};

}  // namespace zoe
