#include "engine/bvh/build_binned.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory_resource>
#include <numeric>
#include <vector>

#include "engine/bvh/small_stack.h"
#include "engine/math/parallel.h"

namespace zoe {

namespace {

constexpr int kMaxBins = 64;
constexpr uint32_t kSubtreeSize = 4096;  // Subtrees of at most this many primitives are built by one thread each.
constexpr uint32_t kUnused = 0xffffffffu;

// A node in the making. Its descendants get nodes [room, room + 2 * count - 2): places depend on the split positions only,
// so threads never meet and the tree never depends on them.
struct Range {
    uint32_t node, begin, end, room;
    uint32_t count() const { return end - begin; }
};

struct Bin {
    Aabb bounds;
    uint32_t count = 0;
};

struct Split {
    int axis = -1;
    int bin = 0;  // First bin of the right side.
    double cost = std::numeric_limits<double>::infinity();
    uint32_t unevenness = 0;  // The larger side's count: among equal costs (no area at all) the most even split wins.
};

class Builder {
public:
    Builder(std::span<const Aabb> boxes, const BinnedConfig& config, Bvh* bvh)
        : boxes_(boxes), config_(config), bvh_(*bvh) {}

    void build() {
        const uint32_t n = static_cast<uint32_t>(boxes_.size());
        bvh_.primitives.resize(n);
        std::iota(bvh_.primitives.begin(), bvh_.primitives.end(), 0u);
        bvh_.nodes.assign(2 * size_t(n) - 1, BvhNode{{}, 0, {}, kUnused});
        // The top serially, down to subtrees that are built in parallel.
        std::byte in_place[32 * 1024];  // Room for about 1,000 subtrees; more go to the heap.
        std::pmr::monotonic_buffer_resource memory(in_place, sizeof in_place);
        std::pmr::vector<Range> subtrees(&memory);
        grow({0, 0, n, 1}, kSubtreeSize, &subtrees);
        parallel_for(0, subtrees.size(), 1, [&](size_t begin, size_t) { grow(subtrees[begin], 0, nullptr); });
        compact();
    }

private:
    glm::vec3 centre(uint32_t primitive) const {
        const Aabb& box = boxes_[primitive];
        return box.is_finite() ? box.centre() : glm::vec3(0.0f);
    }

    // Splits until ranges are leaves, or (where `small` is given) have at most `small_size` primitives.
    void grow(Range root, uint32_t small_size, std::pmr::vector<Range>* small) {
        SmallStack<Range, 64> open;
        open.push(root);
        while (!open.is_empty()) {
            const Range range = open.pop();
            if (small && range.count() <= small_size) {
                small->push_back(range);
                continue;
            }
            Aabb bounds, centres;
            for (uint32_t k = range.begin; k < range.end; ++k) {
                const uint32_t primitive = bvh_.primitives[k];
                if (boxes_[primitive].is_finite()) bounds.extend(boxes_[primitive]);
                centres.extend(centre(primitive));
            }
            BvhNode& node = bvh_.nodes[range.node];
            node = {bounds.lo, range.begin, bounds.hi, range.count()};
            const uint32_t middle = split(range, bounds, centres);
            if (middle == range.begin) continue;  // A leaf.
            node.first = range.room;
            node.count = 0;
            const uint32_t left_room = range.room + 2, right_room = left_room + 2 * (middle - range.begin) - 2;
            open.push({range.room + 1, middle, range.end, right_room});
            open.push({range.room, range.begin, middle, left_room});
        }
    }

