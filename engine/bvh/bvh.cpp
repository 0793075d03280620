#include "engine/bvh/bvh.h"

#include <algorithm>

namespace zoe {

namespace {

std::string at(size_t node) {
    return "node " + std::to_string(node) + ": ";
}

}  // namespace

std::string validate(const Bvh& bvh, std::span<const Aabb> boxes) {
    if (bvh.nodes.empty()) {
        return boxes.empty() && bvh.primitives.empty() ? ""
                                                       : "no nodes over " + std::to_string(boxes.size()) + " primitives";
    }
    const size_t node_count = bvh.nodes.size(), primitive_count = boxes.size();
    if (bvh.primitives.size() != primitive_count) {
        return std::to_string(bvh.primitives.size()) + " primitives in the tree, " + std::to_string(primitive_count) +
               " boxes";
    }
    std::vector<uint8_t> primitive_seen(primitive_count, 0), slot_seen(primitive_count, 0), is_child(node_count, 0);
    for (const uint32_t primitive : bvh.primitives) {
        if (primitive >= primitive_count) return "primitive " + std::to_string(primitive) + " out of range";
        if (primitive_seen[primitive]++) return "primitive " + std::to_string(primitive) + " stands twice";
    }
    for (size_t k = 0; k < node_count; ++k) {
        const BvhNode& node = bvh.nodes[k];
        const Aabb bounds = node.bounds();
        if (node.is_leaf()) {
            if (uint64_t(node.first) + node.count > primitive_count) return at(k) + "leaf range out of bounds";
            for (uint32_t slot = node.first; slot < node.first + node.count; ++slot) {
                if (slot_seen[slot]++) return at(k) + "primitive slot " + std::to_string(slot) + " is in two leaves";
                const Aabb& box = boxes[bvh.primitives[slot]];
                if (box.is_finite() && !bounds.contains(box)) {
                    return at(k) + "does not contain primitive " + std::to_string(bvh.primitives[slot]);
                }
            }
        } else {
            if (node.first <= k || uint64_t(node.first) + 2 > node_count) return at(k) + "children out of order or range";
            for (uint32_t child = node.first; child < node.first + 2; ++child) {
                if (is_child[child]++) return at(child) + "has two parents";
                if (!bounds.contains(bvh.nodes[child].bounds()))
                    return at(k) + "does not contain child " + std::to_string(child);
            }
        }
    }
    if (is_child[0]) return "the root is a child";
    for (size_t k = 1; k < node_count; ++k) {
        if (!is_child[k]) return at(k) + "is no one's child";
    }
    const auto lost = std::find(slot_seen.begin(), slot_seen.end(), 0);
    if (lost != slot_seen.end()) return "primitive slot " + std::to_string(lost - slot_seen.begin()) + " is in no leaf";
    return "";
}

double sah_cost(const Bvh& bvh) {
    const double root_area = bvh.bounds().half_area();
    if (bvh.nodes.empty() || !(root_area > 0.0)) return 0.0;
    double cost = 0.0;
    for (const BvhNode& node : bvh.nodes) cost += node.bounds().half_area() * (node.is_leaf() ? node.count : 1.0);
    return cost / root_area;
}

int depth(const Bvh& bvh) {
    std::vector<int> levels(bvh.nodes.size(), 1);
    int deepest = 0;
    for (size_t k = 0; k < bvh.nodes.size(); ++k) {
        deepest = std::max(deepest, levels[k]);
        if (bvh.nodes[k].is_leaf()) continue;
        levels[bvh.nodes[k].first] = levels[bvh.nodes[k].first + 1] = levels[k] + 1;
    }
    return deepest;
}

}  // namespace zoe
