#include "engine/bvh/cluster_tree.h"

#include <bit>
#include <cstddef>
#include <limits>

#include "engine/math/simd_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "engine/bvh/cluster_tree.cpp"
#include <hwy/foreach_target.h>  // Compiles what follows once an instruction set.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace zoe {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

constexpr uint32_t kWidth = ClusterGroup::kWidth;
using FloatTag = hn::CappedTag<float, kWidth>;
using IdTag = hn::RebindToUnsigned<FloatTag>;

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

}  // namespace HWY_NAMESPACE
}  // namespace zoe
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace zoe {

HWY_EXPORT(refit);
HWY_EXPORT(sum_up_all);

namespace {

// The largest float that is not above x, for x >= 0.
float rounded_down(double x) {
    const float rounded = static_cast<float>(x);
    return double{rounded} > x ? std::bit_cast<float>(std::bit_cast<uint32_t>(rounded) - 1) : rounded;
}

}  // namespace

Aabb ClusterGroup::box(uint32_t lane) const {
    return {{max_lo[0][lane], max_lo[1][lane], max_lo[2][lane]}, {min_hi[0][lane], min_hi[1][lane], min_hi[2][lane]}};
}

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

}  // namespace zoe

#endif  // HWY_ONCE