    // Reorders the range. Returns the first primitive of the right side; range.begin for a leaf.
    uint32_t split(const Range& range, const Aabb& bounds, const Aabb& centres) {
        if (range.count() < 2) return range.begin;
        const bool may_be_leaf = range.count() <= static_cast<uint32_t>(config_.max_leaf_size);
        const Split best = best_split(range, centres);
        const double area = bounds.half_area();
        if (may_be_leaf && (best.axis < 0 || config_.node_cost * area + best.cost >= area * range.count()))
            return range.begin;
        // All centroids in one place: any halves are as good.
        if (best.axis < 0) return range.begin + range.count() / 2;
        const auto first = bvh_.primitives.begin();
        const float lo = centres.lo[best.axis], scale = bin_scale(centres, best.axis);
        const auto middle = std::partition(first + range.begin, first + range.end, [&](uint32_t primitive) {
            return bin_of(centre(primitive)[best.axis], lo, scale) < best.bin;
        });
        return static_cast<uint32_t>(middle - first);
    }

    // Bins a unit of length; 0 where the centroids have no extent to speak of (or an infinite one).
    float bin_scale(const Aabb& centres, int axis) const {
        const float scale = static_cast<float>(config_.bin_count / (double(centres.hi[axis]) - centres.lo[axis]));
        return std::isfinite(scale) ? scale : 0.0f;
    }
    int bin_of(float x, float lo, float scale) const {
        const float bin = (x - lo) * scale;
        return bin < static_cast<float>(config_.bin_count - 1) ? static_cast<int>(bin) : config_.bin_count - 1;
    }

    Split best_split(const Range& range, const Aabb& centres) const {
        Split best;
        std::array<Bin, kMaxBins> bins;
        std::array<double, kMaxBins> right_cost;
        for (int axis = 0; axis < 3; ++axis) {
            const float lo = centres.lo[axis], scale = bin_scale(centres, axis);
            if (scale == 0.0f) continue;
            std::fill_n(bins.begin(), config_.bin_count, Bin{});
            for (uint32_t k = range.begin; k < range.end; ++k) {
                const uint32_t primitive = bvh_.primitives[k];
                Bin& bin = bins[bin_of(centre(primitive)[axis], lo, scale)];
                if (boxes_[primitive].is_finite()) bin.bounds.extend(boxes_[primitive]);
                ++bin.count;
            }
            Bin right;
            for (int k = config_.bin_count; --k > 0;) {
                right.bounds.extend(bins[k].bounds);
                right.count += bins[k].count;
                right_cost[k] = right.bounds.half_area() * right.count;
            }
            Bin left;
            for (int k = 1; k < config_.bin_count; ++k) {
                left.bounds.extend(bins[k - 1].bounds);
                left.count += bins[k - 1].count;
                if (left.count == 0 || left.count == range.count()) continue;
                const double cost = left.bounds.half_area() * left.count + right_cost[k];
                const uint32_t unevenness = std::max(left.count, range.count() - left.count);
                if (cost < best.cost || (cost == best.cost && unevenness < best.unevenness))
                    best = {axis, k, cost, unevenness};
            }
        }
        return best;
    }

    // Closes the gaps that leaves of several primitives left; the order of nodes stays.
    void compact() {
        thread_local std::vector<uint32_t> place;
        place.resize(bvh_.nodes.size());
        uint32_t used = 0;
        for (size_t k = 0; k < bvh_.nodes.size(); ++k) {
            place[k] = used;
            if (bvh_.nodes[k].count != kUnused) ++used;
        }
        for (size_t k = 0; k < bvh_.nodes.size(); ++k) {
            BvhNode node = bvh_.nodes[k];
            if (node.count == kUnused) continue;
            if (!node.is_leaf()) node.first = place[node.first];
            bvh_.nodes[place[k]] = node;
        }
        bvh_.nodes.resize(used);
    }

    std::span<const Aabb> boxes_;
    const BinnedConfig& config_;
    Bvh& bvh_;
};

}  // namespace

Bvh build_binned(std::span<const Aabb> boxes, const BinnedConfig& config, Bvh storage) {
    assert(config.bin_count >= 2 && config.bin_count <= kMaxBins);
    storage.nodes.clear();
    storage.primitives.clear();
    if (!boxes.empty()) Builder(boxes, config, &storage).build();
    return storage;
}

}  // namespace zoe
