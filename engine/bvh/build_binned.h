#pragma once

#include "engine/bvh/binning.h"
#include "engine/bvh/bvh.h"

namespace zoe {

struct BinnedConfig {
    int bin_count = 16;      ///< 2 to 64; small nodes take fewer.
    int max_leaf_size = 8;   ///< A leaf with more primitives is split even where that does not pay.
    int block_size = 1;      ///< Triangles tested at once, a power of two: a leaf costs its blocks, and one is never split.
    float node_cost = 1.0f;  ///< Cost of visiting a node, in units of testing a block.
};

/// Builds by binned SAH: primitives are sorted into bins by centroid, and only splits between bins are tried. For trees
/// that are rebuilt every frame.
/// boxes      [primitive_count]; empty or non-finite boxes are kept out of bounds but stay in the tree.
/// storage    a tree whose memory is reused.
/// Cost       O(n log n), in parallel within large nodes and over subtrees; the same tree whatever the number of threads.
///            36 bytes a primitive of scratch memory stay with the calling thread; 4 where it hands in the items.
/// Source     Wald. On fast Construction of SAH-based Bounding Volume Hierarchies. IEEE RT 2007.
Bvh build_binned(std::span<const Aabb> boxes, const BinnedConfig& config = {}, Bvh storage = {});

/// The same of boxes that are items already, each with its index; they are left in the order of the leaves.
Bvh build_binned_items(std::span<binning::Item> items, const BinnedConfig& config, Bvh storage);

}  // namespace zoe
