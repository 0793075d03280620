#include "engine/bvh/build_poses.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <numeric>
#include <vector>

#include "engine/bvh/assemble.h"
#include "engine/bvh/binning.h"
#include "engine/bvh/small_stack.h"
#include "engine/math/parallel.h"

namespace zoe {

namespace {

using binning::BinMap;
using binning::Extents;
using binning::Item;

// Smaller ones are built by a task each.
constexpr uint32_t kSubtreeSize = 2048;

Aabb box_of(binning::Float4 lo, binning::Float4 hi) {
    return {{lo[0], lo[1], lo[2]}, {hi[0], hi[1], hi[2]}};
}

// A box that holds nothing has no area.
double area_of(const Extents& extents) {
    const Aabb box = box_of(extents.lo, extents.hi);
    if (box.is_empty()) return 0.0;
    const glm::dvec3 size = glm::dvec3(box.hi) - glm::dvec3(box.lo);
    return size.x * size.y + size.y * size.z + size.z * size.x;
}

class Builder {
public:
    Builder(std::span<const Aabb> boxes, size_t pose_count, const PosesConfig& config)
        : pose_count_(pose_count),
          config_(config),
          block_shift_(std::countr_zero(static_cast<uint32_t>(config.block_size))),
          items_(boxes.size()),
          order_(boxes.size() / pose_count) {
        // A primitive's boxes side by side: they are read together.
        parallel_for(0, order_.size(), kSubtreeSize, [&](size_t begin, size_t end) {
            for (size_t k = begin; k < end; ++k) {
                order_[k] = static_cast<uint32_t>(k);
                for (size_t pose = 0; pose < pose_count_; ++pose)
                    items_[k * pose_count_ + pose] = Item(boxes[pose * order_.size() + k], 0);
            }
        });
    }

    Bvh build() {
        Work work(*this);
        const BvhNode root = node_over(0, static_cast<uint32_t>(order_.size()), &work);
        // By SAH a node costs its area over the root's: in each pose its own.
        for (const Extents& extents : work.extents) {
            const double area = area_of(extents);
            weights_.push_back(area > 0.0 ? 1.0 / area : 0.0);
        }
        TreeParts parts;
        parts.top.push_back(root);
        std::vector<uint32_t> small;
        grow(&parts.top, kSubtreeSize, &small, &work);
        parts.subtree_of_top.assign(parts.top.size(), TreeParts::kNone);
        parts.subtrees.resize(small.size());
        for (uint32_t k = 0; k < small.size(); ++k) {
            parts.subtree_of_top[small[k]] = k;
            parts.subtrees[k].push_back(parts.top[small[k]]);
        }
        parallel_for(0, small.size(), 1, [&](size_t begin, size_t end) {
            Work own(*this);
            for (size_t k = begin; k < end; ++k) grow(&parts.subtrees[k], 0, nullptr, &own);
        });
        Bvh bvh;
        bvh.nodes = assemble(&parts);
        bvh.primitives = std::move(order_);
        return bvh;
    }

private:
    struct Bin {
        uint32_t count;
        double area;  // Summed over the poses, of this bin and all after it.
    };
    // Memory of one thread.
    struct Work {
        explicit Work(const Builder& builder)
            : extents(builder.pose_count_), around(builder.pose_count_), in_bins(builder.pose_count_ * binning::kMaxBins) {}
        std::vector<Extents> extents;  // [pose] of the node.
        std::vector<Extents> around;   // [pose] of one side of a split.
        std::vector<Extents> in_bins;  // [bin * pose_count + pose]
        std::vector<uint32_t> moved;
        Bin bins[binning::kMaxBins];
    };
    struct Split {
        size_t pose = 0;
        int axis = -1, bin = 0;  // The first bin of the right side.
        double cost = std::numeric_limits<double>::infinity();
    };

    std::span<const Item> poses_of(uint32_t primitive) const {
        return std::span(items_).subspan(primitive * pose_count_, pose_count_);
    }

    double blocks(uint32_t count) const { return ((count + (1u << block_shift_) - 1) >> block_shift_); }

    double area(std::span<const Extents> extents) const {
        double sum = 0.0;
        for (size_t pose = 0; pose < pose_count_; ++pose) sum += weights_[pose] * area_of(extents[pose]);
        return sum;
    }

    BvhNode node_over(uint32_t begin, uint32_t end, Work* work) const {
        std::ranges::fill(work->extents, Extents{});
        for (uint32_t k = begin; k < end; ++k) {
            const std::span<const Item> poses = poses_of(order_[k]);
            for (size_t pose = 0; pose < pose_count_; ++pose) work->extents[pose].extend(poses[pose]);
        }
        const Aabb bounds = box_of(work->extents[0].lo, work->extents[0].hi);
        return {bounds.lo, begin, bounds.hi, end - begin};
    }

