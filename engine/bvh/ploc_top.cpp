#include "engine/bvh/ploc_top.h"

#include <utility>

namespace zoe {

bool improve_top(uint32_t first_id, PlocTop* top, std::span<PlocUnion> unions) {
    if (unions.size() < 2) return false;
    // How many clusters are left differs from frame to frame.
    const size_t most = top->clusters.capacity();
    top->nodes.reserve(2 * most);
    top->tree.nodes.reserve(3 * most);
    top->tree.primitives.reserve(most);
    std::vector<binning::Item>& items = top->binned.items;
    items.reserve(most);
    items.clear();
    for (const PlocCluster& cluster : top->clusters) items.push_back({cluster.bounds, static_cast<uint32_t>(items.size())});
    top->tree = build_binned_items({.max_leaf_size = 1}, std::move(top->tree), &top->binned);
    const Bvh& tree = top->tree;
    double before = 0.0, after = 0.0;
    for (const PlocUnion& made : unions) before += merge(made.left_bounds, made.right_bounds).half_area();
    for (const BvhNode& node : tree.nodes) after += node.is_leaf() ? 0.0 : node.bounds().half_area();
    if (!(after < before)) return false;
    // From the back, so that halves come first.
    top->nodes.resize(tree.nodes.size());
    uint32_t count = 0;
    for (size_t k = tree.nodes.size(); k-- > 0;) {
        const BvhNode& node = tree.nodes[k];
        if (node.is_leaf()) {
            top->nodes[k] = top->clusters[tree.primitives[node.first]];
            continue;
        }
        const PlocCluster &left = top->nodes[node.first], &right = top->nodes[node.first + 1];
        unions[count] = {left.bounds, right.bounds, left.id, right.id, left.leaf_count};
        top->nodes[k] = {merge(left.bounds, right.bounds), first_id + count++, left.leaf_count + right.leaf_count};
    }
    return true;
}

}  // namespace zoe
