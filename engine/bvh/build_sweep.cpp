#include "engine/bvh/build_sweep.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>

#include "engine/bvh/small_stack.h"
#include "engine/math/parallel.h"

namespace zoe {

namespace {

struct Split {
    int axis = -1;
    uint32_t position = 0;                                  // First primitive of the right side.
    double cost = std::numeric_limits<double>::infinity();  // Area times count, both sides.
};

class Builder {
public:
    Builder(std::span<const Aabb> boxes, const SweepConfig& config, Bvh* bvh) : boxes_(boxes), config_(config), bvh_(*bvh) {
        const size_t n = boxes.size();
        is_left_.resize(n);
        moved_.resize(n);
        right_area_.resize(n);
        parallel_for(0, 3, 1, [&](size_t begin, size_t) { sort_along(static_cast<int>(begin)); });
    }

    void build() {
        SmallStack<uint32_t, 64> open;
        bvh_.nodes.push_back(node_over(0, static_cast<uint32_t>(boxes_.size())));
        open.push(0);
        while (!open.is_empty()) {
            const uint32_t k = open.pop();
            const BvhNode node = bvh_.nodes[k];
            const Split split = best_split(node);
            if (is_better_as_leaf(node, split)) continue;
            partition(node, split);
            const uint32_t children = static_cast<uint32_t>(bvh_.nodes.size());
            bvh_.nodes.push_back(node_over(node.first, split.position));
            bvh_.nodes.push_back(node_over(split.position, node.first + node.count));
            bvh_.nodes[k].first = children;
            bvh_.nodes[k].count = 0;
            open.push(children + 1);
            open.push(children);
        }
        bvh_.primitives = std::move(sorted_[0]);
    }

private:
    void sort_along(int axis) {
        std::vector<float> key(boxes_.size());
        for (size_t k = 0; k < boxes_.size(); ++k) {
            key[k] = boxes_[k].is_finite() ? 0.5f * boxes_[k].lo[axis] + 0.5f * boxes_[k].hi[axis] : 0.0f;
        }
        std::vector<uint32_t>& order = sorted_[axis];
        order.resize(boxes_.size());
        std::iota(order.begin(), order.end(), 0u);
        std::sort(order.begin(), order.end(),
                  [&](uint32_t a, uint32_t b) { return key[a] < key[b] || (key[a] == key[b] && a < b); });
    }

    void extend(Aabb& bounds, uint32_t primitive) const {
        if (boxes_[primitive].is_finite()) bounds.extend(boxes_[primitive]);
    }

    BvhNode node_over(uint32_t begin, uint32_t end) const {
        Aabb bounds;
        for (uint32_t k = begin; k < end; ++k) extend(bounds, sorted_[0][k]);
        return {bounds.lo, begin, bounds.hi, end - begin};
    }

    // Areas of all suffixes, then a pass over the prefixes. Among equal costs the most even split wins, so that boxes that
    // all coincide make a balanced tree.
    Split best_split(const BvhNode& node) {
        Split best;
        const uint32_t begin = node.first, end = node.first + node.count;
        const auto unevenness = [&](uint32_t position) {
            const uint32_t left = position - begin, right = end - position;
            return left > right ? left - right : right - left;
        };
        for (int axis = 0; axis < 3; ++axis) {
            const std::vector<uint32_t>& order = sorted_[axis];
            Aabb right;
            for (uint32_t k = end; --k > begin;) {
                extend(right, order[k]);
                right_area_[k] = right.half_area();
            }
            Aabb left;
            for (uint32_t k = begin + 1; k < end; ++k) {
                extend(left, order[k - 1]);
                const double cost = left.half_area() * (k - begin) + right_area_[k] * (end - k);
                const double slack = 1e-12 * best.cost;
                if (best.axis < 0 || cost < best.cost - slack ||
                    (cost <= best.cost + slack && unevenness(k) < unevenness(best.position))) {
                    best = {axis, k, cost};
                }
            }
        }
        return best;
    }

    bool is_better_as_leaf(const BvhNode& node, const Split& split) const {
        if (node.count < 2) return true;
        if (node.count > static_cast<uint32_t>(config_.max_leaf_size)) return false;
        const double area = node.bounds().half_area();
        return config_.node_cost * area + split.cost >= area * node.count;
    }

    // Keeps all three orders sorted on both sides.
    void partition(const BvhNode& node, const Split& split) {
        const uint32_t begin = node.first, end = node.first + node.count;
        const std::vector<uint32_t>& order = sorted_[split.axis];
        for (uint32_t k = begin; k < end; ++k) is_left_[order[k]] = k < split.position;
        for (int axis = 0; axis < 3; ++axis) {
            if (axis == split.axis) continue;
            uint32_t left = begin, right_count = 0;
            for (uint32_t k = begin; k < end; ++k) {
                const uint32_t primitive = sorted_[axis][k];
                if (is_left_[primitive]) {
                    sorted_[axis][left++] = primitive;
                } else {
                    moved_[right_count++] = primitive;
                }
            }
            std::copy_n(moved_.begin(), right_count, sorted_[axis].begin() + left);
        }
    }

    std::span<const Aabb> boxes_;
    const SweepConfig& config_;
    Bvh& bvh_;
    std::array<std::vector<uint32_t>, 3> sorted_;  // Primitives by centroid, an order an axis.
    std::vector<uint8_t> is_left_;                 // By primitive.
    std::vector<uint32_t> moved_;
    std::vector<double> right_area_;
};

}  // namespace

Bvh build_sweep(std::span<const Aabb> boxes, const SweepConfig& config, Bvh storage) {
    storage.nodes.clear();
    storage.primitives.clear();
    if (!boxes.empty()) Builder(boxes, config, &storage).build();
    return storage;
}

}  // namespace zoe
