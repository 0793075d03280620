#include <algorithm>
#include <limits>

#include "engine/math/simd_targets.h"
#include "engine/render/denoise_planes.h"
#include "engine/render/luminance.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "engine/render/denoise_kernels.cpp"
#include <hwy/foreach_target.h>  // Compiles what follows once an instruction set.
#include <hwy/highway.h>

// In this order, each of which reads the one before it:
#include "engine/deform/vectors.inl"

#include "engine/render/denoise_border.inl"

#include "engine/render/denoise_history.inl"

#include "engine/render/denoise_smooth.inl"

#if HWY_ONCE

namespace zoe {

HWY_EXPORT(take_in_range);
HWY_EXPORT(follow_range);
HWY_EXPORT(smooth_range);
HWY_EXPORT(put_out_range);

void take_in_rows(const Guides& guides, const glm::vec4* sums, float scale, DenoiseFrame* frame, size_t begin, size_t end) {
    HWY_DYNAMIC_DISPATCH(take_in_range)(guides, sums, scale, frame, begin, end);
}

void follow_rows(const Guides& guides, float most_frames, DenoiseFrame* frame, size_t begin, size_t end) {
    HWY_DYNAMIC_DISPATCH(follow_range)(guides, most_frames, frame, begin, end);
}

void smooth_rows(const DenoiseGrid& grid, const DenoiseShape& shape, const DenoiseLight& from, size_t step, float strength,
                 DenoiseLight* to, size_t begin, size_t end) {
    HWY_DYNAMIC_DISPATCH(smooth_range)(grid, shape, from, step, strength, to, begin, end);
}

void put_out_rows(const DenoiseGrid& grid, const Guides& guides, const DenoiseLight& light, float scale, glm::vec4* sums,
                  size_t begin, size_t end) {
    HWY_DYNAMIC_DISPATCH(put_out_range)(grid, guides, light, scale, sums, begin, end);
}

}  // namespace zoe

#endif  // HWY_ONCE
