#include "engine/bvh/build_median.h"

#include <algorithm>
#include <cassert>
#include <numeric>

#include "engine/bvh/small_stack.h"
#include "engine/bvh/sort_keys.h"

namespace zoe {

Bvh build_median(std::span<const Aabb> boxes, int max_leaf_size, Bvh storage) {
    assert(max_leaf_size >= 1);
    std::vector<BvhNode>& nodes = storage.nodes;
    std::vector<uint32_t>& primitives = storage.primitives;
    nodes.clear();
    primitives.resize(boxes.size());
    if (boxes.empty()) return storage;
    std::iota(primitives.begin(), primitives.end(), 0u);
    const auto node_over = [&](uint32_t begin, uint32_t end) {
        Aabb bounds;
        for (uint32_t k = begin; k < end; ++k) {
            if (boxes[primitives[k]].is_finite()) bounds.extend(boxes[primitives[k]]);
        }
        return BvhNode{bounds.lo, begin, bounds.hi, end - begin};
    };
    const auto key_along = [&](int axis, uint32_t primitive) {
        const Aabb& box = boxes[primitive];
        return sort_key(box.is_finite() ? box.centre()[axis] : 0.0f, primitive);
    };
    nodes.push_back(node_over(0, static_cast<uint32_t>(boxes.size())));
    SmallStack<uint32_t, 64> open;
    open.push(0);
    while (!open.is_empty()) {
        const uint32_t k = open.pop();
        const BvhNode node = nodes[k];
        if (node.count <= static_cast<uint32_t>(max_leaf_size)) continue;
        const glm::vec3 extent = node.bounds().extent();
        const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
        const uint32_t begin = node.first, end = node.first + node.count, middle = begin + node.count / 2;
        std::nth_element(primitives.begin() + begin, primitives.begin() + middle, primitives.begin() + end,
                         [&](uint32_t a, uint32_t b) { return key_along(axis, a) < key_along(axis, b); });
        const auto children = static_cast<uint32_t>(nodes.size());
        nodes.push_back(node_over(begin, middle));
        nodes.push_back(node_over(middle, end));
        nodes[k].first = children;
        nodes[k].count = 0;
        open.push(children + 1);
        open.push(children);
    }
    return storage;
}

}  // namespace zoe
