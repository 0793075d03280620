#pragma once

#include "engine/bvh/static_bvh.h"

namespace zoe {

/// Unless told, triangles are tested one by one; `build_blas` sets what suits blocks of them, and says why (blas.cpp).
/// Chart `knobs`.
struct SbvhConfig {
    float max_reference_growth = 1.3f;  ///< Leaves hold at most this many times as many references as primitives; >= 1.
    float min_overlap = 1e-4f;  ///< Spatial splits are tried where children overlap by more than this, of the root's area.
    int bin_count = 32;         ///< Spatial bins an axis, 2 to 64.
    int max_leaf_size = 8;      ///< A leaf with more references is split even where that does not pay.
    int block_size = 1;      ///< Triangles tested at once, a power of two: a leaf costs its blocks, and one is never split.
    float node_cost = 1.0f;  ///< Cost of visiting a node, in units of testing a block.
};

/// Builds by full-sweep SAH with spatial splits: where the halves of the best object split overlap, triangles may be cut at
/// a plane instead, and then stand on both sides, as far as the budget of references goes. A triangle across the plane stays
/// whole where that costs less (reference unsplitting).
/// positions  [vertex_count] local space.
/// corners    [triangle_count] indices into positions. Triangles that are not finite are in the tree and bound nothing.
/// Cost       O(n log n) at usual numbers of bins, in parallel over subtrees; the same tree whatever the number of threads;
///            about 120 bytes a triangle at its peak, on the way through the root.
/// Source     Stich, Friedrich, Dietrich. Spatial Splits in Bounding Volume Hierarchies. HPG 2009. Deviation: the budget of
///            references is shared out on the way down by area times count, so that subtrees need not know of each other.
StaticBvh build_sbvh(std::span<const glm::vec3> positions, std::span<const glm::uvec3> corners,
                     const SbvhConfig& config = {});

}  // namespace zoe
