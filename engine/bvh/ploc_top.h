#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/bvh/build_binned.h"
#include "engine/bvh/bvh.h"

namespace zoe {

/// A tree in the making, by its id: boxes first, then unions in the order made.
struct PlocCluster {
    Aabb bounds;
    uint32_t id, leaf_count;
};

struct PlocUnion {
    Aabb left_bounds, right_bounds;
    uint32_t left, right;
    uint32_t left_leaf_count;
};

/// Memory that one build hands to the next.
struct PlocTop {
    std::vector<PlocCluster> clusters;  ///< What the top is built over.
    BinnedScratch binned;
    Bvh tree;
    std::vector<PlocCluster> nodes;  ///< The tree's, as clusters.
};

/// Joins clusters top down, by binned SAH, where that gives a lesser sum of areas: what is built bottom up is worst at the
/// top, where little is left to choose among.
/// top        the clusters.
/// first_id   of the unions.
/// unions     [clusters - 1] how they were joined, halves before what is made of them; replaced where another way is better.
/// Returns    whether they are. All is in the last one either way.
/// Cost       O(clusters log clusters), on one thread up to 4,096; no allocation where `top` was used for as many.
bool improve_top(uint32_t first_id, PlocTop* top, std::span<PlocUnion> unions);

}  // namespace zoe
