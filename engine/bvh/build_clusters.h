#pragma once

#include "engine/bvh/build_agglomerative.h"
#include "engine/bvh/build_ploc.h"
#include "engine/bvh/cluster_config.h"

namespace zoe {

/// Builds bottom up: by `build_agglomerative` where boxes are few, else by `build_ploc`. Leaves hold one primitive.
/// boxes      [primitive_count] finite and not empty.
/// storage    a tree whose memory is reused.
/// Cost       see those two.
/// Source     Walter, Bala, Kulkarni, Pingali 2008, and Meister, Bittner 2018: see those two.
Bvh build_clusters(std::span<const Aabb> boxes, const ClusterConfig& config, Bvh storage, PlocScratch* scratch);

}  // namespace zoe
