#pragma once

#include "engine/bvh/bvh.h"

namespace zoe {

/// Builds bottom up: merges the two boxes whose union has the least area, again and again, until one is left. Leaves hold
/// one primitive. Ties go by (area, lower id, higher id), which makes it end and makes it deterministic.
/// boxes      [primitive_count], finite and not empty.
/// storage    a tree whose memory is reused.
/// Cost       about n log n (see ClusterIndex), one thread; no allocation once this thread has built a tree as large. The
///            tree may be as deep as there are boxes: each inside of the next, say. Coincident ones make a balanced tree.
/// Source     Walter, Bala, Kulkarni, Pingali. Fast Agglomerative Clustering for Rendering. IEEE RT 2008.
Bvh build_agglomerative(std::span<const Aabb> boxes, Bvh storage = {});

}  // namespace zoe
