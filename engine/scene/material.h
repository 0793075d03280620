#pragma once

#include <cstdint>
#include <string>

#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "engine/scene/ids.h"

namespace zoe {

enum class Wrap : uint8_t { kRepeat, kMirror, kClamp };
enum class AlphaMode : uint8_t { kOpaque, kMask, kBlend };

/// Where a material's value is looked up.
struct TextureRef {
    ImageId image = kNone<ImageId>;
    uint8_t uv_set = 0;  ///< 0 or 1.
    Wrap wrap_s = Wrap::kRepeat, wrap_t = Wrap::kRepeat;
    bool is_nearest = false;        ///< Else bilinear.
    glm::mat3 image_from_uv{1.0f};  ///< KHR_texture_transform, acting on (u, v, 1).
};

/// A glTF material, as far as it is rendered. Colours are linear.
struct Material {
    std::string name;
    glm::vec4 base_color{1.0f};
    TextureRef base_color_texture;  ///< sRGB image.
    glm::vec3 emission{0.0f};       ///< Factor times KHR_materials_emissive_strength.
    TextureRef emission_texture;    ///< sRGB image.
    float metallic = 1.0f, roughness = 1.0f;
    AlphaMode alpha_mode = AlphaMode::kOpaque;
    float alpha_cutoff = 0.5f;
    bool is_double_sided = false;
    bool is_unlit = false;  ///< KHR_materials_unlit.
};

}  // namespace zoe
