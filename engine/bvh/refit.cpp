#include "engine/bvh/refit.h"

#include <cassert>

namespace zoe {

void refit(Bvh& bvh, std::span<const Aabb> boxes) {
    assert(boxes.size() == bvh.primitives.size());
    for (size_t k = bvh.nodes.size(); k-- > 0;) {
        BvhNode& node = bvh.nodes[k];
        Aabb bounds;
        if (node.is_leaf()) {
            for (uint32_t slot = node.first; slot < node.first + node.count; ++slot) {
                const Aabb& box = boxes[bvh.primitives[slot]];
                if (box.is_finite()) bounds.extend(box);
            }
        } else {
            bounds = merge(bvh.nodes[node.first].bounds(), bvh.nodes[node.first + 1].bounds());
        }
        node.lo = bounds.lo;
        node.hi = bounds.hi;
    }
}

}  // namespace zoe
