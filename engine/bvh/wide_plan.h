#pragma once

#include <cstdint>

#include "engine/bvh/wide.h"

namespace zoe {

/// How forests of a binary node are divided where they cost least: of t trees, how many the first child gets, three bits for
/// each t from 2 to kWidth; whether t trees cost as much as t - 1, a bit for each t from 2 to kWidth - 1; and whether one
/// tree is a leaf.
struct CollapseChoice {
    static constexpr uint32_t kSame = 1u << 21, kLeaf = 1u << 27;
    static_assert(3 * (kWidth - 1) == 21);

    uint32_t bits;

    /// trees      2 to kWidth.
    int first_trees(int trees) const { return static_cast<int>(bits >> 3 * (trees - 2) & 7); }
    /// trees      2 to kWidth - 1.
    bool is_same_with_fewer(int trees) const { return (bits & kSame << (trees - 2)) != 0; }
    bool is_leaf() const { return (bits & kLeaf) != 0; }
};

/// Works out scratch->choices, one a binary node.
/// Cost       O(nodes), in parallel; no allocation where the scratch is large enough.
/// Source     as of `collapse`.
void plan_collapse(const Bvh& bvh, const CollapseConfig& config, CollapseScratch* scratch);

}  // namespace zoe
