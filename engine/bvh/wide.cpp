#include "engine/bvh/wide.h"

#include <algorithm>
#include <cstring>

namespace zoe {

namespace {

std::string at(size_t node, int slot) {
    return "node " + std::to_string(node) + " child " + std::to_string(slot) + ": ";
}

using Double2 = double __attribute__((vector_size(sizeof(double) * 2)));

Double2 pair_at(const double* first) {
    Double2 pair;
    std::memcpy(&pair, first, sizeof pair);
    return pair;
}

}  // namespace

void WideNode::set_box(int slot, const Aabb& box) {
    for (int axis = 0; axis < 3; ++axis) {
        planes[2 * axis][slot] = box.lo[axis];
        planes[2 * axis + 1][slot] = box.hi[axis];
    }
}

Aabb WideNode::bounds() const {
    Aabb bounds;
    for (int slot = 0; slot < kWidth; ++slot) bounds.extend(box(slot));
    return bounds;
}

double WideBvh::summed_cost() const {
    const double root_area = bounds().half_area();
    return root_area > 0.0 ? (root_area + nodes[0].area_cost) / root_area : 0.0;
}

void sum_costs(const WideBvh& wide, float block_cost, WideNode* node) {
    // As Aabb::half_area has it, and what leaves cost, for slots side by side; an empty slot's area is 0.
    double extents[3][kWidth], block_counts[kWidth], areas[kWidth], leaf_costs[kWidth];
    for (int axis = 0; axis < 3; ++axis) {
        const float *const lo = node->planes[2 * axis], *const hi = node->planes[2 * axis + 1];
        for (int slot = 0; slot < kWidth; ++slot) extents[axis][slot] = double(hi[slot]) - lo[slot];
    }
    for (int slot = 0; slot < kWidth; ++slot) block_counts[slot] = static_cast<int32_t>(block_count(node->child[slot]));
    for (int slot = 0; slot < kWidth; slot += 2) {
        const Double2 x = pair_at(extents[0] + slot), y = pair_at(extents[1] + slot), z = pair_at(extents[2] + slot);
        const Double2 area = (x >= 0.0) & (y >= 0.0) & (z >= 0.0) ? x * y + y * z + z * x : Double2{};
        const Double2 leaf_cost = area * (double(block_cost) * pair_at(block_counts + slot));
        std::memcpy(areas + slot, &area, sizeof area);
        std::memcpy(leaf_costs + slot, &leaf_cost, sizeof leaf_cost);
    }
    double sum = 0.0;
    for (int slot = 0; slot < kWidth; ++slot) {
        const uint32_t child = node->child[slot];
        sum += is_leaf(child) ? leaf_costs[slot] : areas[slot] + wide.nodes[child].area_cost;
    }
    node->area_cost = sum;
}

std::string validate(const WideBvh& wide, size_t block_total) {
    const size_t node_count = wide.nodes.size();
    if (node_count == 0) {
        if (!wide.level_ends.empty()) return "levels without nodes";
        return block_total == 0 ? "" : "no nodes over " + std::to_string(block_total) + " blocks";
    }
    if (!std::is_sorted(wide.level_ends.begin(), wide.level_ends.end()) || wide.level_ends.empty() ||
        wide.level_ends[0] != 1 || wide.level_ends.back() != node_count) {
        return "the levels are not those of a tree";
    }
    std::vector<uint8_t> is_child(node_count, 0), block_seen(block_total, 0);
    size_t level = 0;
    for (size_t k = 0; k < node_count; ++k) {
        if (k == wide.level_ends[level]) ++level;
        for (int slot = 0; slot < kWidth; ++slot) {
            const uint32_t child = wide.nodes[k].child[slot];
            const Aabb box = wide.nodes[k].box(slot);
            if (child == kEmptyChild) {
                // To the bit: rays would enter NaN planes, or ones that overlap by less than the test's padding.
                const Aabb nothing;
                if (!(box.lo == nothing.lo && box.hi == nothing.hi)) return at(k, slot) + "a box without a child";
            } else if (is_leaf(child)) {
                if (uint64_t(first_block(child)) + block_count(child) > block_total)
                    return at(k, slot) + "blocks out of range";
                for (uint32_t block = first_block(child); block < first_block(child) + block_count(child); ++block) {
                    if (block_seen[block]++) return at(k, slot) + "block " + std::to_string(block) + " is in two leaves";
                }
            } else {
                if (level + 1 >= wide.level_ends.size() || child < wide.level_ends[level] ||
                    child >= wide.level_ends[level + 1]) {
                    return at(k, slot) + "not on the next level";
                }
                if (is_child[child]++) return at(k, slot) + "has two parents";
                if (!box.contains(wide.nodes[child].bounds())) return at(k, slot) + "does not contain its children";
            }
        }
    }
    for (size_t k = 1; k < node_count; ++k) {
        if (!is_child[k]) return "node " + std::to_string(k) + " is no one's child";
    }
    const auto lost = std::find(block_seen.begin(), block_seen.end(), 0);
    if (lost != block_seen.end()) return "block " + std::to_string(lost - block_seen.begin()) + " is in no leaf";
    return "";
}

double sah_cost(const WideBvh& wide, float block_cost) {
    const double root_area = wide.bounds().half_area();
    if (!(root_area > 0.0)) return 0.0;
    double cost = root_area;
    for (const WideNode& node : wide.nodes) {
        for (int slot = 0; slot < kWidth; ++slot) {
            const uint32_t child = node.child[slot];
            if (child == kEmptyChild) continue;
            cost += node.box(slot).half_area() * (is_leaf(child) ? double(block_cost) * block_count(child) : 1.0);
        }
    }
    return cost / root_area;
}

}  // namespace zoe
