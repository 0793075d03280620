#pragma once

#include "engine/bvh/bvh.h"

namespace zoe {

/// Builds bottom up: merges the two boxes whose union has the least area, again and again, until one is left. Leaves hold
/// one primitive. Ties go by (area, lower id, higher id), which makes it end and makes it deterministic.
/// boxes      [primitive_count], finite and not empty.
/// storage    a tree whose memory is reused.
/// Returns    a tree, the same whatever the number of threads. Off ties the only one there is; of ties, ids decide, which
///            go to the boxes first, then to unions in the order made. While clusters are more than 128 and at least one in
///            16 merges with another, this is in rounds: of all that are each other's best, by the lower id. Then it is pair
///            by pair: from the cluster of the lowest id, later from the last union, to its best partner, on to that one's.
/// Cost       about n log n (see ClusterIndex), the rounds in parallel; no allocation once this thread has built a tree as
///            large. The tree may be as deep as there are boxes: each inside of the next, say. Coincident ones make a
///            balanced tree.
/// Source     Walter, Bala, Kulkarni, Pingali. Fast Agglomerative Clustering for Rendering. IEEE RT 2008.
Bvh build_agglomerative(std::span<const Aabb> boxes, Bvh storage = {});

}  // namespace zoe
