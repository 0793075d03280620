#include "engine/bvh/tree_stats.h"

#include <algorithm>

namespace zoe {

TreeStats tree_stats(const Bvh& bvh) {
    TreeStats stats;
    stats.sah = sah_cost(bvh);
    stats.depth = depth(bvh);
    for (const BvhNode& node : bvh.nodes) {
        ++(node.is_leaf() ? stats.leaf_count : stats.inner_count);
        stats.largest_leaf = std::max(stats.largest_leaf, node.count);
    }
    stats.reference_count = static_cast<uint32_t>(bvh.primitives.size());
    if (!bvh.primitives.empty()) {
        std::vector<bool> is_seen(size_t(*std::max_element(bvh.primitives.begin(), bvh.primitives.end())) + 1);
        for (const uint32_t primitive : bvh.primitives) {
            if (is_seen[primitive]) ++stats.duplicate_count;
            is_seen[primitive] = true;
        }
    }
    stats.bytes = bvh.nodes.size() * sizeof(BvhNode) + bvh.primitives.size() * sizeof(uint32_t);
    return stats;
}

}  // namespace zoe
