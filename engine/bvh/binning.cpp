#include "engine/bvh/binning.h"

#include <algorithm>
#include <cmath>

namespace zoe::binning {

namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

// Lane k of the result is lane `lane` of the k-th argument.
template <int lane>
Float4 gather(Float4 a, Float4 b, Float4 c) {
    return Float4{a[lane], b[lane], c[lane], 0.0f};
}

}  // namespace

Item::Item(const Aabb& box, uint32_t index) {
    const bool is_finite = box.is_finite();
    const glm::vec3 low = is_finite ? box.lo : glm::vec3(kInfinity), high = is_finite ? box.hi : glm::vec3(-kInfinity);
    lo = Float4{low.x, low.y, low.z, static_cast<float>(index & 0xffffffu)};
    hi = Float4{high.x, high.y, high.z, static_cast<float>(index >> 24)};
}

BinMap::BinMap(const Extents& extents, int count)
    : origin(extents.centre_lo), scale(splat(0.0f)), last(splat(static_cast<float>(count - 1))), bin_count(count) {
    for (int axis = 0; axis < 3; ++axis) {
        const float bins_a_unit = static_cast<float>(count / (double(extents.centre_hi[axis]) - extents.centre_lo[axis]));
        // No extent to speak of, or none at all.
        if (std::isfinite(bins_a_unit) && bins_a_unit > 0.0f) scale[axis] = bins_a_unit;
    }
}

void Bins::clear(int bin_count) {
    for (int k = 0; k < bin_count; ++k) {
        Bin& bin = bins[k];
        for (int axis = 0; axis < 3; ++axis) {
            bin.lo[axis] = splat(kInfinity);
            bin.hi[axis] = splat(-kInfinity);
        }
        bin.count = Int4{0, 0, 0, 0};
    }
}

void Bins::add(std::span<const Item> items, const BinMap& map) {
    for (const Item& item : items) {
        const Int4 place = map(item);
        for (int axis = 0; axis < 3; ++axis) {
            Bin& bin = bins[place[axis]];
            bin.lo[axis] = min(item.lo, bin.lo[axis]);
            bin.hi[axis] = max(item.hi, bin.hi[axis]);
            ++bin.count[axis];
        }
    }
}

void Bins::add(const Bins& other, int bin_count) {
    for (int k = 0; k < bin_count; ++k) {
        for (int axis = 0; axis < 3; ++axis) {
            bins[k].lo[axis] = min(other.bins[k].lo[axis], bins[k].lo[axis]);
            bins[k].hi[axis] = max(other.bins[k].hi[axis], bins[k].hi[axis]);
        }
        bins[k].count += other.bins[k].count;
    }
}

AreaScale::AreaScale(const Extents& extents) : scale_(splat(1.0f)) {
    const Float4 size = extent(extents.lo, extents.hi);
    const float largest = std::max({size[0], size[1], size[2]});
    if (largest > 0.0f) scale_ = splat(std::ldexp(1.0f, -std::clamp(std::ilogb(largest), -126, 126)));
}

// From 0, for an empty box, to the largest float.
Float4 AreaScale::extent(Float4 lo, Float4 hi) const {
    return min(max(hi - lo, splat(0.0f)), splat(std::numeric_limits<float>::max())) * scale_;
}

float AreaScale::area(Float4 lo, Float4 hi) const {
    const Float4 size = extent(lo, hi);
    return size[0] * size[1] + size[1] * size[2] + size[2] * size[0];
}

Float4 AreaScale::areas(const Float4 lo[3], const Float4 hi[3]) const {
    const Float4 a = extent(lo[0], hi[0]), b = extent(lo[1], hi[1]), c = extent(lo[2], hi[2]);
    const Float4 x = gather<0>(a, b, c), y = gather<1>(a, b, c), z = gather<2>(a, b, c);
    return x * y + y * z + z * x;
}

Split best_split(const Bins& bins, int bin_count, uint32_t item_count, int block_shift, const AreaScale& scale) {
    const auto blocks = [&](Int4 n) {
        return __builtin_convertvector((n + ((1 << block_shift) - 1)) >> block_shift, Float4);
    };
    const auto count = static_cast<int32_t>(item_count);
    std::array<Float4, kMaxBins> right_costs;
    Bins::Bin right = bins.bins[bin_count - 1];
    for (int k = bin_count - 1; k > 0; --k) {
        right_costs[k] = scale.areas(right.lo, right.hi) * blocks(right.count);
        const Bins::Bin& next = bins.bins[k - 1];
        for (int axis = 0; axis < 3; ++axis) {
            right.lo[axis] = min(next.lo[axis], right.lo[axis]);
            right.hi[axis] = max(next.hi[axis], right.hi[axis]);
        }
        right.count += next.count;
    }
    Float4 best_cost = splat(kInfinity);
    Int4 best_bin{0, 0, 0, 0}, best_unevenness{0, 0, 0, 0};
    Bins::Bin left = bins.bins[0];
    for (int k = 1; k < bin_count; ++k) {
        const Float4 cost = scale.areas(left.lo, left.hi) * blocks(left.count) + right_costs[k];
        const Int4 right_count = count - left.count;
        const Int4 unevenness = left.count > right_count ? left.count : right_count;
        const Int4 is_better = (left.count > 0) & (right_count > 0) &
                               ((cost < best_cost) | ((cost == best_cost) & (unevenness < best_unevenness)));
        best_cost = is_better ? cost : best_cost;
        best_bin = is_better ? Int4{k, k, k, k} : best_bin;
        best_unevenness = is_better ? unevenness : best_unevenness;
        const Bins::Bin& next = bins.bins[k];
        for (int axis = 0; axis < 3; ++axis) {
            left.lo[axis] = min(next.lo[axis], left.lo[axis]);
            left.hi[axis] = max(next.hi[axis], left.hi[axis]);
        }
        left.count += next.count;
    }
    Split split;
    int32_t least_unevenness = 0;
    for (int axis = 0; axis < 3; ++axis) {
        if (best_bin[axis] == 0) continue;
        if (best_cost[axis] < split.cost || (best_cost[axis] == split.cost && best_unevenness[axis] < least_unevenness)) {
            split = {axis, best_bin[axis], best_cost[axis]};
            least_unevenness = best_unevenness[axis];
        }
    }
    return split;
}

// Without a branch on where an item goes, which no processor could guess.
uint32_t partition(std::span<Item> items, const BinMap& map, const Split& split, Item* moved) {
    const int axis = split.axis;
    const float origin = map.origin[axis], scale = map.scale[axis];
    const auto first_right = static_cast<float>(split.bin);
    uint32_t left = 0, right = 0;
    for (const Item& item : items) {
        const Item copy = item;
        // As `map` has it, for one axis.
        const bool is_left = (0.5f * copy.lo[axis] + 0.5f * copy.hi[axis] - origin) * scale < first_right;
        items[left] = copy;
        moved[right] = copy;
        left += is_left ? 1 : 0;
        right += is_left ? 0 : 1;
    }
    std::copy_n(moved, right, items.begin() + left);
    return left;
}

}  // namespace zoe::binning
