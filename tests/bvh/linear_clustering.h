#pragma once

#include <span>
#include <vector>

#include "engine/bvh/bvh.h"

namespace zoe::test {

/// What agglomerative clustering has not merged yet, in a plain list.
struct ListedCluster {
    Aabb bounds;
    uint32_t id;  ///< The lowest of its boxes.
    uint32_t box_count = 1;
};

/// A box as clustering measures it: of 2^-62 or more along each axis, as far as floats tell.
Aabb grown(Aabb box);

/// Position of the cluster that makes the least (half area of the union, boxes in it, lower id, higher id) with the one at
/// `position`, by comparing with every other. Areas are floats, of coordinates up to 1e18.
size_t linear_best_partner(std::span<const ListedCluster> list, size_t position);

/// The tree of `build_agglomerative`, by the nearest-neighbour chain with a linear search: O(n^2). Shares no code with the
/// engine but for boxes.
Bvh linear_clustering(std::span<const Aabb> boxes);

}  // namespace zoe::test
