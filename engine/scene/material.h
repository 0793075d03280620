#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>

#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "engine/scene/ids.h"

namespace zoe {

enum class Wrap : uint8_t { kRepeat, kMirror, kClamp };
enum class AlphaMode : uint8_t { kOpaque, kMask, kBlend };

/// Which levels of an image are looked up where its texels are narrower than what is looked at.
enum class LevelFilter : uint8_t {
    kFinest,   ///< The image itself, as if it had no others.
    kNearest,  ///< The one whose texels are nearest to as wide.
    kBlended,  ///< The two next to that, blended.
};

/// Where a material's value is looked up.
struct TextureRef {
    ImageId image = kNone<ImageId>;
    uint8_t uv_set = 0;  ///< Which of the mesh's texture coordinates: below kMaxUvSets.
    Wrap wrap_s = Wrap::kRepeat, wrap_t = Wrap::kRepeat;
    bool is_nearest = false;  ///< Where texels are as wide as what is looked at, or wider: the nearest; else bilinear.
    bool is_nearest_minified = false;  ///< The same where they are narrower, in each level that is looked up.
    LevelFilter levels = LevelFilter::kBlended;
    glm::mat3 image_from_uv{1.0f};  ///< KHR_texture_transform, acting on (u, v, 1).

    bool operator==(const TextureRef&) const = default;
};

/// A glTF material. Colours are linear; a texture multiplies the factor before it, by the channels that are named.
struct Material {
    std::string name;
    glm::vec4 base_color{1.0f};
    TextureRef base_color_texture;  ///< sRGB, and alpha.
    glm::vec3 emission{0.0f};       ///< Factor times KHR_materials_emissive_strength.
    TextureRef emission_texture;    ///< sRGB.
    float metallic = 1.0f, roughness = 1.0f;
    TextureRef metallic_roughness_texture;  ///< Blue: metallic; green: roughness.
    TextureRef normal_texture;              ///< In tangent space, 0.5 for 0.
    float normal_scale = 1.0f;              ///< Times x and y of the texture's normals.
    AlphaMode alpha_mode = AlphaMode::kOpaque;
    float alpha_cutoff = 0.5f;
    bool is_double_sided = false;
    bool is_unlit = false;  ///< KHR_materials_unlit.

    float ior = 1.5f;                   ///< KHR_materials_ior; 0: infinite.
    float specular = 1.0f;              ///< KHR_materials_specular: strength of a dielectric's reflection.
    TextureRef specular_texture;        ///< Alpha.
    glm::vec3 specular_color{1.0f};     ///< ... and its colour, where light arrives straight.
    TextureRef specular_color_texture;  ///< sRGB.

    float transmission = 0.0f;          ///< KHR_materials_transmission: what is not diffuse but passes.
    TextureRef transmission_texture;    ///< Red.
    float thickness = 0.0f;             ///< KHR_materials_volume; 0: a thin sheet. Rays find how thick a body is.
    glm::vec3 attenuation_color{1.0f};  ///< What is left of white light ...
    float attenuation_distance = std::numeric_limits<float>::infinity();  ///< ... after so many metres.

    float coat = 0.0f;        ///< KHR_materials_clearcoat.
    TextureRef coat_texture;  ///< Red.
    float coat_roughness = 0.0f;
    TextureRef coat_roughness_texture;  ///< Green.
    TextureRef coat_normal_texture;
    float coat_normal_scale = 1.0f;

    glm::vec3 sheen_color{0.0f};     ///< KHR_materials_sheen.
    TextureRef sheen_color_texture;  ///< sRGB.
    float sheen_roughness = 0.0f;
    TextureRef sheen_roughness_texture;  ///< Alpha.

    bool operator==(const Material&) const = default;
};

/// All textures of a material: first those of colours, which are encoded as sRGB, then those of numbers.
inline constexpr size_t kColorTextureCount = 4;
template <typename M>
auto textures_of(M& m) {
    return std::array{&m.base_color_texture,     &m.emission_texture,     &m.specular_color_texture,
                      &m.sheen_color_texture,    &m.normal_texture,       &m.metallic_roughness_texture,
                      &m.specular_texture,       &m.transmission_texture, &m.coat_texture,
                      &m.coat_roughness_texture, &m.coat_normal_texture,  &m.sheen_roughness_texture};
}

}  // namespace zoe
