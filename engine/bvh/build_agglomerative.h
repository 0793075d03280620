#pragma once

#include "engine/bvh/bvh.h"

namespace zoe {

/// Builds bottom up: merges the two boxes whose union has the least area, again and again, until one is left. Of equal
/// areas, the union of fewest boxes comes first; of those, that of the lowest box; then the one whose other half has it. So
/// does whoever tries all pairs, ties included: none of it depends on what was merged before. Leaves hold one primitive.
/// boxes      [primitive_count] any: one that is empty or not finite counts as empty, and is joined last. Areas are floats,
///            of coordinates up to 1e18: those beyond count as there; boxes smaller than 2^-62 count as so large, as far as
///            floats can tell.
/// storage    a tree whose memory is reused.
/// Returns    the only such tree, breadth first, of two halves that with the lowest box first.
/// Cost       about n log n of boxes that lie side by side (see ClusterIndex), most of it in parallel, and at worst, of such
///            as lie inside or across each other, n^2 / 16; no allocation once this thread has built a tree as large. The
///            tree may be as deep as there are boxes: each inside of the next, say. Coincident ones make a balanced tree.
/// Source     Walter, Bala, Kulkarni, Pingali. Fast Agglomerative Clustering for Rendering. IEEE RT 2008.
Bvh build_agglomerative(std::span<const Aabb> boxes, Bvh storage = {});

}  // namespace zoe
