#include "engine/bvh/cluster_search.h"

#include <algorithm>
#include <bit>
#include <cstddef>

#include "engine/bvh/simd_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "engine/bvh/cluster_search.cpp"
#include <hwy/foreach_target.h>  // Compiles what follows once an instruction set.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace zoe {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

constexpr uint32_t kWidth = ClusterGroup::kWidth;
using FloatTag = hn::CappedTag<float, kWidth>;
using IdTag = hn::RebindToUnsigned<FloatTag>;
using Floats = hn::Vec<FloatTag>;

constexpr float kMaxExtent = 1e18f;  // In floats, those above it count as it: no area overflows.

HWY_INLINE float largest(const glm::vec3& v) {
    return std::max({v.x, v.y, v.z});
}

// A group that may hold a better partner.
struct OpenGroup {
    float least_area;  // About.
    uint32_t min_id, level, group;

    HWY_INLINE bool is_before(const OpenGroup& other) const {
        return least_area < other.least_area || (least_area == other.least_area && min_id < other.min_id);
    }
};

// What floats leave is looked at exactly.
class Search {
public:
    HWY_INLINE Search(const ClusterTree& tree, const Aabb& box, const Partner& known)
        : tree_(tree), box_(box), is_huge_(largest(box.extent()) > kMaxExtent), best_(known) {}

    HWY_INLINE Partner from(uint32_t slot) {
        look_into_leaf(slot / kWidth, slot % kWidth);
        // From the cluster up to the root, so that near ones come first and leave little to be looked into of the rest.
        uint32_t place = slot / kWidth;
        for (uint32_t level = 1; level < tree_.level_count; ++level, place /= kWidth) {
            look_into(level, place / kWidth, place % kWidth);
            while (open_count_ > 0) {
                const OpenGroup next = open_[--open_count_];
                if (!may_hold_better(next)) continue;
                if (next.level == 0) {
                    look_into_leaf(next.group, kWidth);
                } else {
                    look_into(next.level, next.group, kWidth);
                }
            }
        }
        return best_;
    }

private:
    // The least extents, along one axis, of the union of the box with anything under each lane.
    template <bool kIsLeaf>
    HWY_INLINE Floats extent(int axis, const ClusterGroup& group, size_t k) const {
        const FloatTag d;
        const Floats hi = hn::Max(hn::Set(d, box_.hi[axis]), hn::Load(d, group.min_hi[axis] + k));
        const Floats lo = hn::Min(hn::Set(d, box_.lo[axis]), hn::Load(d, group.max_lo[axis] + k));
        Floats extent = hn::Sub(hi, lo);
        if constexpr (!kIsLeaf) extent = hn::Max(extent, hn::Load(d, group.min_extent[axis] + k));
        return hn::Min(extent, hn::Set(d, kMaxExtent));
    }

    // Half the area of the least union with anything under each lane, in floats: five roundings of 2^-24 each from the exact
    // one, about; less than that where extents were cut; and of areas so small that floats are not, anything as small.
    // Returns    the least.
    template <bool kIsLeaf>
    HWY_INLINE float least_areas(const ClusterGroup& group, uint32_t skipped_lane, float* areas) const {
        const FloatTag d;
        const Floats infinity = hn::Set(d, std::numeric_limits<float>::infinity());
        Floats least = infinity;
        for (size_t k = 0; k < kWidth; k += hn::Lanes(d)) {
            const Floats x = extent<kIsLeaf>(0, group, k), y = extent<kIsLeaf>(1, group, k);
            const Floats z = extent<kIsLeaf>(2, group, k);
            const Floats area = hn::Add(hn::Mul(x, hn::Add(y, z)), hn::Mul(y, z));
            const auto lanes = hn::Iota(IdTag(), static_cast<uint32_t>(k));
            const auto is_skipped = hn::RebindMask(d, hn::Eq(lanes, hn::Set(IdTag(), skipped_lane)));
            const Floats other = hn::IfThenElse(is_skipped, infinity, area);
            hn::Store(other, d, areas + k);
            least = hn::Min(least, other);
        }
        return hn::GetLane(hn::MinOfLanes(d, least));
    }

    // Which lanes are not above, as bits.
    HWY_INLINE uint32_t not_above(float most, const float* areas) const {
        const FloatTag d;
        uint32_t bits = 0;
        for (size_t k = 0; k < kWidth; k += hn::Lanes(d)) {
            uint8_t some[8] = {};
            hn::StoreMaskBits(d, hn::Le(hn::Load(d, areas + k), hn::Set(d, most)), some);
            bits |= (uint32_t{some[0]} | uint32_t{some[1]} << 8) << k;
        }
        return bits;
    }

