#include <algorithm>
#include <cmath>

#include "engine/render/denoise.h"

namespace zoe {

// The mean over frames: what a pixel shows is looked for where it was in the frame before.

namespace {

/// Past depths may differ by this share, and by what a slope makes of two pixels.
constexpr float kDepthTolerance = 0.01f;
/// Light on a surface that turns is another: nothing of the past is left at 1/16 from parallel, about 20 degrees.
constexpr float kTurnFalloff = 16.0f;
/// Less of a past pixel's neighbours than this is too little to go by.
constexpr float kLeastShare = 0.05f;
/// Where fewer frames are known, noise is told by what is around.
constexpr float kEnoughFrames = 4.0f;
/// Around a pixel: 5 x 5 others, so many apart ...
constexpr int kAround = 2, kApart = 2;
/// ... of which those of other nodes count so much, for pixels that have no others.
constexpr float kOtherNode = 1.0f / 32.0f;

float brightness(float red, float green, float blue) {
    return 0.2126f * red + 0.7152f * green + 0.0722f * blue;
}

float mix(float a, float b, float share) {
    return a + share * (b - a);
}

}  // namespace

/// What the frame before knows of a pixel's point; frames 0: nothing.
struct Denoiser::Past {
    float red = 0.0f, green = 0.0f, blue = 0.0f, mean = 0.0f, square = 0.0f, frames = 0.0f;
};

void Denoiser::look_around(size_t row_begin, size_t row_end) {
    const size_t width = static_cast<size_t>(width_);
    for (size_t row = row_begin; row < row_end; ++row) {
        for (std::vector<float>* plane : {&near_.mean, &near_.square, &near_.frames})
            std::fill_n(plane->begin() + static_cast<ptrdiff_t>(row * width), width, 0.0f);
        for (int down = -kAround; down <= kAround; ++down) {
            for (int across = -kAround; across <= kAround; ++across) look_toward(row, across * kApart, down * kApart);
        }
        for (size_t k = row * width; k < (row + 1) * width; ++k) {
            const float part = near_.frames[k] > 0.0f ? 1.0f / near_.frames[k] : 0.0f;
            near_.mean[k] *= part;
            near_.square[k] *= part;
        }
    }
}

/// Adds to the sums of each pixel of a row the sample that is so far away.
void Denoiser::look_toward(size_t row, int across, int down) {
    const ptrdiff_t width = width_, y = static_cast<ptrdiff_t>(row) + down;
    if (y < 0 || y >= height_) return;
    const ptrdiff_t begin = std::max<ptrdiff_t>(0, -across), end = std::min<ptrdiff_t>(width, width - across);
    const ptrdiff_t here = static_cast<ptrdiff_t>(row) * width, there = y * width + across;
    const float *const red = sample_.red.data() + there, *const green = sample_.green.data() + there,
                       *const blue = sample_.blue.data() + there, *const known = known_.data() + there;
    const uint32_t *const other = shape_.node.data() + there, *const node = shape_.node.data() + here;
    float *__restrict const mean = near_.mean.data() + here, *__restrict const square = near_.square.data() + here,
                            *__restrict const count = near_.frames.data() + here;
    for (ptrdiff_t x = begin; x < end; ++x) {
        const float bright = brightness(red[x], green[x], blue[x]);
        const float weight = known[x] * (other[x] == node[x] ? 1.0f : kOtherNode);
        mean[x] += weight * bright;
        square[x] += weight * bright * bright;
        count[x] += weight;
    }
}

Denoiser::Past Denoiser::find_past(size_t k, const Guides& guides) const {
    const float at_x = guides.was_at[k].x - 0.5f, at_y = guides.was_at[k].y - 0.5f;
    const bool is_inside = at_x > -1.0f && at_x < static_cast<float>(width_) && at_y > -1.0f &&
                           at_y < static_cast<float>(height_);  // NaN is not
    if (is_first_ || !is_inside) return {};
    const float left = std::floor(at_x), top = std::floor(at_y);
    const float tolerance = kDepthTolerance * std::abs(guides.was_depth[k]) + 2.0f * shape_.slope[k];
    Past past;
    float share = 0.0f;
    for (int corner = 0; corner < 4; ++corner) {
        const int x = static_cast<int>(left) + (corner & 1), y = static_cast<int>(top) + (corner >> 1);
        if (x < 0 || x >= width_ || y < 0 || y >= height_) continue;
        const size_t q = static_cast<size_t>(y) * static_cast<size_t>(width_) + static_cast<size_t>(x);
        if (past_shape_.node[q] != shape_.node[k] || !(past_moments_.frames[q] > 0.0f)) continue;
        if (!(std::abs(past_shape_.depth[q] - guides.was_depth[k]) <= tolerance)) continue;
        const float cosine =
            past_shape_.x[q] * shape_.x[k] + past_shape_.y[q] * shape_.y[k] + past_shape_.z[q] * shape_.z[k];
        if (!(cosine > 1.0f - 1.0f / kTurnFalloff)) continue;
        const float weight =
            (1.0f - std::abs(at_x - static_cast<float>(x))) * (1.0f - std::abs(at_y - static_cast<float>(y)));
        share += weight;
        past.red += weight * past_light_.red[q];
        past.green += weight * past_light_.green[q];
        past.blue += weight * past_light_.blue[q];
        past.mean += weight * past_moments_.mean[q];
        past.square += weight * past_moments_.square[q];
        past.frames += weight * past_moments_.frames[q] * std::min(1.0f - kTurnFalloff * (1.0f - cosine), 1.0f);
    }
    if (share < kLeastShare || !(past.frames > 0.0f)) return {};
    for (float* number : {&past.red, &past.green, &past.blue, &past.mean, &past.square, &past.frames}) *number /= share;
    return past;
}

/// Joins a pixel's sample with its past, and tells the variance of the mean.
void Denoiser::follow(size_t k, const Guides& guides, const DenoiseConfig& config) {
    const Past past = find_past(k, guides);
    const float around = near_.mean[k], spread = std::max(near_.square[k] - around * around, 0.0f);
    // A sample that says nothing leaves the mean as it was; where nothing is known, what is around stands in.
    const bool is_known = known_[k] > 0.0f;
    const float frames = is_known ? std::min(past.frames + 1.0f, static_cast<float>(config.most_frames)) : past.frames;
    const float share = is_known ? 1.0f / frames : frames > 0.0f ? 0.0f : 1.0f;
    const float bright = is_known ? brightness(sample_.red[k], sample_.green[k], sample_.blue[k]) : around;
    light_.red[k] = mix(past.red, is_known ? sample_.red[k] : around, share);
    light_.green[k] = mix(past.green, is_known ? sample_.green[k] : around, share);
    light_.blue[k] = mix(past.blue, is_known ? sample_.blue[k] : around, share);
    const float mean = mix(past.mean, bright, share), square = mix(past.square, bright * bright, share);
    moments_.mean[k] = mean;
    moments_.square[k] = square;
    moments_.frames[k] = frames;
    const float variance = frames < kEnoughFrames ? spread : std::max(square - mean * mean, 0.0f);
    light_.variance[k] = variance / std::max(frames, 1.0f);
}

}  // namespace zoe
