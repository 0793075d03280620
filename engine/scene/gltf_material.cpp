#include "engine/scene/gltf_material.h"

#include <algorithm>
#include <cmath>

namespace zoe {
namespace {

using tinygltf::Value;

constexpr int kClampToEdge = 33071, kMirroredRepeat = 33648, kRepeat = 10497;
constexpr int kNearest = 9728, kLinear = 9729;
constexpr int kNearestMipmapNearest = 9984, kLinearMipmapNearest = 9985, kNearestMipmapLinear = 9986,
              kLinearMipmapLinear = 9987;
constexpr int kUndefined = -1;  // As tinygltf has it.

Wrap wrap_from(int value, Scene& scene) {
    if (value == kClampToEdge) return Wrap::kClamp;
    if (value == kMirroredRepeat) return Wrap::kMirror;
    if (value != kRepeat) scene.warn("an unknown texture wrap mode: repeated");
    return Wrap::kRepeat;
}

/// What is undefined or unknown stays as it is: linear, and levels blended.
void read_filters(const tinygltf::Sampler& sampler, TextureRef& ref, Scene& scene) {
    ref.is_nearest = sampler.magFilter == kNearest;
    bool is_known = ref.is_nearest || sampler.magFilter == kLinear || sampler.magFilter == kUndefined;
    switch (sampler.minFilter) {
        case kNearest:
        case kNearestMipmapNearest:
        case kNearestMipmapLinear:
            ref.is_nearest_minified = true;
            break;
        case kLinear:
        case kLinearMipmapNearest:
        case kLinearMipmapLinear:
        case kUndefined:
            break;
        default:
            is_known = false;
    }
    if (sampler.minFilter == kNearest || sampler.minFilter == kLinear) ref.levels = LevelFilter::kFinest;
    if (sampler.minFilter == kNearestMipmapNearest || sampler.minFilter == kLinearMipmapNearest) {
        ref.levels = LevelFilter::kNearest;
    }
    if (!is_known) scene.warn("an unknown texture filter: linear");
}

glm::vec2 vec2_of(const Value& object, const char* member, const glm::vec2& missing) {
    if (!object.Has(member)) return missing;
    const Value& array = object.Get(member);
    return {static_cast<float>(array.Get(0).GetNumberAsDouble()), static_cast<float>(array.Get(1).GetNumberAsDouble())};
}

/// Scales, then rotates against the clock as seen in the image (v grows downwards), then moves.
glm::mat3 transform_from(const Value& transform) {
    const glm::vec2 offset = vec2_of(transform, "offset", glm::vec2(0.0f));
    const glm::vec2 scale = vec2_of(transform, "scale", glm::vec2(1.0f));
    const double angle = transform.Has("rotation") ? transform.Get("rotation").GetNumberAsDouble() : 0.0;
    const float c = static_cast<float>(std::cos(angle)), s = static_cast<float>(std::sin(angle));
    glm::mat3 m(1.0f);
    m[0] = {c * scale.x, -s * scale.x, 0.0f};
    m[1] = {s * scale.y, c * scale.y, 0.0f};
    m[2] = {offset.x, offset.y, 1.0f};
    return m;
}

/// transform  KHR_texture_transform, or null.
TextureRef texture_from(const GltfFile& file, int texture_index, int uv_set, const Value* transform, Scene& scene) {
    TextureRef ref;
    if (texture_index < 0) return ref;
    const tinygltf::Texture& texture = file.model.textures[static_cast<size_t>(texture_index)];
    if (texture.source < 0) {
        scene.warn("a texture without an image that can be read: left out");
        return ref;
    }
    ref.image = ImageId(texture.source);
    if (transform != nullptr) {
        ref.image_from_uv = transform_from(*transform);
        if (transform->Has("texCoord")) uv_set = transform->Get("texCoord").GetNumberAsInt();
    }
    if (uv_set >= static_cast<int>(kMaxUvSets)) {
        scene.warn(
            fmt::format("a texture that uses texture coordinates beyond TEXCOORD_{}: TEXCOORD_0 is taken", kMaxUvSets - 1));
        uv_set = 0;
    }
    ref.uv_set = static_cast<uint8_t>(uv_set);
    if (texture.sampler >= 0) {
        const tinygltf::Sampler& sampler = file.model.samplers[static_cast<size_t>(texture.sampler)];
        ref.wrap_s = wrap_from(sampler.wrapS, scene);
        ref.wrap_t = wrap_from(sampler.wrapT, scene);
        read_filters(sampler, ref, scene);
    }
    return ref;
}

/// A texture of the core specification.
template <typename Info>
TextureRef texture_from(const GltfFile& file, const Info& info, Scene& scene) {
    const auto transform = info.extensions.find("KHR_texture_transform");
    return texture_from(file, info.index, info.texCoord, transform != info.extensions.end() ? &transform->second : nullptr,
                        scene);
}

/// The members of one material extension; those that are missing, or the whole of it, have the defaults.
class ExtensionReader {
public:
    ExtensionReader(const GltfFile& file, const tinygltf::Material& from, const char* extension, Scene& scene)
        : file_(file), scene_(scene) {
        const auto found = from.extensions.find(extension);
        if (found != from.extensions.end()) value_ = &found->second;
    }
    bool is_there() const { return value_ != nullptr; }

