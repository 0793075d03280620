#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "engine/scene/check_surface.h"
#include "engine/scene/scene.h"

namespace zoe {
namespace {

// Each check returns the first broken invariant in words, or nothing.

template <typename Id>
bool is_valid(Id id, size_t count) {
    return id == kNone<Id> || index(id) < count;
}

template <typename T>
bool all_finite(const std::vector<T>& values) {
    return std::all_of(values.begin(), values.end(), [](T value) { return std::isfinite(value); });
}

std::string check_ranges(const Mesh& mesh, size_t material_count) {
    uint32_t at = 0;
    for (const MaterialRange& range : mesh.materials) {
        if (range.begin != at || range.end < range.begin) return "its material ranges have gaps or overlap";
        if (!is_valid(range.material, material_count)) return fmt::format("there is no material {}", index(range.material));
        at = range.end;
    }
    if (!mesh.materials.empty() && at != mesh.corners.size()) return "its material ranges do not cover its triangles";
    return {};
}

std::string check_mesh(const Mesh& mesh, const Scene& scene) {
    const size_t count = mesh.positions.size();
    const auto fits = [&](size_t size) { return size == 0 || size == count; };
    if (count > 0xfffffff0u || mesh.corners.size() > 0x7ffffff0u) return "it has more than 2^32 vertices or 2^31 triangles";
    if (!fits(mesh.normals.size())) return "its normals are not as many as its vertices";
    if (mesh.tangent_corners.empty() && !fits(mesh.tangents.size())) return "its tangents are not as many as its vertices";
    if (!mesh.tangent_corners.empty() && mesh.tangent_corners.size() != mesh.corners.size()) {
        return "its tangent_corners are not as many as its triangles";
    }
    for (const glm::uvec3& c : mesh.tangent_corners) {
        if (std::max({c.x, c.y, c.z}) >= mesh.tangents.size()) return "a triangle names a tangent that is not there";
    }
    for (const std::vector<glm::vec2>& uvs : mesh.uvs) {
        if (!fits(uvs.size())) return "its uvs are not as many as its vertices";
    }
    if (!fits(mesh.colors.size())) return "its colours are not as many as its vertices";
    for (const glm::uvec3& c : mesh.corners) {
        if (std::max({c.x, c.y, c.z}) >= count) return fmt::format("a triangle names a vertex that is not below {}", count);
    }
    for (const MorphTarget& target : mesh.targets) {
        if (!fits(target.positions.size()) || !fits(target.normals.size())) {
            return "a morph target's offsets are not as many as its vertices";
        }
    }
    if (mesh.default_weights.size() != mesh.targets.size()) return "its weights are not as many as its morph targets";
    if (!all_finite(mesh.default_weights)) return "a weight is not finite";
    const SkinBinding& binding = mesh.binding;
    const size_t influences = binding.influence_count * count;
    if (binding.joints.size() != influences || binding.weights.size() != influences) {
        return "its joints or weights are not influence_count a vertex";
    }
    if (!all_finite(binding.weights)) return "a joint weight is not finite";
    if (mesh.surface) {
        if (std::string broken = check_surface(mesh); !broken.empty()) return broken;
    }
    return check_ranges(mesh, scene.materials.size());
}

std::string check_skin(const Skin& skin, const Scene& scene) {
    if (skin.joints.empty()) return "it has no joints";
    if (skin.joint_from_mesh.size() != skin.joints.size()) return "its matrices are not as many as its joints";
    for (const NodeId joint : skin.joints) {
        if (index(joint) >= scene.nodes.size()) return fmt::format("there is no node {}", index(joint));
    }
    for (const Affine& matrix : skin.joint_from_mesh) {
        if (!is_finite(matrix)) return "a matrix is not finite";
    }
    return {};
}

std::string check_node(const Node& node, const Scene& scene, const std::vector<uint32_t>& joint_end) {
    if (!is_valid(node.mesh, scene.meshes.size())) return fmt::format("there is no mesh {}", index(node.mesh));
    if (!is_valid(node.skin, scene.skins.size())) return fmt::format("there is no skin {}", index(node.skin));
    if (!is_valid(node.camera, scene.cameras.size())) return fmt::format("there is no camera {}", index(node.camera));
    if (!is_valid(node.light, scene.lights.size())) return fmt::format("there is no light {}", index(node.light));
    const glm::quat& q = node.local.rotation;
    const float length2 = q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w;
    if (!(std::fabs(length2 - 1.0f) < 1e-3f)) return "its rotation's length is not 1";
    if (!is_finite(node.local.translation) || !is_finite(node.local.scale)) return "its transform is not finite";
    if (node.matrix && !is_finite(*node.matrix)) return "its matrix is not finite";
    if (!all_finite(node.weights)) return "a weight is not finite";
    const size_t target_count = node.mesh == kNone<MeshId> ? 0 : scene[node.mesh].targets.size();
    const bool is_written = node.mesh != kNone<MeshId> && scene[node.mesh].version > 0;  // Dropped its targets.
    if (!node.weights.empty() && node.weights.size() != target_count && !is_written) {
        return fmt::format("{} weights, where its mesh has {} morph targets", node.weights.size(), target_count);
    }
    if (node.skin != kNone<SkinId>) {
        if (node.mesh == kNone<MeshId>) return "it has a skin, but no mesh";
        const size_t joint_count = scene.skins[index(node.skin)].joints.size();
        if (joint_end[index(node.mesh)] > joint_count) {
            return fmt::format("its mesh names joint {}, but its skin has {}", joint_end[index(node.mesh)] - 1, joint_count);
        }
    }
    if (node.sequence) {
        if (node.sequence->meshes.empty()) return "its mesh sequence is empty";
        if (!(node.sequence->fps > 0.0 && std::isfinite(node.sequence->fps)))
            return "its mesh sequence's fps is not above 0";
        for (const MeshId mesh : node.sequence->meshes) {
            if (index(mesh) >= scene.meshes.size()) return fmt::format("its mesh sequence names mesh {}", index(mesh));
        }
    }
    return {};
}

std::string check_sampler(const Sampler& sampler) {
    if (sampler.times_s.empty()) return "it has no keys";
    if (!all_finite(sampler.times_s) || !std::is_sorted(sampler.times_s.begin(), sampler.times_s.end())) {
        return "its times are not ascending and finite";
    }
    const size_t per_key = sampler.width * (sampler.interpolation == Interpolation::kCubicSpline ? size_t{3} : size_t{1});
    if (sampler.width == 0 || sampler.values.size() != sampler.times_s.size() * per_key) {
        return fmt::format("{} values for {} keys of {}", sampler.values.size(), sampler.times_s.size(), per_key);
    }
    if (sampler.is_rotation && sampler.width != 4) return "a rotation needs 4 numbers";
    if (!all_finite(sampler.values)) return "a value is not finite";
    return {};
}

std::string check_channel(const AnimationChannel& channel, const Clip& clip, const Scene& scene) {
    if (index(channel.node) >= scene.nodes.size()) return fmt::format("there is no node {}", index(channel.node));
    if (channel.sampler >= clip.samplers.size()) return fmt::format("there is no sampler {}", channel.sampler);
    const Node& node = scene[channel.node];
    const Sampler& sampler = clip.samplers[channel.sampler];
    if (sampler.is_rotation != (channel.path == ChannelPath::kRotation)) return "its sampler is for another kind of value";
    size_t width = 3;
    if (channel.path == ChannelPath::kRotation) width = 4;
    if (channel.path == ChannelPath::kWeights) width = node.mesh == kNone<MeshId> ? 0 : scene[node.mesh].targets.size();
    const bool is_written = node.mesh != kNone<MeshId> && scene[node.mesh].version > 0;  // Dropped its targets.
    if (sampler.width != width && !(channel.path == ChannelPath::kWeights && is_written))
        return fmt::format("its sampler has {} numbers a value; {} are needed", sampler.width, width);
    if (channel.path != ChannelPath::kWeights && node.matrix) return "it animates a node that has a matrix";
    return {};
}

std::string check_clip(const Clip& clip, const Scene& scene) {
    for (size_t i = 0; i < clip.samplers.size(); ++i) {
        const std::string broken = check_sampler(clip.samplers[i]);
        if (!broken.empty()) return fmt::format("sampler {}: {}", i, broken);
    }
    for (size_t i = 0; i < clip.channels.size(); ++i) {
        const std::string broken = check_channel(clip.channels[i], clip, scene);
        if (!broken.empty()) return fmt::format("channel {}: {}", i, broken);
    }
    if (!std::isfinite(clip.duration_s)) return "its duration is not finite";
    return {};
}

std::string check_material(const Material& material, const Scene& scene) {
    for (const TextureRef* ref : textures_of(material)) {
        if (!is_valid(ref->image, scene.images.size())) return fmt::format("there is no image {}", index(ref->image));
        if (ref->uv_set >= kMaxUvSets) return fmt::format("a texture's uv_set is not below {}", kMaxUvSets);
    }
    return {};
}

std::string check_image(const Image& image, const Scene&) {
    const auto is_whole = [&](const auto& level) {
        const size_t row_bytes = image.texel_bytes() * static_cast<size_t>(level.width);
        return level.width > 0 && level.height > 0 && level.pixels.size() == row_bytes * static_cast<size_t>(level.height);
    };
    if (!image.pixels.empty() && !is_whole(image)) return "its pixels are not texel_bytes * width * height";
    if (!std::all_of(image.coarser.begin(), image.coarser.end(), is_whole))
        return "a level's pixels are not texel_bytes * width * height";
    return {};
}

template <typename T, typename Check>
std::string check_all(const std::vector<T>& things, const char* what, Check&& check) {
    for (size_t i = 0; i < things.size(); ++i) {
        const std::string broken = check(things[i]);
        if (!broken.empty()) return fmt::format("{} {}: {}", what, i, broken);
    }
    return {};
}

}  // namespace

std::string check(const Scene& scene) {
    constexpr size_t kMostNodes = size_t{1} << 30;  // Rays know nodes by 30 bits.
    if (scene.nodes.size() > kMostNodes) return "more than 2^30 nodes";
    std::string broken = check_all(scene.images, "image", [&](const Image& i) { return check_image(i, scene); });
    if (broken.empty())
        broken = check_all(scene.materials, "material", [&](const auto& m) { return check_material(m, scene); });
    if (broken.empty()) broken = check_all(scene.meshes, "mesh", [&](const auto& m) { return check_mesh(m, scene); });
    if (broken.empty()) broken = check_all(scene.skins, "skin", [&](const auto& s) { return check_skin(s, scene); });
    if (!broken.empty()) return broken;

    std::vector<uint32_t> joint_end(scene.meshes.size(), 0);
    for (size_t i = 0; i < scene.meshes.size(); ++i) {
        for (const uint16_t joint : scene.meshes[i].binding.joints) joint_end[i] = std::max(joint_end[i], joint + 1u);
    }
    broken = check_all(scene.nodes, "node", [&](const auto& n) { return check_node(n, scene, joint_end); });
    if (broken.empty()) broken = check_surface_size(scene);
    if (broken.empty()) broken = check_all(scene.clips, "clip", [&](const auto& c) { return check_clip(c, scene); });
    if (!broken.empty()) return broken;
    for (const ClipId clip : scene.playback.clips) {
        if (index(clip) >= scene.clips.size()) return fmt::format("playback: there is no clip {}", index(clip));
    }
    try {
        scene.parents_first();
    } catch (const SceneError& error) {
        return error.what();
    }
    return {};
}

}  // namespace zoe
