#include <algorithm>
#include <cmath>

#include "engine/render/denoise.h"

namespace zoe {

// A round of the spatial filter, row by row: each neighbour's row is added whole.

namespace {

/// How fast weights fall with the angle between normals: to nothing at 1/8 from parallel, about 29 degrees.
constexpr float kNormalFalloff = 32.0f;
/// Depths that differ by what the slope and this share of them explain are of one surface.
constexpr float kDepthTolerance = 0.002f;
/// Light that differs by this share counts as equal, whatever its noise.
constexpr float kLightTolerance = 0.005f;
constexpr float kLeastLight = 1e-12f, kLeastDepth = 1e-30f;
constexpr float kCentre = 0.25f, kSide = 0.125f, kCorner = 0.0625f;

float brightness(float red, float green, float blue) {
    return 0.2126f * red + 0.7152f * green + 0.0722f * blue;
}

}  // namespace

void Denoiser::RowSums::resize(size_t width) {
    for (std::vector<float>* row : {&red, &green, &blue, &variance, &weight, &less_deep, &less_bright}) row->resize(width);
}

/// Prepares what each pixel of a row compares its neighbours by, adds their rows, and divides.
void Denoiser::smooth_row(size_t row, size_t step, float strength, const Light& from, Light* to, RowSums* sums) const {
    const size_t width = static_cast<size_t>(width_), first = row * width;
    sums->resize(width);
    const size_t above = row > 0 ? first - width : first,
                 below = row + 1 < static_cast<size_t>(height_) ? first + width : first;
    for (size_t x = 0; x < width; ++x) {
        const size_t k = first + x, left = x > 0 ? x - 1 : x, right = x + 1 < width ? x + 1 : x;
        const std::vector<float>& v = from.variance;
        // A single pixel's variance is noisy itself.
        const float corners = v[above + left] + v[above + right] + v[below + left] + v[below + right];
        const float sides = v[above + x] + v[below + x] + v[first + left] + v[first + right];
        const float variance = kCentre * v[k] + kSide * sides + kCorner * corners;
        const float bright = brightness(from.red[k], from.green[k], from.blue[k]);
        sums->less_bright[x] = 1.0f / (strength * std::sqrt(variance) + kLightTolerance * bright + kLeastLight);
        sums->less_deep[x] = 1.0f / (static_cast<float>(step) * shape_.slope[k] * 2.0f +
                                     kDepthTolerance * std::abs(shape_.depth[k]) + kLeastDepth);
        // A pixel is like itself, whatever it shows.
        sums->red[x] = kCentre * from.red[k];
        sums->green[x] = kCentre * from.green[k];
        sums->blue[x] = kCentre * from.blue[k];
        sums->variance[x] = kCentre * kCentre * v[k];
        sums->weight[x] = kCentre;
    }
    for (int down = -1; down <= 1; ++down) {
        for (int across = -1; across <= 1; ++across) {
            if (across != 0 || down != 0) smooth_toward(row, step, across, down, from, sums);
        }
    }
    for (size_t x = 0; x < width; ++x) {
        const float part = 1.0f / sums->weight[x];
        to->red[first + x] = sums->red[x] * part;
        to->green[first + x] = sums->green[x] * part;
        to->blue[first + x] = sums->blue[x] * part;
        to->variance[first + x] = sums->variance[x] * part * part;
    }
}

/// Adds to each pixel of a row the one that is `step` away in a direction, as far as it is alike.
void Denoiser::smooth_toward(size_t row, size_t step, int across, int down, const Light& from, RowSums* sums) const {
    const auto width = static_cast<ptrdiff_t>(width_), height = static_cast<ptrdiff_t>(height_),
               far = static_cast<ptrdiff_t>(step);
    const ptrdiff_t y = static_cast<ptrdiff_t>(row) + down * far;
    if (y < 0 || y >= height) return;
    const ptrdiff_t begin = std::max<ptrdiff_t>(0, -across * far), end = std::min(width, width - across * far);
    const ptrdiff_t here = static_cast<ptrdiff_t>(row) * width, there = y * width + across * far;
    const float kernel = across == 0 || down == 0 ? kSide : kCorner;
    const float *const red = from.red.data(), *const green = from.green.data(), *const blue = from.blue.data(),
                       *const variance = from.variance.data();
    const float *const nx = shape_.x.data(), *const ny = shape_.y.data(), *const nz = shape_.z.data(),
                       *const depth = shape_.depth.data();
    const float *const less_deep = sums->less_deep.data(), *const less_bright = sums->less_bright.data();
    float *__restrict const sum_red = sums->red.data(), *__restrict const sum_green = sums->green.data(),
                            *__restrict const sum_blue = sums->blue.data(),
                            *__restrict const sum_variance = sums->variance.data(),
                            *__restrict const sum_weight = sums->weight.data();
    for (ptrdiff_t x = begin; x < end; ++x) {
        const ptrdiff_t p = here + x, q = there + x;
        const float cosine = nx[p] * nx[q] + ny[p] * ny[q] + nz[p] * nz[q];
        const float turned = kNormalFalloff * std::max(1.0f - cosine, 0.0f);
        const float deeper = std::abs(depth[p] - depth[q]) * less_deep[x];
        const float brighter =
            std::abs(brightness(red[p] - red[q], green[p] - green[q], blue[p] - blue[q])) * less_bright[x];
        // (1 - x / 4)^4: near to exp(-x), and 0 from 4 on.
        const float like = std::max(1.0f - 0.25f * (turned + deeper + brighter), 0.0f);
        const float weight = kernel * (like * like) * (like * like);
        sum_red[x] += weight * red[q];
        sum_green[x] += weight * green[q];
        sum_blue[x] += weight * blue[q];
        sum_variance[x] += weight * weight * variance[q];
        sum_weight[x] += weight;
    }
}

}  // namespace zoe
