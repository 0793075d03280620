#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "engine/math/aabb.h"

namespace zoe {

/// A node of a binary BVH, 32 bytes. Inner: count == 0, children at first and first + 1. Leaf: primitives
/// [first, first + count) of Bvh::primitives.
struct BvhNode {
    glm::vec3 lo;
    uint32_t first;
    glm::vec3 hi;
    uint32_t count;

    bool is_leaf() const { return count > 0; }
    Aabb bounds() const { return {lo, hi}; }
};

/// A binary BVH over primitives that it knows by index only. The root is nodes[0]; a child always stands after its
/// parent, so a loop from the back visits children first. Empty: no nodes.
struct Bvh {
    std::vector<BvhNode> nodes;
    std::vector<uint32_t> primitives;  ///< Leaf order -> caller's index; a permutation.

    Aabb bounds() const { return nodes.empty() ? Aabb{} : nodes[0].bounds(); }
};

/// Checks every invariant: links, order, that each primitive is in exactly one leaf, and that boxes contain what is
/// under them.
/// boxes      [primitive_count] the boxes the tree was built over (or refitted to).
/// Returns    the first broken invariant in words, empty when all hold.
std::string validate(const Bvh& bvh, std::span<const Aabb> boxes);

/// What a random ray costs by the surface area heuristic: 1 a node visited and 1 a primitive tested, relative to the root.
/// Source     MacDonald, Booth. Heuristics for Ray Tracing Using Space Subdivision. The Visual Computer 1990.
double sah_cost(const Bvh& bvh);

/// Levels on the longest way down; a single leaf has 1, an empty tree 0.
int depth(const Bvh& bvh);

}  // namespace zoe