    float number(const char* member, float missing) const {
        return has(member) ? static_cast<float>(value_->Get(member).GetNumberAsDouble()) : missing;
    }
    glm::vec3 color(const char* member, const glm::vec3& missing) const {
        if (!has(member)) return missing;
        const Value& array = value_->Get(member);
        glm::vec3 color;
        for (int i = 0; i < 3; ++i) color[i] = static_cast<float>(array.Get(i).GetNumberAsDouble());
        return color;
    }
    /// scale      of normals; may be null.
    TextureRef texture(const char* member, float* scale = nullptr) const {
        if (!has(member)) return {};
        const Value& info = value_->Get(member);
        const Value* transform = nullptr;
        if (info.Has("extensions") && info.Get("extensions").Has("KHR_texture_transform")) {
            transform = &info.Get("extensions").Get("KHR_texture_transform");
        }
        if (scale != nullptr && info.Has("scale")) *scale = static_cast<float>(info.Get("scale").GetNumberAsDouble());
        const int uv_set = info.Has("texCoord") ? info.Get("texCoord").GetNumberAsInt() : 0;
        return texture_from(file_, info.Get("index").GetNumberAsInt(), uv_set, transform, scene_);
    }

private:
    bool has(const char* member) const { return value_ != nullptr && value_->Has(member); }

