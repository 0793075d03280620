#include "engine/bvh/cluster_tree.h"

#include <algorithm>
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
using IntTag = hn::RebindToSigned<FloatTag>;

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
    bool is_changed = false;
    const auto put = [&is_changed](auto* to, auto from) {
        is_changed |= *to != from;
        *to = from;
    };
    for (int axis = 0; axis < 3; ++axis) {
        put(&above->max_lo[axis][lane], max_of(group.max_lo[axis]));
        put(&above->min_hi[axis][lane], min_of(FloatTag(), group.min_hi[axis]));
        put(&above->min_extent[axis][lane], min_of(FloatTag(), group.min_extent[axis]));
    }
    const IntTag d;
    const int32_t count = min_of(d, group.min_count);
    auto id = hn::Set(d, ClusterGroup::kNoId);
    for (size_t k = 0; k < kWidth; k += hn::Lanes(d)) {
        const auto is_least = hn::Eq(hn::Load(d, group.min_count + k), hn::Set(d, count));
        id = hn::Min(id, hn::IfThenElse(is_least, hn::Load(d, group.min_id + k), id));
    }
    put(&above->min_count[lane], count);
    put(&above->min_id[lane], hn::GetLane(hn::MinOfLanes(d, id)));
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

void ClusterGroup::set(uint32_t lane, const Aabb& box, uint32_t id) {
    for (int axis = 0; axis < 3; ++axis) {
        const float lo = std::clamp(box.lo[axis], -kFarthest, kFarthest);
        max_lo[axis][lane] = lo;
        min_hi[axis][lane] = std::clamp(std::max(box.hi[axis], lo + kSmallest), -kFarthest, kFarthest);
        min_extent[axis][lane] = min_hi[axis][lane] - max_lo[axis][lane];
    }
    min_count[lane] = 1;
    min_id[lane] = static_cast<int32_t>(id);
}

void ClusterGroup::extend(uint32_t lane, const ClusterGroup& by, uint32_t by_lane) {
    for (int axis = 0; axis < 3; ++axis) {
        max_lo[axis][lane] = std::min(max_lo[axis][lane], by.max_lo[axis][by_lane]);
        min_hi[axis][lane] = std::max(min_hi[axis][lane], by.min_hi[axis][by_lane]);
        min_extent[axis][lane] = min_hi[axis][lane] - max_lo[axis][lane];
    }
    min_count[lane] += by.min_count[by_lane];
}

void ClusterGroup::clear(uint32_t lane) {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
        max_lo[axis][lane] = -kInfinity;
        min_hi[axis][lane] = kInfinity;
        min_extent[axis][lane] = kInfinity;
    }
    min_count[lane] = std::numeric_limits<int32_t>::max();
    min_id[lane] = kNoId;
}

void ClusterGroup::copy(uint32_t lane, const ClusterGroup& from, uint32_t from_lane) {
    for (int axis = 0; axis < 3; ++axis) {
        max_lo[axis][lane] = from.max_lo[axis][from_lane];
        min_hi[axis][lane] = from.min_hi[axis][from_lane];
        min_extent[axis][lane] = from.min_extent[axis][from_lane];
    }
    min_count[lane] = from.min_count[from_lane];
    min_id[lane] = from.min_id[from_lane];
}

void refit_clusters(const ClusterTree& tree, uint32_t slot) {
    HWY_DYNAMIC_DISPATCH(refit)(tree, slot);
}

void sum_up_clusters(const ClusterTree& tree, uint32_t slot_count) {
    HWY_DYNAMIC_DISPATCH(sum_up_all)(tree, slot_count);
}

}  // namespace zoe

#endif  // HWY_ONCE
