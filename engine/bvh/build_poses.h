#pragma once

#include <span>

#include "engine/bvh/bvh.h"

namespace zoe {

struct PosesConfig {
    int bin_count = 32;      ///< 2 to 64, along each axis of each pose.
    int max_leaf_size = 8;   ///< A leaf with more primitives is split even where that does not pay.
    int block_size = 1;      ///< Triangles tested at once, a power of two: a leaf costs its blocks, and one is never split.
    float node_cost = 1.0f;  ///< Cost of visiting a node, in units of testing a block.
};

/// Builds one tree for primitives that take several poses in turn, as in a clip that is known: of each node that split is
/// taken whose cost by SAH is least in the sum over the poses, along any axis of any pose. To be refitted to each pose.
/// boxes      [pose_count * primitive_count] those of a pose, then those of the next; empty or non-finite boxes are kept out
///            of bounds but stay in the tree.
/// Returns    a tree whose boxes are those of the first pose.
/// Cost       O(pose_count^2 * n log n), in parallel over subtrees; the same tree on any number of threads. For loading, not
///            for frames. 32 bytes a box of scratch memory.
/// Source     Bittner, Meister. T-SAH: Animation Optimized Bounding Volume Hierarchies. CGF 34 (EG 2015): the cost.
///            Deviation: binned from the top down (Wald 2007) instead of optimised by reinsertion.
Bvh build_poses(std::span<const Aabb> boxes, size_t pose_count, const PosesConfig& config = {});

}  // namespace zoe
