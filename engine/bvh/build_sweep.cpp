#include "engine/bvh/build_sweep.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <limits>

#include "engine/bvh/assemble.h"
#include "engine/bvh/small_stack.h"
#include "engine/bvh/sort_keys.h"
#include "engine/math/parallel.h"

namespace zoe {

namespace {

constexpr uint32_t kSubtreeSize = 16384;  // Subtrees of at most this many primitives are built by one thread each.
constexpr size_t kGrain = 16384;

struct Split {
    int axis = -1;
    uint32_t position = 0;                                  // First primitive of the right side.
    double cost = std::numeric_limits<double>::infinity();  // Area times count, both sides.
};

class Builder {
public:
    Builder(std::span<const Aabb> boxes, const SweepConfig& config, Bvh* bvh)
        : boxes_(boxes),
          config_(config),
          block_shift_(std::countr_zero(static_cast<uint32_t>(config.block_size))),
          bvh_(*bvh) {
        const size_t n = boxes.size();
        parallel_for(0, 3, 1, [&](size_t begin, size_t) { sort_along(static_cast<int>(begin)); });
        is_left_.resize(n);
        moved_.resize(n);
        for (std::vector<double>& costs : costs_) costs.resize(n);
    }

    void build() {
        TreeParts parts;
        parts.top.push_back(node_over(0, static_cast<uint32_t>(boxes_.size())));
        std::vector<uint32_t> roots;
        grow(&parts.top, kSubtreeSize, &roots);
        parts.subtree_of_top.assign(parts.top.size(), TreeParts::kNone);
        parts.subtrees.resize(roots.size());
        for (size_t k = 0; k < roots.size(); ++k) parts.subtree_of_top[roots[k]] = static_cast<uint32_t>(k);
        // A subtree's work is on its own range of every array.
        parallel_for(0, roots.size(), 1, [&](size_t k, size_t) {
            const BvhNode& root = parts.top[roots[k]];
            std::vector<BvhNode> nodes;
            nodes.reserve(2 * root.count - 1);
            nodes.push_back(root);
            grow(&nodes, 0, nullptr);
            parts.subtrees[k].assign(nodes.begin(), nodes.end());  // No larger than it is.
        });
        release_work();
        bvh_.nodes = assemble(&parts, std::move(bvh_.nodes));
        bvh_.primitives = std::move(sorted_[0]);
    }

private:
    // Splits the first of the nodes, on and on, until there are leaves, or (where `small` is given) no more than
    // `small_size` primitives in a node.
    void grow(std::vector<BvhNode>* nodes, uint32_t small_size, std::vector<uint32_t>* small) {
        SmallStack<uint32_t, 64> open;
        open.push(0);
        while (!open.is_empty()) {
            const uint32_t k = open.pop();
            const BvhNode node = (*nodes)[k];
            if (small && node.count <= small_size) {
                small->push_back(k);
                continue;
            }
            if (is_one_block(node.count)) continue;
            const Split split = best_split(node);
            if (is_better_as_leaf(node, split)) continue;
            partition(node, split);
            const auto children = static_cast<uint32_t>(nodes->size());
            nodes->push_back(node_over(node.first, split.position));
            nodes->push_back(node_over(split.position, node.first + node.count));
            (*nodes)[k].first = children;
            (*nodes)[k].count = 0;
            open.push(children + 1);
            open.push(children);
        }
    }

    // Gives back all but the primitives' order: the nodes are to be there twice.
    void release_work() {
        std::vector<uint32_t>().swap(sorted_[1]);
        std::vector<uint32_t>().swap(sorted_[2]);
        for (std::vector<double>& costs : costs_) std::vector<double>().swap(costs);
        std::vector<uint8_t>().swap(is_left_);
        std::vector<uint32_t>().swap(moved_);
    }

    void sort_along(int axis) {
        std::vector<uint64_t> keys(boxes_.size()), scratch;
        for (size_t k = 0; k < boxes_.size(); ++k) {
            const Aabb& box = boxes_[k];
            keys[k] = sort_key(box.is_finite() ? 0.5f * box.lo[axis] + 0.5f * box.hi[axis] : 0.0f, static_cast<uint32_t>(k));
        }
        sort_keys(&keys, &scratch);
        sorted_[axis].resize(keys.size());
        for (size_t k = 0; k < keys.size(); ++k) sorted_[axis][k] = index_of(keys[k]);
    }

    uint32_t blocks(uint32_t count) const { return ((count - 1) >> block_shift_) + 1; }

    bool is_one_block(uint32_t count) const {
        return count <= static_cast<uint32_t>(std::min(config_.block_size, config_.max_leaf_size));
    }

