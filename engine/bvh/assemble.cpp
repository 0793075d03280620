#include "engine/bvh/assemble.h"

#include "engine/bvh/small_stack.h"

namespace zoe {

namespace {

// The root takes a place that is there already; the others follow at the end.
void append(const std::vector<BvhNode>& subtree, uint32_t root_place, std::vector<BvhNode>* nodes) {
    const auto base = static_cast<uint32_t>(nodes->size()) - 1;
    const auto placed = [&](BvhNode node) {
        if (!node.is_leaf()) node.first += base;
        return node;
    };
    (*nodes)[root_place] = placed(subtree[0]);
    for (size_t k = 1; k < subtree.size(); ++k) nodes->push_back(placed(subtree[k]));
}

}  // namespace

std::vector<BvhNode> assemble(TreeParts* parts, std::vector<BvhNode> storage) {
    struct Open {
        uint32_t top, place;
    };
    std::vector<BvhNode> nodes = std::move(storage);
    nodes.clear();
    size_t count = parts->top.size();
    for (const std::vector<BvhNode>& subtree : parts->subtrees) count += subtree.size() - 1;
    nodes.reserve(count);
    nodes.push_back(parts->top[0]);
    SmallStack<Open, 64> open;
    open.push({0, 0});
    while (!open.is_empty()) {
        const auto [top, place] = open.pop();
        const uint32_t subtree = parts->subtree_of_top[top];
        if (subtree != TreeParts::kNone) {
            append(parts->subtrees[subtree], place, &nodes);
            std::vector<BvhNode>().swap(parts->subtrees[subtree]);
        } else if (const BvhNode& node = parts->top[top]; !node.is_leaf()) {
            const auto children = static_cast<uint32_t>(nodes.size());
            nodes[place].first = children;
            nodes.push_back(parts->top[node.first]);
            nodes.push_back(parts->top[node.first + 1]);
            open.push({node.first + 1, children + 1});
            open.push({node.first, children});
        }
    }
    return nodes;
}

}  // namespace zoe
