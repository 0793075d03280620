#pragma once

#include <span>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "engine/scene/image.h"
#include "engine/scene/material.h"
#include "engine/scene/srgb.h"

namespace zoe {

/// What an image holds.
enum class Texels : uint8_t {
    kColors,   ///< Bytes are sRGB; alpha as stored. In [0, 1].
    kNumbers,  ///< All as stored, in [0, 1].
    kLight,    ///< As colours, but what is stored as halves may be above 1.
};

/// Tells whether a texture has an image with pixels.
bool has_pixels(std::span<const Image> images, const TextureRef& texture);

/// The mean of an image's texels, alpha too, as its coarsest level has it.
/// Returns    white where it has no level of a single texel.
glm::vec4 mean_texel(const Image& image, Texels texels);

/// An image's value at a texture coordinate: linear light, or numbers in [0, 1]. (0, 0) is the image's top left corner,
/// texel centres are at (i + 0.5) / size. Colours are decoded before they are blended.
/// uv         before the texture's transform; a coordinate that is not finite counts as 0.
/// uv_width   of what is looked at, before the transform, about. Where it is wider than a texel, the texture's filter for
///            that picks texels and levels; else, and where it is 0, its other one picks texels of the finest level.
/// Returns    white where there is no texture or its image is missing.
/// Source     Williams. Pyramidal Parametrics. SIGGRAPH 1983.
glm::vec4 sample_texture(std::span<const Image> images, const TextureRef& texture, const glm::vec2& uv,
                         float uv_width = 0.0f, Texels texels = Texels::kColors);

}  // namespace zoe
