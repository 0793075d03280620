#pragma once

#include "engine/bvh/bvh.h"

namespace zoe {

/// What there is to know of a tree but how long its build took, which the caller measures, and `epo_cost`.
struct TreeStats {
    double sah = 0.0;  ///< `sah_cost`.
    int depth = 0;     ///< Levels.
    uint32_t inner_count = 0, leaf_count = 0;
    uint32_t reference_count = 0;  ///< Primitives in leaves, with repetitions.
    uint32_t duplicate_count = 0;  ///< References but the first of each primitive: what spatial splits added.
    uint32_t largest_leaf = 0;     ///< References.
    size_t bytes = 0;              ///< Nodes and references, as built; what is traversed is counted by its own.

    double mean_leaf() const { return leaf_count > 0 ? double(reference_count) / leaf_count : 0.0; }
};

/// Cost       O(nodes + references), one pass each.
TreeStats tree_stats(const Bvh& bvh);

}  // namespace zoe
