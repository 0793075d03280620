#include "engine/scene/gltf_material.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <span>
#include <stdexcept>

#include "engine/scene/gltf_uri.h"

namespace zoe {
namespace {

constexpr uint64_t kMaxImageBytes = uint64_t{1} << 30;
constexpr int kNearestFilter = 9728, kClampToEdge = 33071, kMirroredRepeat = 33648, kRepeat = 10497;

Wrap wrap_from(int value, Scene& scene) {
    if (value == kClampToEdge) return Wrap::kClamp;
    if (value == kMirroredRepeat) return Wrap::kMirror;
    if (value != kRepeat) scene.warn("an unknown texture wrap mode: repeated");
    return Wrap::kRepeat;
}

glm::vec2 vec2_of(const tinygltf::Value& object, const char* member, const glm::vec2& missing) {
    if (!object.Has(member)) return missing;
    const tinygltf::Value& array = object.Get(member);
    return {static_cast<float>(array.Get(0).GetNumberAsDouble()), static_cast<float>(array.Get(1).GetNumberAsDouble())};
}

/// Scales, then rotates against the clock as seen in the image (v grows downwards), then moves.
glm::mat3 transform_from(const tinygltf::Value& transform) {
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

TextureRef texture_from(const GltfFile& file, const tinygltf::TextureInfo& info, Scene& scene) {
    TextureRef ref;
    if (info.index < 0) return ref;
    const tinygltf::Texture& texture = file.model.textures[static_cast<size_t>(info.index)];
    if (texture.source < 0) {
        scene.warn("a texture without an image that can be read: left out");
        return ref;
    }
    ref.image = ImageId(texture.source);
    int uv_set = info.texCoord;
    const auto transform = info.extensions.find("KHR_texture_transform");
    if (transform != info.extensions.end()) {
        ref.image_from_uv = transform_from(transform->second);
        if (transform->second.Has("texCoord")) uv_set = transform->second.Get("texCoord").GetNumberAsInt();
    }
    if (uv_set > 1) {
        scene.warn("a texture that uses texture coordinates beyond TEXCOORD_1: TEXCOORD_0 is taken");
        uv_set = 0;
    }
    ref.uv_set = static_cast<uint8_t>(uv_set);
    if (texture.sampler >= 0) {
        const tinygltf::Sampler& sampler = file.model.samplers[static_cast<size_t>(texture.sampler)];
        ref.wrap_s = wrap_from(sampler.wrapS, scene);
        ref.wrap_t = wrap_from(sampler.wrapT, scene);
        ref.is_nearest = sampler.magFilter == kNearestFilter;
    }
    return ref;
}

std::vector<std::byte> encoded_bytes(const GltfFile& file, const GltfImage& image) {
    if (image.view >= 0) {
        const GltfView& view = file.views[static_cast<size_t>(image.view)];
        const std::span<const std::byte> bytes = file.buffer(view.buffer).subspan(view.offset, view.length);
        return {bytes.begin(), bytes.end()};
    }
    if (image.uri.empty()) throw std::runtime_error("it has neither a uri nor a bufferView");
    return read_uri(image.uri, file.folder, kMaxImageBytes);
}

/// Equal for images whose encoded bytes are the same ones.
/// Throws     std::runtime_error with the reason why there are none.
std::string source_of(const GltfFile& file, const GltfImage& image) {
    if (image.view >= 0) {
        const GltfView& view = file.views[static_cast<size_t>(image.view)];
        return fmt::format("view {} {} {}", file.buffers[view.buffer].content, view.offset, view.length);
    }
    if (image.uri.empty() || image.uri.starts_with("data:")) return image.uri;
    return find_uri_file(image.uri, file.folder).string();
}

/// An image that has been decoded, or the reason why not.
struct Decoded {
    size_t image = 0;
    std::string error;
};

/// Fills an image's pixels, while some are left.
/// images     the ones before it.
/// decoded    by source_of.
/// Returns    the reason why it has none; empty where all is well.
/// Throws     std::runtime_error with the reason, too.
std::string read_pixels(const GltfFile& file, const GltfImage& from, const std::vector<Image>& images,
                        std::map<std::string, Decoded>& decoded, uint64_t& pixels_left, Image& image) {
    const auto [found, is_new] = decoded.try_emplace(source_of(file, from), Decoded{images.size(), {}});
    std::string& error = found->second.error;
    if (is_new) {
        try {
            decode_image(encoded_bytes(file, from), &image, &error, pixels_left);
        } catch (const std::runtime_error& exception) {
            error = exception.what();
        }
    } else if (error.empty()) {
        const Image& same = images[found->second.image];
        if (same.pixels.size() / 4 > pixels_left) return too_many_pixels(same.width, same.height, pixels_left);
        image.width = same.width;
        image.height = same.height;
        image.pixels = same.pixels;
    }
    pixels_left -= image.pixels.size() / 4;
    return error;
}

}  // namespace

std::vector<Material> read_materials(const GltfFile& file, Scene& scene) {
    std::vector<Material> materials;
    for (const tinygltf::Material& from : file.model.materials) {
        Material material;
        material.name = from.name;
        const tinygltf::PbrMetallicRoughness& pbr = from.pbrMetallicRoughness;
        for (int i = 0; i < 4; ++i) material.base_color[i] = static_cast<float>(pbr.baseColorFactor[static_cast<size_t>(i)]);
        material.base_color_texture = texture_from(file, pbr.baseColorTexture, scene);
        material.metallic = static_cast<float>(pbr.metallicFactor);
        material.roughness = static_cast<float>(pbr.roughnessFactor);

        double strength = 1.0;
        const auto emissive = from.extensions.find("KHR_materials_emissive_strength");
        if (emissive != from.extensions.end() && emissive->second.Has("emissiveStrength")) {
            strength = emissive->second.Get("emissiveStrength").GetNumberAsDouble();
        }
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
        materials.push_back(std::move(material));
    }
    return materials;
}

std::vector<Image> read_images(const GltfFile& file, const GltfOptions& options, Scene& scene) {
    std::vector<bool> is_shown(file.images.size(), false);
    for (const Material& material : scene.materials) {
        for (const TextureRef* ref : {&material.base_color_texture, &material.emission_texture}) {
            if (ref->image != kNone<ImageId>) is_shown[index(ref->image)] = true;
        }
    }
    uint64_t pixels_left = options.max_pixels;
    std::map<std::string, Decoded> decoded;
    std::vector<Image> images;
    for (size_t i = 0; i < file.images.size(); ++i) {
        const GltfImage& from = file.images[i];
        Image image;
        image.name = !from.name.empty() ? from.name : from.uri.starts_with("data:") ? std::string() : from.uri;
        if (options.load_images && is_shown[i]) {
            std::string error;
            try {
                error = read_pixels(file, from, images, decoded, pixels_left, image);
            } catch (const std::runtime_error& exception) {
                error = exception.what();
            }
            if (!error.empty()) {
                const std::string what = from.view >= 0 ? "" : " (" + shown(from.uri) + ")";
                scene.warn(fmt::format("/images/{}{}: {}: not shown", i, what, error));
            }
        }
        images.push_back(std::move(image));
    }
    return images;
}

}  // namespace zoe
