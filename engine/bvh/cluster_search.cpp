#include "engine/bvh/cluster_search.h"

#include <algorithm>
#include <cstddef>
#include <limits>

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
using IntTag = hn::RebindToSigned<FloatTag>;
using Floats = hn::Vec<FloatTag>;
using Ints = hn::Vec<IntTag>;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

// A group that may hold better partners.
struct OpenGroup {
    float least_area;
    uint32_t level, group;
};

HWY_INLINE Floats half_area(Floats x, Floats y, Floats z) {
    return hn::Add(hn::Mul(x, hn::Add(y, z)), hn::Mul(y, z));
}

HWY_INLINE uint32_t bits_of(hn::Mask<FloatTag> mask) {
    uint8_t bits[8] = {};
    hn::StoreMaskBits(FloatTag(), mask, bits);
    return uint32_t{bits[0]} | uint32_t{bits[1]} << 8;
}

// Clusters of a group, which look for their partners together. No bound is above what it bounds, rounding included: maxima
// and minima are not rounded, and differences, products and sums of numbers >= 0, each rounded once, do not fall where their
// operands rise.
class Search {
public:
    HWY_INLINE Search(const ClusterTree& tree, uint32_t own, uint32_t lanes)
        : tree_(tree), own_place_(own), own_(tree.levels[0][own]), lanes_(lanes) {
        for (uint32_t lane = 0; lane < kWidth; ++lane) {
            count_[lane] = id_[lane] = std::numeric_limits<int32_t>::max();
            // Nothing is better for those that do not search; infinite unions are for nobody.
            const bool searches = (lanes >> lane & 1) != 0;
            best_[lane] = searches ? std::numeric_limits<float>::max() : -1.0f;
            if (!searches) continue;
            for (int axis = 0; axis < 3; ++axis) {
                all_max_lo_[axis] = std::max(all_max_lo_[axis], own_.max_lo[axis][lane]);
                all_min_hi_[axis] = std::min(all_min_hi_[axis], own_.min_hi[axis][lane]);
                all_min_extent_[axis] = std::min(all_min_extent_[axis], own_.min_extent[axis][lane]);
            }
        }
    }

    // From the group up to the root, so that near ones come first and leave little to be looked into of the rest.
    HWY_INLINE void run(uint32_t* partners) {
        look_into_leaf<true>(own_, lanes_);
        uint32_t place = own_place_;
        for (uint32_t level = 1; level < tree_.level_count; ++level, place /= kWidth) {
            look_into(level, place / kWidth, place % kWidth);
            while (open_count_ > 0) {
                const OpenGroup next = open_[--open_count_];
                if (next.least_area > most_) continue;
                const uint32_t lanes = interested(tree_.levels[next.level + 1][next.group / kWidth], next.group % kWidth);
                if (lanes == 0) continue;
                if (next.level == 0) {
                    look_into_leaf<false>(tree_.levels[0][next.group], lanes);
                } else {
                    look_into(next.level, next.group, kWidth);
                }
            }
        }
        for (uint32_t lane = 0; lane < kWidth; ++lane) partners[lane] = static_cast<uint32_t>(id_[lane]);
    }

private:
    // Each of some lanes looks at all in the group, but in its own not at itself.
    template <bool kIsOwn>
    HWY_INLINE void look_into_leaf(const ClusterGroup& group, uint32_t lanes) {
        const FloatTag d;
        const IntTag ints;
        for (; lanes != 0; lanes &= lanes - 1) {
            const auto lane = static_cast<uint32_t>(__builtin_ctz(lanes));
            Floats areas[kParts];
            Floats least = hn::Set(d, std::numeric_limits<float>::max());
            for (size_t j = 0; j < kParts; ++j) {
                const size_t k = j * hn::MaxLanes(d);
                Floats extents[3];
                for (int axis = 0; axis < 3; ++axis) {
                    const Floats hi = hn::Max(hn::Load(d, group.min_hi[axis] + k), hn::Set(d, own_.min_hi[axis][lane]));
                    const Floats lo = hn::Min(hn::Load(d, group.max_lo[axis] + k), hn::Set(d, own_.max_lo[axis][lane]));
                    extents[axis] = hn::Sub(hi, lo);
                }
                areas[j] = half_area(extents[0], extents[1], extents[2]);
                if constexpr (kIsOwn) {
                    const auto is_self =
                        hn::Eq(hn::Iota(ints, static_cast<int32_t>(k)), hn::Set(ints, static_cast<int32_t>(lane)));
                    areas[j] = hn::IfThenElse(hn::RebindMask(d, is_self), hn::Set(d, kInfinity), areas[j]);
                }
                least = hn::Min(least, areas[j]);
            }
            const Floats all_least = hn::MinOfLanes(d, least);
            if (hn::GetLane(all_least) > best_[lane]) continue;
            for (size_t j = 0; j < kParts; ++j) {
                uint32_t left = bits_of(hn::Eq(areas[j], all_least)) << j * hn::MaxLanes(d);
                for (; left != 0; left &= left - 1) {
                    const auto other = static_cast<uint32_t>(__builtin_ctz(left));
                    take_if_better(hn::GetLane(all_least), group.min_count[other], group.min_id[other], lane);
                }
            }
        }
        Floats most = hn::Load(d, best_);
        for (size_t k = hn::MaxLanes(d); k < kWidth; k += hn::MaxLanes(d)) most = hn::Max(most, hn::Load(d, best_ + k));
        most_ = hn::GetLane(hn::MaxOfLanes(d, most));
    }