    // Splits the first of the nodes, on and on, until there are leaves, or (where `small` is given) no more than
    // `small_size` primitives in a node.
    void grow(std::vector<BvhNode>* nodes, uint32_t small_size, std::vector<uint32_t>* small, Work* work) {
        SmallStack<uint32_t, 64> open;
        open.push(0);
        while (!open.is_empty()) {
            const uint32_t k = open.pop();
            const BvhNode node = (*nodes)[k];
            if (small && node.count <= small_size) {
                small->push_back(k);
                continue;
            }
            if (node.count <= static_cast<uint32_t>(std::min(config_.block_size, config_.max_leaf_size))) continue;
            const uint32_t end = node.first + node.count;
            node_over(node.first, end, work);
            const Split split = best_split(node.first, end, work);
            if (is_better_as_leaf(node.count, area(work->extents), split.cost)) continue;
            const uint32_t middle = split.axis < 0 ? node.first + node.count / 2 : partition(node.first, end, split, work);
            const auto children = static_cast<uint32_t>(nodes->size());
            nodes->push_back(node_over(node.first, middle, work));
            nodes->push_back(node_over(middle, end, work));
            (*nodes)[k].first = children;
            (*nodes)[k].count = 0;
            open.push(children + 1);
            open.push(children);
        }
    }

    bool is_better_as_leaf(uint32_t count, double node_area, double split_cost) const {
        if (count > static_cast<uint32_t>(config_.max_leaf_size)) return false;
        return config_.node_cost * node_area + split_cost >= node_area * blocks(count);
    }

    Split best_split(uint32_t begin, uint32_t end, Work* work) const {
        Split best;
        for (size_t pose = 0; pose < pose_count_; ++pose) {
            const BinMap map(work->extents[pose], config_.bin_count);
            for (int axis = 0; axis < 3; ++axis) {
                if (map.scale[axis] > 0.0f) try_axis(begin, end, pose, axis, map, work, &best);
            }
        }
        return best;
    }

    void try_axis(uint32_t begin, uint32_t end, size_t pose, int axis, const BinMap& map, Work* work, Split* best) const {
        const auto in_bin = [&](int bin) {
            return std::span(work->in_bins).subspan(size_t(bin) * pose_count_, pose_count_);
        };
        std::fill_n(work->in_bins.begin(), size_t(map.bin_count) * pose_count_, Extents{});
        std::fill_n(work->bins, map.bin_count, Bin{});
        for (uint32_t k = begin; k < end; ++k) {
            const std::span<const Item> poses = poses_of(order_[k]);
            const int bin = map(poses[pose])[axis];
            ++work->bins[bin].count;
            const std::span<Extents> extents = in_bin(bin);
            for (size_t other = 0; other < pose_count_; ++other) {
                extents[other].lo = binning::min(poses[other].lo, extents[other].lo);
                extents[other].hi = binning::max(poses[other].hi, extents[other].hi);
            }
        }
        const auto add = [&](int bin) {
            for (size_t other = 0; other < pose_count_; ++other) {
                work->around[other].lo = binning::min(in_bin(bin)[other].lo, work->around[other].lo);
                work->around[other].hi = binning::max(in_bin(bin)[other].hi, work->around[other].hi);
            }
        };
        std::ranges::fill(work->around, Extents{});
        for (int bin = map.bin_count; --bin > 0;) {
            add(bin);
            work->bins[bin].area = area(work->around);
        }
        std::ranges::fill(work->around, Extents{});
        uint32_t left = 0;
        for (int bin = 1; bin < map.bin_count; ++bin) {
            add(bin - 1);
            left += work->bins[bin - 1].count;
            const uint32_t right = end - begin - left;
            if (left == 0 || right == 0) continue;
            const double cost = area(work->around) * blocks(left) + work->bins[bin].area * blocks(right);
            if (cost < best->cost) *best = {pose, axis, bin, cost};
        }
    }

    // Keeps the order on both sides.
    uint32_t partition(uint32_t begin, uint32_t end, const Split& split, Work* work) {
        const BinMap map(work->extents[split.pose], config_.bin_count);
        work->moved.clear();
        uint32_t middle = begin;
        for (uint32_t k = begin; k < end; ++k) {
            const uint32_t primitive = order_[k];
            if (map(poses_of(primitive)[split.pose])[split.axis] < split.bin) {
                order_[middle++] = primitive;
            } else {
                work->moved.push_back(primitive);
            }
        }
        std::ranges::copy(work->moved, order_.begin() + middle);
        return middle;
    }

    size_t pose_count_;
    const PosesConfig& config_;
    int block_shift_;
    std::vector<Item> items_;      // [primitive * pose_count + pose]
    std::vector<uint32_t> order_;  // Primitives, in the order of the leaves.
    std::vector<double> weights_;  // [pose]
};

}  // namespace

Bvh build_poses(std::span<const Aabb> boxes, size_t pose_count, const PosesConfig& config) {
    assert(std::has_single_bit(static_cast<uint32_t>(config.block_size)) && pose_count > 0 &&
           boxes.size() % pose_count == 0);
    assert(config.bin_count >= 2 && config.bin_count <= binning::kMaxBins);
    if (boxes.empty()) return {};
    return Builder(boxes, pose_count, config).build();
}

}  // namespace zoe
