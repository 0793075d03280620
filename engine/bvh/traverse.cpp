#include "engine/bvh/traverse.h"

#include <limits>
#include <utility>

#include "engine/bvh/small_stack.h"

namespace zoe {

namespace {

struct Entry {
    uint32_t node;
    float t;  // Entry into the node's box.
};

}  // namespace

bool closest_hit(const Blas& blas, const RayFrame& ray, float t_floor, float t_min, BlasHit* hit, TraverseCounts* counts) {
    if (blas.bvh.nodes.empty() || !ray.is_valid) return false;
    const BvhNode* nodes = blas.bvh.nodes.data();
    uint32_t node_count = 1, triangle_count = 0;
    bool is_improved = false;
    SmallStack<Entry, 64> open;
    Entry at{0, entry(ray, nodes[0].lo, nodes[0].hi, hit->t)};
    for (;;) {
        // Boxes entered at exactly the closest t are still looked into: a tie may go to a lower primitive.
        if (at.t <= hit->t && at.t < std::numeric_limits<float>::infinity()) {
            const BvhNode& node = nodes[at.node];
            if (!node.is_leaf()) {
                Entry near{node.first, entry(ray, nodes[node.first].lo, nodes[node.first].hi, hit->t)};
                Entry far{node.first + 1, entry(ray, nodes[node.first + 1].lo, nodes[node.first + 1].hi, hit->t)};
                node_count += 2;
                if (far.t < near.t) std::swap(near, far);
                if (far.t < std::numeric_limits<float>::infinity()) open.push(far);
                at = near;
                continue;
            }
            triangle_count += node.count;
            for (uint32_t slot = node.first; slot < node.first + node.count; ++slot) {
                const Triangle& triangle = blas.triangles[slot];
                TriangleHit found;
                if (!intersect(ray, triangle, t_floor, t_min, hit->t, &found)) continue;
                if (found.t < hit->t || triangle.primitive < hit->primitive) {
                    *hit = {found.t, found.u, found.v, triangle.primitive};
                    is_improved = true;
                }
            }
        }
        if (open.is_empty()) break;
        at = open.pop();
    }
    if (counts) {
        counts->nodes += node_count;
        counts->triangles += triangle_count;
    }
    return is_improved;
}

bool any_hit(const Blas& blas, const RayFrame& ray, float t_floor, float t_min, float t_max, TraverseCounts* counts) {
    if (blas.bvh.nodes.empty() || !ray.is_valid) return false;
    const BvhNode* nodes = blas.bvh.nodes.data();
    uint32_t node_count = 0, triangle_count = 0;
    bool is_hit = false;
    SmallStack<uint32_t, 64> open;
    open.push(0);
    while (!open.is_empty() && !is_hit) {
        const BvhNode& node = nodes[open.pop()];
        ++node_count;
        if (!(entry(ray, node.lo, node.hi, t_max) < std::numeric_limits<float>::infinity())) continue;
        if (!node.is_leaf()) {
            open.push(node.first + 1);
            open.push(node.first);
            continue;
        }
        TriangleHit found;
        for (uint32_t slot = node.first; slot < node.first + node.count && !is_hit; ++slot) {
            ++triangle_count;
            is_hit = intersect(ray, blas.triangles[slot], t_floor, t_min, t_max, &found);
        }
    }
    if (counts) {
        counts->nodes += node_count;
        counts->triangles += triangle_count;
    }
    return is_hit;
}

}  // namespace zoe
