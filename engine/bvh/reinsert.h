#pragma once

#include "engine/bvh/bvh.h"

namespace zoe {

/// Chart `knobs`.
struct ReinsertConfig {
    int max_rounds = 8;            ///< Rounds of search; it ends before where one gains next to nothing.
    float candidate_share = 1.0f;  ///< Of the nodes, those of largest area, that are tried a round.
    int max_visits = 200;          ///< Nodes that one search looks at: bounds the time where everything overlaps.
    float min_gain = 1e-3f;        ///< A round that lowers the cost by less than this, relative, is the last.
};

struct ReinsertCounts {
    int rounds = 0;
    uint32_t moves = 0;
};

/// Improves a tree: takes subtrees out and puts them back where they add the least area. Leaves keep their primitives, so a
/// tree of references is as welcome as one of primitives. Never makes `sah_cost` worse. The budget counts work, not time.
/// bvh        a valid tree; left in depth-first order, primitives too.
/// Cost       a branch-and-bound search a candidate and round, in parallel; moves are made by one thread. The same tree
///            whatever the number of threads. 24 bytes a node.
/// Source     Bittner, Hapala, Havran. Fast Insertion-Based Optimization of Bounding Volume Hierarchies. CGF 2013. Meister,
///            Bittner. Parallel Reinsertion for Bounding Volume Hierarchy Optimization. EG 2018. Deviation: moves that were
///            found in parallel are priced again before each is made, in place of locks.
ReinsertCounts reinsert(Bvh* bvh, const ReinsertConfig& config = {});

}  // namespace zoe