    HWY_INLINE void take_if_better(float area, int32_t count, int32_t id, uint32_t lane) {
        if (area == best_[lane] && (count != count_[lane] ? count > count_[lane] : id >= id_[lane])) return;
        best_[lane] = area;
        count_[lane] = count;
        id_[lane] = id;
    }

    // Who may find a better partner under a lane, as bits.
    HWY_INLINE uint32_t interested(const ClusterGroup& above, uint32_t lane) const {
        const FloatTag d;
        const IntTag ints;
        uint32_t result = 0;
        for (size_t k = 0; k < kWidth; k += hn::MaxLanes(d)) {
            Floats extents[3];
            for (int axis = 0; axis < 3; ++axis) {
                const Floats hi = hn::Max(hn::Load(d, own_.min_hi[axis] + k), hn::Set(d, above.min_hi[axis][lane]));
                const Floats lo = hn::Min(hn::Load(d, own_.max_lo[axis] + k), hn::Set(d, above.max_lo[axis][lane]));
                extents[axis] = hn::Max(hn::Sub(hi, lo), hn::Set(d, above.min_extent[axis][lane]));
            }
            const Floats area = half_area(extents[0], extents[1], extents[2]), best = hn::Load(d, best_ + k);
            auto is_better = hn::Lt(area, best);
            const auto is_equal = hn::Eq(area, best);
            if (!hn::AllFalse(d, is_equal)) {
                const Ints count = hn::Set(ints, above.min_count[lane]), best_count = hn::Load(ints, count_ + k);
                const auto is_before = hn::Lt(hn::Set(ints, above.min_id[lane]), hn::Load(ints, id_ + k));
                const auto is_less = hn::Or(hn::Lt(count, best_count), hn::And(hn::Eq(count, best_count), is_before));
                is_better = hn::Or(is_better, hn::And(is_equal, hn::RebindMask(d, is_less)));
            }
            result |= bits_of(is_better) << k;
        }
        return result;
    }

    // Groups below become open, the best on top, of equal ones the first: those that may hold a good enough partner, as far
    // as that can be said for all that search together.
    HWY_INLINE void look_into(uint32_t level, uint32_t place, uint32_t skipped_lane) {
        const ClusterGroup& group = tree_.levels[level][place];
        const FloatTag d;
        alignas(64) float areas[kWidth];
        uint32_t bits = 0;
        for (size_t k = 0; k < kWidth; k += hn::MaxLanes(d)) {
            Floats extents[3];
            for (int axis = 0; axis < 3; ++axis) {
                const Floats hi = hn::Max(hn::Load(d, group.min_hi[axis] + k), hn::Set(d, all_min_hi_[axis]));
                const Floats lo = hn::Min(hn::Load(d, group.max_lo[axis] + k), hn::Set(d, all_max_lo_[axis]));
                const Floats least = hn::Max(hn::Load(d, group.min_extent[axis] + k), hn::Set(d, all_min_extent_[axis]));
                extents[axis] = hn::Max(hn::Sub(hi, lo), least);
            }
            const Floats area = half_area(extents[0], extents[1], extents[2]);
            hn::Store(area, d, areas + k);
            bits |= bits_of(hn::Le(area, hn::Set(d, most_))) << k;
        }
        const uint32_t base = open_count_;
        for (bits &= ~(1u << skipped_lane); bits != 0; bits &= bits - 1) {
            const auto lane = static_cast<uint32_t>(__builtin_ctz(bits));
            uint32_t at = open_count_++;
            for (; at > base && open_[at - 1].least_area <= areas[lane]; --at) open_[at] = open_[at - 1];
            open_[at] = {areas[lane], level - 1, kWidth * place + lane};
        }
    }

    static constexpr size_t kParts = kWidth / hn::MaxLanes(FloatTag());

    const ClusterTree& tree_;
    const uint32_t own_place_;
    const ClusterGroup& own_;
    const uint32_t lanes_;
    // What holds for all that search, as in a ClusterGroup.
    float all_max_lo_[3] = {-kInfinity, -kInfinity, -kInfinity};
    float all_min_hi_[3] = {kInfinity, kInfinity, kInfinity};
    float all_min_extent_[3] = {kInfinity, kInfinity, kInfinity};
    // The key of each one's best partner so far.
    alignas(64) float best_[kWidth];
    alignas(64) int32_t count_[kWidth];
    alignas(64) int32_t id_[kWidth];
    float most_ = 0.0f;  // The largest of the areas.
    uint32_t open_count_ = 0;
    // A step takes one and adds at most sixteen of the level below it.
    OpenGroup open_[kWidth * ClusterTree::kMaxLevels];
};

void search(const ClusterTree& tree, uint32_t group, uint32_t lanes, uint32_t* partners) {
    Search(tree, group, lanes).run(partners);
}

}  // namespace HWY_NAMESPACE
}  // namespace zoe
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace zoe {

HWY_EXPORT(search);

void search_clusters(const ClusterTree& tree, uint32_t group, uint32_t lanes, uint32_t* partners) {
    HWY_DYNAMIC_DISPATCH(search)(tree, group, lanes, partners);
}

}  // namespace zoe

#endif  // HWY_ONCE
