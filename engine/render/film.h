#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <glm/vec4.hpp>

#include "engine/render/tone_map.h"
#include "engine/scene/image.h"

namespace zoe {

/// A picture in the making. All arrays [height * width], top row first. Depth, node and primitive are layers of geometry:
/// the closest hit of the ray through the pixel's centre, whichever side it meets and however transparent the material is.
struct Film {
    int width = 0, height = 0;
    int sample_count = 0;        ///< Samples so far of each pixel that had not enough before.
    std::vector<glm::vec4> sum;  ///< Linear radiance, sky included, and coverage: 1 where a surface was seen. Over samples.
    std::vector<float> depth;    ///< Metres along the camera's axis; +infinity on a miss.
    std::vector<uint32_t> node, primitive;  ///< 0xffffffff on a miss.
    std::vector<uint32_t> enough;           ///< Samples after which a pixel gets no more; empty: all get the same.

    Film() = default;
    Film(int width, int height);
    /// Back to no samples.
    void clear();
    glm::vec4 pixel(int x, int y) const;  ///< Mean of the samples.
    uint32_t samples_of(size_t pixel) const {
        const uint32_t count = static_cast<uint32_t>(sample_count);
        return enough.empty() || enough[pixel] > count ? count : enough[pixel];
    }
    /// What a pixel's sum is to be multiplied with: 1 / samples; 0 where there are none.
    float share_of(size_t pixel) const {
        const uint32_t count = samples_of(pixel);
        return count > 0 ? 1.0f / static_cast<float>(count) : 0.0f;
    }
};

/// 8 bits a channel, tone mapped and sRGB encoded; [height * width * 4]. Opaque: the sky is part of the picture.
std::vector<uint8_t> to_rgba8(const Film& film, const Grade& grade = {});

struct Layers;

struct PictureOptions {
    Grade grade;                     ///< Of a .png; an .exr holds radiance as it is.
    const Layers* layers = nullptr;  ///< Of the same size, for an .exr; null: none.
    PictureNotes notes;              ///< Kept in the file.
};

/// Writes a film by the file's extension: .png as `to_rgba8`, or .exr with the layers R G B A, depth.Z, node.id,
/// primitive.id, sampleCount, and where there are layers, albedo, normal and backward (motion). To a temporary name, then
/// renamed.
/// Throws     std::runtime_error with the file's name and the reason.
void write_film(const Film& film, const std::filesystem::path& file, const PictureOptions& options = {});

}  // namespace zoe
