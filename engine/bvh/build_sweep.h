#pragma once

#include "engine/bvh/bvh.h"

namespace zoe {

/// Chart `knobs`.
struct SweepConfig {
    int max_leaf_size = 8;   ///< A leaf with more primitives is split even where that does not pay.
    int block_size = 1;      ///< Triangles tested at once, a power of two: a leaf costs its blocks, and one is never split.
    float node_cost = 1.0f;  ///< Cost of visiting a node, in units of testing a block.
};

/// Builds by full-sweep SAH: every split position of every axis is tried; a node becomes a leaf where no split pays.
/// boxes      [primitive_count]; empty or non-finite boxes are kept out of bounds but stay in the tree.
/// storage    a tree whose memory is reused.
/// Cost       O(n log n): three sorts, then stable partitions; in parallel over axes and subtrees, the same tree whatever
/// the
///            number of threads.
/// Source     MacDonald, Booth. Heuristics for Ray Tracing Using Space Subdivision. The Visual Computer 1990.
Bvh build_sweep(std::span<const Aabb> boxes, const SweepConfig& config = {}, Bvh storage = {});

}  // namespace zoe
