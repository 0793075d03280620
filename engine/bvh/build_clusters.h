#pragma once

#include "engine/bvh/build_agglomerative.h"
#include "engine/bvh/build_ploc.h"

namespace zoe {

/// From exact to fast: how a tree is clustered that is built anew every frame.
struct ClusterConfig {
    uint32_t exact_up_to = 64;   ///< Boxes that are clustered exactly: 0 for never, 0xffffffff for always.
    uint32_t search_radius = 8;  ///< How far the fast form looks: more takes longer and comes nearer to the exact one.
};

/// Builds bottom up: by `build_agglomerative` where boxes are few, else by `build_ploc`. Leaves hold one primitive.
/// boxes      [primitive_count] finite and not empty.
/// storage    a tree whose memory is reused.
/// Cost       see those two.
/// Source     Walter, Bala, Kulkarni, Pingali 2008, and Meister, Bittner 2018: see those two.
Bvh build_clusters(std::span<const Aabb> boxes, const ClusterConfig& config, Bvh storage, PlocScratch* scratch);

}  // namespace zoe
