#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <glm/vec4.hpp>

#include "engine/render/guides.h"

namespace zoe {

/// How a number a pixel is laid out: rows, top first, with room around them, so that vectors may begin before a row and end
/// behind it.
struct DenoiseGrid {
    static constexpr size_t kMargin = 16;  ///< Columns on both sides: a vector's. Rows: one above and one below.
    size_t width = 0, height = 0;

    size_t stride() const { return (width + kMargin - 1) / kMargin * kMargin + 2 * kMargin; }
    size_t count() const { return (height + 2) * stride(); }
    /// Of a row's first pixel; row -1 is above the picture.
    ptrdiff_t first(ptrdiff_t row) const { return (row + 1) * static_cast<ptrdiff_t>(stride()) + ptrdiff_t{kMargin}; }
};

/// Light, and the variance of its luminance; 0 around the picture. Variances are the edge's there.
struct DenoiseLight {
    std::vector<float> red, green, blue, variance;
};

/// What a pixel shows.
struct DenoiseShape {
    std::vector<float> x, y, z;       ///< Normal.
    std::vector<float> depth, slope;  ///< Metres, infinite around the picture; metres a pixel.
    std::vector<uint32_t> node;
};

/// Of a pixel's luminance.
struct DenoiseMoments {
    std::vector<float> mean, square;
    std::vector<float> frames;  ///< How many were counted; 0 around the picture.
};

/// A frame on its way through the filter.
struct DenoiseFrame {
    DenoiseGrid grid;
    DenoiseLight sample;            ///< Of this frame; 0 where nothing is known.
    std::vector<float> brightness;  ///< Of the sample.
    std::vector<float> known;       ///< 1 where the sample is finite, and of a surface; else 0.
    DenoiseLight light, past_light;
    DenoiseShape shape, past_shape;
    DenoiseMoments moments, past_moments;
    bool has_past = false;

    /// Makes room, and forgets all.
    void resize(size_t width, size_t height);
};

/// Rows [begin, end) of a pass, with the best instruction set that the processor has. Each pass needs all rows of the one
/// before.

/// From what was rendered to `sample`, `brightness`, `known` and `shape`, but for slopes.
/// scale      1 / samples.
void take_in_rows(const Guides& guides, const glm::vec4* sums, float scale, DenoiseFrame* frame, size_t begin, size_t end);

/// From the sample and the past to slopes, `light` and `moments`.
void follow_rows(const Guides& guides, float most_frames, DenoiseFrame* frame, size_t begin, size_t end);

/// A round of smoothing by pixels `step` apart.
void smooth_rows(const DenoiseGrid& grid, const DenoiseShape& shape, const DenoiseLight& from, size_t step, float strength,
                 DenoiseLight* to, size_t begin, size_t end);

/// From light to radiance.
/// scale      samples.
void put_out_rows(const DenoiseGrid& grid, const Guides& guides, const DenoiseLight& light, float scale, glm::vec4* sums,
                  size_t begin, size_t end);

}  // namespace zoe
