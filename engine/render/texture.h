#pragma once

#include <span>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "engine/scene/image.h"
#include "engine/scene/material.h"

namespace zoe {

/// An sRGB value as linear light; both in [0, 1].
float linear_from_srgb(float encoded);
/// The same of a byte, by a table.
float linear_from_srgb_byte(uint8_t encoded);

/// The colour of an sRGB image at a texture coordinate: linear light, alpha as stored. (0, 0) is the image's top left
/// corner, texel centres are at (i + 0.5) / size. Colours are decoded before they are blended.
/// uv         before the texture's transform; a coordinate that is not finite counts as 0.
/// Returns    white where there is no texture or its image is missing.
glm::vec4 sample_texture(std::span<const Image> images, const TextureRef& texture, const glm::vec2& uv);

}  // namespace zoe