    // Half the area of the least union with anything under a lane; where the lane is one cluster, exactly what
    // Aabb::half_area gives. Never more than that for any cluster (lo, hi) under the lane, rounding included:
    //     union.lo = min(box.lo, lo) <= min(box.lo, max_lo),    union.hi = max(box.hi, hi) >= max(box.hi, min_hi),
    // without rounding; the float min_extent was rounded down, so it is at most double(hi) - lo <= double(union.hi) -
    // union.lo; and differences, products and sums of numbers >= 0, each rounded once and in the order of Aabb::half_area,
    // do not fall where their operands rise.
    HWY_INLINE double least_area(const ClusterGroup& group, uint32_t lane) const {
        double extent[3];
        for (int axis = 0; axis < 3; ++axis) {
            const double hi = std::max(box_.hi[axis], group.min_hi[axis][lane]);
            const double lo = std::min(box_.lo[axis], group.max_lo[axis][lane]);
            extent[axis] = std::max(hi - lo, double{group.min_extent[axis][lane]});
        }
        return extent[0] * extent[1] + extent[1] * extent[2] + extent[2] * extent[0];
    }

    // What no float area of as good a partner is above.
    static HWY_INLINE float threshold(double area) {
        constexpr double kSlack = 1.0 + 0x1p-20;
        if (!(area < 1e37)) return std::numeric_limits<float>::max();
        return std::max(static_cast<float>(area * kSlack), 1e-36f);
    }

    // What no float area of a worse partner, or of one as good, is below, where none of its extents was cut.
    HWY_INLINE float surely_less(double area) const {
        return !is_huge_ && area > 1e-36 && area < 1e36 ? static_cast<float>(area * (1.0 - 0x1p-20)) : 0.0f;
    }

    // Of two partners of this cluster, the pair with the lower id is less, on whichever side of the cluster's it is.
    HWY_INLINE bool is_better(double area, uint32_t other) const {
        return area < best_.half_area || (area == best_.half_area && other < best_.id);
    }

    HWY_INLINE void take_if_better(const ClusterGroup& group, uint32_t lane) {
        const double area = least_area(group, lane);
        if (!is_better(area, group.min_id[lane])) return;
        best_ = {area, group.min_id[lane]};
        most_ = threshold(area);
        less_ = surely_less(area);
    }

    HWY_INLINE void look_into_leaf(uint32_t k, uint32_t skipped_lane) {
        const ClusterGroup& group = tree_.levels[0][k];
        alignas(64) float areas[kWidth];
        const float least = least_areas<true>(group, skipped_lane, areas);
        if (least > most_) return;
        const auto first = static_cast<uint32_t>(__builtin_ctz(not_above(least, areas)));
        take_if_better(group, first);
        for (uint32_t bits = not_above(most_, areas) & ~(1u << first); bits != 0; bits &= bits - 1) {
            take_if_better(group, static_cast<uint32_t>(__builtin_ctz(bits)));
        }
    }

    // Groups become open, the best on top.
    HWY_INLINE void look_into(uint32_t level, uint32_t k, uint32_t skipped_lane) {
        const ClusterGroup& group = tree_.levels[level][k];
        alignas(64) float areas[kWidth];
        least_areas<false>(group, skipped_lane, areas);
        const uint32_t base = open_count_;
        for (uint32_t bits = not_above(most_, areas); bits != 0; bits &= bits - 1) {
            const auto lane = static_cast<uint32_t>(__builtin_ctz(bits));
            const OpenGroup next{areas[lane], group.min_id[lane], level - 1, kWidth * k + lane};
            uint32_t at = open_count_++;
            for (; at > base && open_[at - 1].is_before(next); --at) open_[at] = open_[at - 1];
            open_[at] = next;
        }
    }

    // Whether a group may hold a better partner. Where its area is too near to tell, as of equal boxes, exactly.
    HWY_INLINE bool may_hold_better(const OpenGroup& open) const {
        if (open.least_area > most_) return false;
        if (open.least_area < less_) return true;
        const ClusterGroup& above = tree_.levels[open.level + 1][open.group / kWidth];
        const uint32_t lane = open.group % kWidth;
        return is_better(least_area(above, lane), above.min_id[lane]);
    }

