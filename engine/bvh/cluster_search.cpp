#include "engine/bvh/cluster_search.h"

#include <algorithm>
#include <cstddef>

#include "engine/math/simd_targets.h"

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

constexpr size_t kParts = kWidth / hn::MaxLanes(FloatTag());

struct Areas {
    Floats parts[kParts];
};

HWY_INLINE uint32_t lowest(uint32_t bits) {
    return static_cast<uint32_t>(__builtin_ctz(bits));
}

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
    template <bool kIsLeaf>
    HWY_INLINE void find_areas(const ClusterGroup& group, uint32_t skipped_lane, Areas* areas) const {
        const FloatTag d;
        for (size_t j = 0; j < kParts; ++j) {
            const size_t k = j * hn::MaxLanes(d);
            const Floats x = extent<kIsLeaf>(0, group, k), y = extent<kIsLeaf>(1, group, k);
            const Floats z = extent<kIsLeaf>(2, group, k);
            const Floats area = hn::Add(hn::Mul(x, hn::Add(y, z)), hn::Mul(y, z));
            const auto lanes = hn::Iota(IdTag(), static_cast<uint32_t>(k));
            const auto is_skipped = hn::RebindMask(d, hn::Eq(lanes, hn::Set(IdTag(), skipped_lane)));
            areas->parts[j] = hn::IfThenElse(is_skipped, hn::Set(d, std::numeric_limits<float>::infinity()), area);
        }
    }

    static HWY_INLINE float least(const Areas& areas) {
        Floats least = areas.parts[0];
        for (size_t j = 1; j < kParts; ++j) least = hn::Min(least, areas.parts[j]);
        return hn::GetLane(hn::MinOfLanes(FloatTag(), least));
    }

    // Which lanes are not above, as bits.
    static HWY_INLINE uint32_t not_above(float most, const Areas& areas) {
        const FloatTag d;
        uint32_t bits = 0;
        for (size_t j = 0; j < kParts; ++j) {
            uint8_t some[8] = {};
            hn::StoreMaskBits(d, hn::Le(areas.parts[j], hn::Set(d, most)), some);
            bits |= (uint32_t{some[0]} | uint32_t{some[1]} << 8) << (j * hn::MaxLanes(d));
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
        Areas areas;
        find_areas<true>(group, skipped_lane, &areas);
        uint32_t bits = not_above(most_, areas);
        if (bits == 0) return;
        if ((bits & (bits - 1)) != 0) {
            // The least one first: it leaves few of the others.
            const uint32_t first = not_above(least(areas), areas);
            take_if_better(group, lowest(first));
            bits = not_above(most_, areas) & ~(first & (0 - first));
        }
        for (; bits != 0; bits &= bits - 1) take_if_better(group, lowest(bits));
    }

    // Groups become open, the best on top.
    HWY_INLINE void look_into(uint32_t level, uint32_t k, uint32_t skipped_lane) {
        const ClusterGroup& group = tree_.levels[level][k];
        Areas areas;
        find_areas<false>(group, skipped_lane, &areas);
        uint32_t bits = not_above(most_, areas);
        if (bits == 0) return;
        alignas(64) float area_of_lane[kWidth];
        for (size_t j = 0; j < kParts; ++j) {
            hn::Store(areas.parts[j], FloatTag(), area_of_lane + j * hn::MaxLanes(FloatTag()));
        }
        const uint32_t base = open_count_;
        for (; bits != 0; bits &= bits - 1) {
            const uint32_t lane = lowest(bits);
            const OpenGroup next{area_of_lane[lane], group.min_id[lane], level - 1, kWidth * k + lane};
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

Partner search(const ClusterTree& tree, const Aabb& box, uint32_t slot, const Partner& known) {
    return Search(tree, box, known).from(slot);
}

}  // namespace HWY_NAMESPACE
}  // namespace zoe
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace zoe {

HWY_EXPORT(search);

Partner search_clusters(const ClusterTree& tree, const Aabb& box, uint32_t slot, const Partner& known) {
    return HWY_DYNAMIC_DISPATCH(search)(tree, box, slot, known);
}

}  // namespace zoe

#endif  // HWY_ONCE
