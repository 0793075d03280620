#include "engine/bvh/ploc_search.h"

#include <cstddef>
#include <limits>

#include "engine/math/simd_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "engine/bvh/ploc_search.cpp"
#include <hwy/foreach_target.h>  // Compiles what follows once an instruction set.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace zoe {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using FloatTag = hn::CappedTag<float, kSearchLanes>;
using IntTag = hn::RebindToSigned<FloatTag>;
using Floats = hn::Vec<FloatTag>;

// The union's extent along an axis, from planes of both.
HWY_INLINE Floats extent(Floats lo, Floats hi, const float* other_lo, const float* other_hi) {
    const FloatTag d;
    return hn::Sub(hn::Max(hi, hn::LoadU(d, other_hi)), hn::Min(lo, hn::LoadU(d, other_lo)));
}

// Of as many clusters as there are lanes.
HWY_INLINE void find_some(const ClusterRow& row, uint32_t begin, uint32_t radius, uint32_t* partners) {
    const FloatTag d;
    const IntTag ints;
    const float* planes[6];
    for (int k = 0; k < 6; ++k) planes[k] = row.planes[k] + row.first + begin;
    const Floats lo_x = hn::LoadU(d, planes[0]), hi_x = hn::LoadU(d, planes[1]);
    const Floats lo_y = hn::LoadU(d, planes[2]), hi_y = hn::LoadU(d, planes[3]);
    const Floats lo_z = hn::LoadU(d, planes[4]), hi_z = hn::LoadU(d, planes[5]);
    const Floats infinity = hn::Set(d, std::numeric_limits<float>::infinity());
    const auto places = hn::Iota(ints, static_cast<int32_t>(row.first + begin));
    Floats least = infinity;
    auto ties = hn::Set(ints, std::numeric_limits<int32_t>::max());
    const auto compare = [&](ptrdiff_t step) HWY_ATTR {
        const Floats x = extent(lo_x, hi_x, planes[0] + step, planes[1] + step);
        const Floats y = extent(lo_y, hi_y, planes[2] + step, planes[3] + step);
        const Floats z = extent(lo_z, hi_z, planes[4] + step, planes[5] + step);
        Floats area = hn::Add(hn::Mul(x, hn::Add(y, z)), hn::Mul(y, z));
        area = hn::IfThenElse(hn::Lt(area, infinity), area, infinity);  // NaN, too.
        const auto tie = hn::Xor(places, hn::Add(places, hn::Set(ints, static_cast<int32_t>(step))));
        const auto is_nearer = hn::RebindMask(d, hn::Lt(tie, ties));
        const auto is_better = hn::Or(hn::Lt(area, least), hn::And(hn::Eq(area, least), is_nearer));
        least = hn::Min(least, area);
        ties = hn::IfThenElse(hn::RebindMask(ints, is_better), tie, ties);
    };
    for (ptrdiff_t step = 1; step <= static_cast<ptrdiff_t>(radius); ++step) {
        compare(-step);
        compare(step);
    }
    const auto nobody = hn::Set(ints, -1);
    const auto found = hn::Sub(hn::Xor(places, ties), hn::Set(ints, static_cast<int32_t>(row.first)));
    const auto is_cluster = hn::And(hn::Gt(found, nobody), hn::Lt(found, hn::Set(ints, static_cast<int32_t>(row.count))));
    const auto result = hn::IfThenElse(is_cluster, found, nobody);
    hn::StoreU(hn::BitCast(hn::RebindToUnsigned<FloatTag>(), result), hn::RebindToUnsigned<FloatTag>(), partners);
}

void find_all(const ClusterRow& row, uint32_t begin, uint32_t end, uint32_t radius, uint32_t* partners) {
    for (uint32_t k = begin; k < end; k += static_cast<uint32_t>(hn::Lanes(FloatTag()))) {
        find_some(row, k, radius, partners + (k - begin));
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace zoe
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace zoe {

HWY_EXPORT(find_all);

void find_partners(const ClusterRow& row, uint32_t begin, uint32_t end, uint32_t radius, uint32_t* partners) {
    HWY_DYNAMIC_DISPATCH(find_all)(row, begin, end, radius, partners);
}

}  // namespace zoe

#endif  // HWY_ONCE