    const ClusterTree& tree_;
    const Aabb& box_;
    const bool is_huge_;
    Partner best_;
    float most_ = threshold(best_.half_area);
    float less_ = surely_less(best_.half_area);
    uint32_t open_count_ = 0;
    // A step takes one and adds at most sixteen of the level below it.
    OpenGroup open_[kWidth * ClusterTree::kMaxLevels];
};

HWY_INLINE float max_of(const float* lanes) {
    const FloatTag d;
    auto most = hn::Load(d, lanes);
    for (size_t k = hn::Lanes(d); k < kWidth; k += hn::Lanes(d)) most = hn::Max(most, hn::Load(d, lanes + k));
    return hn::GetLane(hn::MaxOfLanes(d, most));
}

template <typename Tag, typename Number>
HWY_INLINE Number min_of(Tag d, const Number* lanes) {
    auto least = hn::Load(d, lanes);
    for (size_t k = hn::Lanes(d); k < kWidth; k += hn::Lanes(d)) least = hn::Min(least, hn::Load(d, lanes + k));
    return hn::GetLane(hn::MinOfLanes(d, least));
}

// Returns whether that changed anything.
HWY_INLINE bool sum_up(const ClusterGroup& group, ClusterGroup* above, uint32_t lane) {
    const uint32_t min_id = min_of(IdTag(), group.min_id);
    bool is_changed = min_id != above->min_id[lane];
    above->min_id[lane] = min_id;
    const auto put = [&is_changed](float* to, float from) {
        is_changed |= *to != from;
        *to = from;
    };
    for (int axis = 0; axis < 3; ++axis) {
        put(&above->max_lo[axis][lane], max_of(group.max_lo[axis]));
        put(&above->min_hi[axis][lane], min_of(FloatTag(), group.min_hi[axis]));
        put(&above->min_extent[axis][lane], min_of(FloatTag(), group.min_extent[axis]));
    }
    return is_changed;
}

void refit(const ClusterTree& tree, uint32_t slot) {
    for (uint32_t level = 1, k = slot / kWidth; level < tree.level_count; ++level, k /= kWidth) {
        if (!sum_up(tree.levels[level - 1][k], &tree.levels[level][k / kWidth], k % kWidth)) return;
    }
}

void sum_up_all(const ClusterTree& tree, uint32_t slot_count) {
    uint32_t count = slot_count;
    for (uint32_t level = 1; level < tree.level_count; ++level) {
        count = (count + kWidth - 1) / kWidth;
        for (uint32_t k = 0; k < count; ++k) sum_up(tree.levels[level - 1][k], &tree.levels[level][k / kWidth], k % kWidth);
        for (uint32_t k = count; k % kWidth != 0; ++k) tree.levels[level][k / kWidth].clear(k % kWidth);
    }
}

Partner search(const ClusterTree& tree, const Aabb& box, uint32_t slot, const Partner& known) {
    return Search(tree, box, known).from(slot);
}

}  // namespace HWY_NAMESPACE
}  // namespace zoe
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace zoe {

HWY_EXPORT(search);
HWY_EXPORT(refit);
HWY_EXPORT(sum_up_all);

namespace {

// The largest float that is not above x, for x >= 0.
float rounded_down(double x) {
    const float rounded = static_cast<float>(x);
    return double{rounded} > x ? std::bit_cast<float>(std::bit_cast<uint32_t>(rounded) - 1) : rounded;
}

}  // namespace

void ClusterGroup::set(uint32_t lane, const Aabb& box, uint32_t id) {
    for (int axis = 0; axis < 3; ++axis) {
        max_lo[axis][lane] = box.lo[axis];
        min_hi[axis][lane] = box.hi[axis];
        min_extent[axis][lane] = rounded_down(double(box.hi[axis]) - box.lo[axis]);
    }
    min_id[lane] = id;
}

void ClusterGroup::clear(uint32_t lane) {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
        max_lo[axis][lane] = -kInfinity;
        min_hi[axis][lane] = kInfinity;
        min_extent[axis][lane] = kInfinity;
    }
    min_id[lane] = kNoPartner;
}

void refit_clusters(const ClusterTree& tree, uint32_t slot) {
    HWY_DYNAMIC_DISPATCH(refit)(tree, slot);
}

void sum_up_clusters(const ClusterTree& tree, uint32_t slot_count) {
    HWY_DYNAMIC_DISPATCH(sum_up_all)(tree, slot_count);
}

Partner search_clusters(const ClusterTree& tree, const Aabb& box, uint32_t slot, const Partner& known) {
    return HWY_DYNAMIC_DISPATCH(search)(tree, box, slot, known);
}

}  // namespace zoe

#endif  // HWY_ONCE
