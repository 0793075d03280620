#pragma once

#include "engine/bvh/bvh.h"

namespace zoe {

/// A tree in the making: its top, and subtrees that are built apart from each other, in parallel.
struct TreeParts {
    static constexpr uint32_t kNone = 0xffffffffu;

    std::vector<BvhNode> top;
    std::vector<uint32_t> subtree_of_top;        ///< [top.size()] which subtree stands in a node's place; kNone: none.
    std::vector<std::vector<BvhNode>> subtrees;  ///< Each with its root first; children by their place in the subtree.
};

/// Puts the parts together, each node's children right after all that stood before when it was visited, left subtree first:
/// as if one thread had built the tree depth first. Frees the parts as it goes.
std::vector<BvhNode> assemble(TreeParts* parts, std::vector<BvhNode> storage = {});

}  // namespace zoe