    void extend(Aabb& bounds, uint32_t primitive) const {
        if (boxes_[primitive].is_finite()) bounds.extend(boxes_[primitive]);
    }

    BvhNode node_over(uint32_t begin, uint32_t end) const {
        Aabb bounds;
        for (uint32_t k = begin; k < end; ++k) extend(bounds, sorted_[0][k]);
        return {bounds.lo, begin, bounds.hi, end - begin};
    }

    // What large nodes do for every axis, a thread an axis.
    template <typename Body>
    static void for_each_axis(uint32_t count, const Body& body) {
        parallel_for(0, 3, count > kSubtreeSize ? 1 : 3, [&](size_t begin, size_t end) {
            for (size_t axis = begin; axis < end; ++axis) body(static_cast<int>(axis));
        });
    }

    // The cost of each position: areas of all suffixes, then a pass over the prefixes.
    void find_costs(const BvhNode& node, int axis) {
        const uint32_t begin = node.first, end = node.first + node.count;
        const std::vector<uint32_t>& order = sorted_[axis];
        std::vector<double>& costs = costs_[axis];
        Aabb right;
        for (uint32_t k = end; --k > begin;) {
            extend(right, order[k]);
            costs[k] = right.half_area() * blocks(end - k);
        }
        Aabb left;
        for (uint32_t k = begin + 1; k < end; ++k) {
            extend(left, order[k - 1]);
            costs[k] = left.half_area() * blocks(k - begin) + costs[k];
        }
    }

    // Among equal costs the most even split wins, so that boxes that all coincide make a balanced tree.
    Split best_split(const BvhNode& node) {
        Split best;
        const uint32_t begin = node.first, end = node.first + node.count;
        const auto unevenness = [&](uint32_t position) {
            const uint32_t left = position - begin, right = end - position;
            return left > right ? left - right : right - left;
        };
        for_each_axis(node.count, [&](int axis) { find_costs(node, axis); });
        double worse = std::numeric_limits<double>::infinity();  // From here on a cost is worse than the best.
        for (int axis = 0; axis < 3; ++axis) {
            for (uint32_t k = begin + 1; k < end; ++k) {
                const double cost = costs_[axis][k];
                if (cost > worse) continue;
                const double slack = 1e-12 * best.cost;
                if (best.axis < 0 || cost < best.cost - slack ||
                    (cost <= best.cost + slack && unevenness(k) < unevenness(best.position))) {
                    best = {axis, k, cost};
                    worse = best.cost + 1e-12 * best.cost;
                }
            }
        }
        return best;
    }

    bool is_better_as_leaf(const BvhNode& node, const Split& split) const {
        if (node.count > static_cast<uint32_t>(config_.max_leaf_size)) return false;
        const double area = node.bounds().half_area();
        return config_.node_cost * area + split.cost >= area * blocks(node.count);
    }

    // Keeps all three orders sorted on both sides.
    void partition(const BvhNode& node, const Split& split) {
        const uint32_t begin = node.first, end = node.first + node.count;
        const std::vector<uint32_t>& order = sorted_[split.axis];
        for (uint32_t k = begin; k < end; ++k) is_left_[order[k]] = k < split.position;
        for (int axis = 0; axis < 3; ++axis) {
            if (axis == split.axis) continue;
            uint32_t left = begin, right_count = 0;
            std::vector<uint32_t>& other = sorted_[axis];
            for (uint32_t k = begin; k < end; ++k) {
                const uint32_t primitive = other[k];
                const bool is_left = is_left_[primitive];
                other[left] = primitive;
                moved_[begin + right_count] = primitive;
                left += is_left ? 1 : 0;
                right_count += is_left ? 0 : 1;
            }
            std::copy_n(moved_.begin() + begin, right_count, other.begin() + left);
        }
    }

    std::span<const Aabb> boxes_;
    const SweepConfig& config_;
    int block_shift_;
    Bvh& bvh_;
    std::array<std::vector<uint32_t>, 3> sorted_;  // Primitives by centroid, an order an axis.
    std::array<std::vector<double>, 3> costs_;     // By position.
    std::vector<uint8_t> is_left_;                 // By primitive.
    std::vector<uint32_t> moved_;
};

}  // namespace

Bvh build_sweep(std::span<const Aabb> boxes, const SweepConfig& config, Bvh storage) {
    assert(std::has_single_bit(static_cast<uint32_t>(config.block_size)));
    storage.nodes.clear();
    storage.primitives.clear();
    if (!boxes.empty()) Builder(boxes, config, &storage).build();
    return storage;
}

}  // namespace zoe
