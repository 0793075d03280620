#pragma once

#include <vector>

#include "engine/bvh/binning.h"
#include "engine/bvh/bvh.h"

namespace zoe {

/// Unless told, boxes are tested one by one; `build_blas` sets what suits triangles in blocks, and says why (blas.cpp).
struct BinnedConfig {
    int bin_count = 16;      ///< 2 to 64; small nodes take fewer. Chart `bins`; of what follows, chart `knobs`.
    int max_leaf_size = 8;   ///< A leaf with more primitives is split even where that does not pay.
    int block_size = 1;      ///< Triangles tested at once, a power of two: a leaf costs its blocks, and one is never split.
    float node_cost = 1.0f;  ///< Cost of visiting a node, in units of testing a block.
};

/// Memory that one build hands to the next.
struct BinnedScratch {
    /// A node in the making, over items [begin, end).
    struct Range {
        uint32_t node, begin, end;
        uint32_t count() const { return end - begin; }
    };
    struct Subtree {
        Range range;
        uint32_t room, used;  ///< Its nodes but the root are [room, room + used): places depend on counts, never on threads.
    };
    /// What a chunk of a large node works out on its own.
    struct Chunk {
        binning::Extents extents;
        binning::Bins bins;
        uint32_t left_count;
    };
    struct Swap {
        uint32_t a, b, count;
    };
    std::vector<binning::Item> items;  ///< What the tree is built over; then in the order of its leaves.
    std::vector<BvhNode> top;
    std::vector<Subtree> subtrees;
    std::vector<Chunk> chunks;
    std::vector<Swap> swaps;
};

/// Builds by binned SAH: primitives are sorted into bins by centroid, and only splits between bins are tried. For trees
/// that are rebuilt every frame.
/// boxes      [primitive_count]; empty or non-finite boxes are kept out of bounds but stay in the tree.
/// storage    a tree whose memory is reused.
/// Cost       O(n log n), in parallel within large nodes and over subtrees; the same tree whatever the number of threads.
///            About 36 bytes a primitive of scratch memory.
/// Source     Wald. On fast Construction of SAH-based Bounding Volume Hierarchies. IEEE RT 2007.
Bvh build_binned(std::span<const Aabb> boxes, const BinnedConfig& config = {}, Bvh storage = {});

/// The same of boxes that are items already, in the scratch, each with its index. No allocation where `storage` and
/// `scratch` are large enough.
Bvh build_binned_items(const BinnedConfig& config, Bvh storage, BinnedScratch* scratch);

}  // namespace zoe
