#include "engine/deform/skin_kernels.h"

#include <algorithm>
#include <cmath>

#include "engine/math/simd_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "engine/deform/skin_kernels.cpp"
#include <hwy/foreach_target.h>  // Compiles what follows once an instruction set.
#include <hwy/highway.h>

// In this order, each of which reads those before it:
#include "engine/deform/vectors.inl"

#include "engine/deform/quads.inl"

#include "engine/deform/skin_group.inl"

#include "engine/deform/skin_linear.inl"

#include "engine/deform/skin_dual.inl"

HWY_BEFORE_NAMESPACE();
namespace zoe {
namespace HWY_NAMESPACE {

void skin_linear_range(const SkinWork& work, size_t begin, size_t end) {
    QuadMemory memory;
    for (size_t first = begin; first < end; first += kChunk) {
        move_linear(work, first, std::min(kChunk, end - first), &memory);
    }
}

void skin_dual_range(const SkinWork& work, size_t begin, size_t end) {
    QuadMemory rows;
    DualMemory duals;
    for (size_t first = begin; first < end; first += kChunk) {
        move_dual(work, first, std::min(kChunk, end - first), &rows, &duals);
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace zoe
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace zoe {

HWY_EXPORT(skin_linear_range);
HWY_EXPORT(skin_dual_range);

void skin_linear(const SkinWork& work, size_t begin, size_t end) {
    HWY_DYNAMIC_DISPATCH(skin_linear_range)(work, begin, end);
}

void skin_dual(const SkinWork& work, size_t begin, size_t end) {
    HWY_DYNAMIC_DISPATCH(skin_dual_range)(work, begin, end);
}

}  // namespace zoe

#endif  // HWY_ONCE