    const GltfFile& file_;
    Scene& scene_;
    const Value* value_ = nullptr;
};

void read_base(const GltfFile& file, const tinygltf::Material& from, Material& material, Scene& scene) {
    const tinygltf::PbrMetallicRoughness& pbr = from.pbrMetallicRoughness;
    for (int i = 0; i < 4; ++i) material.base_color[i] = static_cast<float>(pbr.baseColorFactor[static_cast<size_t>(i)]);
    material.base_color_texture = texture_from(file, pbr.baseColorTexture, scene);
    material.metallic = static_cast<float>(pbr.metallicFactor);
    material.roughness = static_cast<float>(pbr.roughnessFactor);
    material.metallic_roughness_texture = texture_from(file, pbr.metallicRoughnessTexture, scene);
    material.normal_texture = texture_from(file, from.normalTexture, scene);
    material.normal_scale = static_cast<float>(from.normalTexture.scale);

    const double strength =
        ExtensionReader(file, from, "KHR_materials_emissive_strength", scene).number("emissiveStrength", 1.0f);
    for (int i = 0; i < 3; ++i) {
        const double factor = from.emissiveFactor[static_cast<size_t>(i)] * strength;
        material.emission[i] = static_cast<float>(std::clamp(factor, 0.0, 1e30));
    }
    material.emission_texture = texture_from(file, from.emissiveTexture, scene);

    if (from.alphaMode == "MASK") material.alpha_mode = AlphaMode::kMask;
    if (from.alphaMode == "BLEND") material.alpha_mode = AlphaMode::kBlend;
    material.alpha_cutoff = static_cast<float>(from.alphaCutoff);
    material.is_double_sided = from.doubleSided;
    material.is_unlit = from.extensions.contains("KHR_materials_unlit");
}

void read_dielectric(const GltfFile& file, const tinygltf::Material& from, Material& material, Scene& scene) {
    material.ior = ExtensionReader(file, from, "KHR_materials_ior", scene).number("ior", 1.5f);
    const ExtensionReader specular(file, from, "KHR_materials_specular", scene);
    material.specular = specular.number("specularFactor", 1.0f);
    material.specular_texture = specular.texture("specularTexture");
    material.specular_color = specular.color("specularColorFactor", glm::vec3(1.0f));
    material.specular_color_texture = specular.texture("specularColorTexture");

    const ExtensionReader transmission(file, from, "KHR_materials_transmission", scene);
    material.transmission = transmission.number("transmissionFactor", 0.0f);
    material.transmission_texture = transmission.texture("transmissionTexture");
    const ExtensionReader volume(file, from, "KHR_materials_volume", scene);
    material.thickness = volume.number("thicknessFactor", 0.0f);
    material.attenuation_color = volume.color("attenuationColor", glm::vec3(1.0f));
    const float infinite = std::numeric_limits<float>::infinity();
    material.attenuation_distance = volume.number("attenuationDistance", infinite);
    if (!(material.attenuation_distance > 0.0f)) {
        scene.warn("a material's attenuationDistance that is not above 0: taken as infinite");
        material.attenuation_distance = infinite;
    }
}

void read_layers(const GltfFile& file, const tinygltf::Material& from, Material& material, Scene& scene) {
    const ExtensionReader coat(file, from, "KHR_materials_clearcoat", scene);
    material.coat = coat.number("clearcoatFactor", 0.0f);
    material.coat_texture = coat.texture("clearcoatTexture");
    material.coat_roughness = coat.number("clearcoatRoughnessFactor", 0.0f);
    material.coat_roughness_texture = coat.texture("clearcoatRoughnessTexture");
    material.coat_normal_texture = coat.texture("clearcoatNormalTexture", &material.coat_normal_scale);
    const ExtensionReader sheen(file, from, "KHR_materials_sheen", scene);
    material.sheen_color = sheen.color("sheenColorFactor", glm::vec3(0.0f));
    material.sheen_color_texture = sheen.texture("sheenColorTexture");
    material.sheen_roughness = sheen.number("sheenRoughnessFactor", 0.0f);
    material.sheen_roughness_texture = sheen.texture("sheenRoughnessTexture");
}

/// Brings the factors that must be in [0, 1] there.
void clamp_factors(Material& material, Scene& scene) {
    bool is_clamped = false;
    const auto clamp = [&](float& value) {
        const float inside = std::clamp(value, 0.0f, 1.0f);
        is_clamped |= inside < value || inside > value;
        value = inside;
    };
    for (float* value : {&material.metallic, &material.roughness, &material.specular, &material.transmission, &material.coat,
                         &material.coat_roughness, &material.sheen_roughness}) {
        clamp(*value);
    }
    for (glm::vec3* color : {&material.attenuation_color, &material.sheen_color}) {
        for (int i = 0; i < 3; ++i) clamp((*color)[i]);
    }
    for (int i = 0; i < 3; ++i) material.specular_color[i] = std::max(material.specular_color[i], 0.0f);
    if (material.ior > 0.0f && material.ior < 1.0f) {
        material.ior = 1.0f;
        is_clamped = true;
    }
    if (is_clamped) scene.warn("a material's factor outside its range: clamped");
}

}  // namespace

std::vector<Material> read_materials(const GltfFile& file, Scene& scene) {
    std::vector<Material> materials;
    for (const tinygltf::Material& from : file.model.materials) {
        Material material;
        material.name = from.name;
        read_base(file, from, material, scene);
        read_dielectric(file, from, material, scene);
        read_layers(file, from, material, scene);
        clamp_factors(material, scene);
        materials.push_back(std::move(material));
    }
    return materials;
}

}  // namespace zoe
