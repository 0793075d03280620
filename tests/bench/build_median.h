#pragma once

#include <algorithm>
#include <numeric>

#include "engine/bvh/bvh.h"
#include "engine/bvh/small_stack.h"

namespace zoe::test {

/// The naive tree that the others are measured against: halves the primitives at the median centre along the longest axis of
/// their bounds, down to leaves of `leaf_size`. No cost is looked at.
/// boxes      finite and not empty.
/// Cost       O(n log n), one thread.
inline Bvh build_median(std::span<const Aabb> boxes, uint32_t leaf_size = 4) {
    Bvh bvh;
    if (boxes.empty()) return bvh;
    bvh.primitives.resize(boxes.size());
    std::iota(bvh.primitives.begin(), bvh.primitives.end(), 0u);
    const auto node_over = [&](uint32_t begin, uint32_t end) {
        Aabb bounds;
        for (uint32_t k = begin; k < end; ++k) bounds.extend(boxes[bvh.primitives[k]]);
        return BvhNode{bounds.lo, begin, bounds.hi, end - begin};
    };
    bvh.nodes.push_back(node_over(0, static_cast<uint32_t>(boxes.size())));
    SmallStack<uint32_t, 64> open;
    open.push(0);
    while (!open.is_empty()) {
        const uint32_t k = open.pop();
        const BvhNode node = bvh.nodes[k];
        if (node.count <= leaf_size) continue;
        const glm::vec3 extent = node.bounds().extent();
        const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
        const uint32_t end = node.first + node.count, middle = node.first + node.count / 2;
        const auto first = bvh.primitives.begin();
        std::nth_element(first + node.first, first + middle, first + end, [&](uint32_t a, uint32_t b) {
            const float x = boxes[a].centre()[axis], y = boxes[b].centre()[axis];
            return x < y || (x == y && a < b);
        });
        const auto children = static_cast<uint32_t>(bvh.nodes.size());
        bvh.nodes.push_back(node_over(node.first, middle));
        bvh.nodes.push_back(node_over(middle, end));
        bvh.nodes[k].first = children;
        bvh.nodes[k].count = 0;
        open.push(children + 1);
        open.push(children);
    }
    return bvh;
}

}  // namespace zoe::test
