#include "engine/scene/sequence.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <optional>

#include <fmt/format.h>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include "engine/deform/morph.h"
#include "engine/deform/skin.h"

namespace zoe {
namespace {

namespace fs = std::filesystem;

/// "wave_%04d.glb" taken apart. A number has at least `digit_count` digits, and more only where it needs them.
struct Pattern {
    std::string prefix, suffix;
    size_t digit_count = 1;
};

std::optional<Pattern> parse_pattern(const std::string& name) {
    const size_t percent = name.find('%');
    if (percent == std::string::npos || name.find('%', percent + 1) != std::string::npos) return std::nullopt;
    size_t at = percent + 1;
    const bool is_padded = at < name.size() && name[at] == '0';
    size_t width = 0;
    for (; at < name.size() && name[at] >= '0' && name[at] <= '9' && width < 20; ++at) {
        width = width * 10 + static_cast<size_t>(name[at] - '0');
    }
    if (at >= name.size() || name[at] != 'd' || width > 18 || (width > 0 && !is_padded)) return std::nullopt;
    return Pattern{name.substr(0, percent), name.substr(at + 1), std::max<size_t>(width, 1)};
}

/// The number in a file's name; none where it does not match.
std::optional<uint64_t> number_in(const std::string& name, const Pattern& pattern) {
    if (!name.starts_with(pattern.prefix) || !name.ends_with(pattern.suffix)) return std::nullopt;
    if (name.size() < pattern.prefix.size() + pattern.suffix.size()) return std::nullopt;
    const std::string digits =
        name.substr(pattern.prefix.size(), name.size() - pattern.prefix.size() - pattern.suffix.size());
    if (digits.size() < pattern.digit_count || digits.size() > 18) return std::nullopt;
    if (!std::all_of(digits.begin(), digits.end(), [](char c) { return c >= '0' && c <= '9'; })) return std::nullopt;
    if (digits.size() > pattern.digit_count && digits[0] == '0') return std::nullopt;
    return std::stoull(digits);
}

std::map<uint64_t, fs::path> find_files(const std::string& pattern) {
    const fs::path path(pattern);
    const std::optional<Pattern> parsed = parse_pattern(path.filename().string());
    if (!parsed) throw SceneError(pattern, "", "the file's name must hold one number such as %04d");
    const fs::path folder = path.parent_path().empty() ? fs::path(".") : path.parent_path();
    std::error_code error;
    std::map<uint64_t, fs::path> files;
    for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
        const std::string name = it->path().filename().string();
        const std::optional<uint64_t> number = number_in(name, *parsed);
        if (number) files[*number] = path.parent_path() / name;
    }
    if (error) throw SceneError(pattern, "", folder.string() + ": " + error.message());
    if (files.empty()) throw SceneError(pattern, "", "no file matches");
    const uint64_t first = files.begin()->first;
    uint64_t expected = first;
    for (const auto& [number, unused] : files) {
        if (number != expected) throw SceneError(pattern, "", fmt::format("number {} is missing", expected));
        ++expected;
    }
    return files;
}

std::vector<Affine> world_matrices(const Scene& scene) {
    std::vector<Affine> world(scene.nodes.size());
    for (const NodeId id : scene.parents_first()) {
        const Node& node = scene[id];
        const Affine local = node.matrix ? *node.matrix : to_affine(node.local);
        world[index(id)] = node.parent == kNone<NodeId> ? local : world[index(node.parent)] * local;
    }
    return world;
}

/// A node's vertices in the world, as they stand at rest.
void pose(const Scene& scene, const Node& node, const std::vector<Affine>& world, const Affine& world_from_local,
          std::vector<glm::vec3>& positions, std::vector<glm::vec3>& normals) {
    const Mesh& mesh = scene[node.mesh];
    const std::vector<float>& weights = node.weights.empty() ? mesh.default_weights : node.weights;
    positions.resize(mesh.positions.size());
    normals.resize(mesh.normals.size());
    morph_positions(mesh.positions, mesh.targets, weights, positions);
    morph_normals(mesh.normals, mesh.targets, weights, normals);
    if (node.skin != kNone<SkinId>) {
        const Skin& skin = scene.skins[index(node.skin)];
        std::vector<Affine> world_from_mesh(skin.joints.size());
        for (size_t j = 0; j < skin.joints.size(); ++j) {
            world_from_mesh[j] = world[index(skin.joints[j])] * skin.joint_from_mesh[j];
        }
        PackedJoints joints;
        if (skin.skinning == Skinning::kDualQuaternion) {
            pack_joints_dual(world_from_mesh, joint_centres(skin.joint_from_mesh),
                             used_joints(mesh.binding, skin.joints.size()), &joints);
        } else {
            pack_joints(world_from_mesh, &joints);
        }
        zoe::skin(mesh.binding, joints, positions, normals, positions, normals);
        return;
    }
    for (glm::vec3& p : positions) p = world_from_local.point(p);
    Affine local_from_world;
    const bool is_invertible = invert(world_from_local, &local_from_world);
    const glm::mat3 normal_matrix = is_invertible ? glm::transpose(local_from_world.linear) : glm::mat3(0.0f);
    for (glm::vec3& n : normals) n = normal_matrix * n;
}

template <typename T>
void append_or_fill(std::vector<T>& to, const std::vector<T>& from, size_t first, size_t count, const T& missing) {
    if (to.empty() && from.empty()) return;
    to.resize(first, missing);
    to.insert(to.end(), from.begin(), from.end());
    to.resize(first + count, missing);
}

/// Appends what one node shows to the frame's mesh.
void append_node(const Scene& scene, const Node& node, const std::vector<Affine>& world, const Affine& world_from_local,
                 const std::vector<MaterialId>& materials, Mesh& mesh) {
    const Mesh& from = scene[node.mesh];
    std::vector<glm::vec3> positions, normals;
    pose(scene, node, world, world_from_local, positions, normals);
    const size_t first = mesh.positions.size(), count = positions.size();
    append_or_fill(mesh.positions, positions, first, count, glm::vec3(0.0f));
    append_or_fill(mesh.normals, normals, first, count, glm::vec3(0.0f));
    for (size_t set = 0; set < kMaxUvSets; ++set)
        append_or_fill(mesh.uvs[set], from.uvs[set], first, count, glm::vec2(0.0f));
    append_or_fill(mesh.colors, from.colors, first, count, glm::vec4(1.0f));

    // A mirror turns triangles round: turn them back, so that the same side stays in front. The node's matrix tells, even
    // where vertices follow a skin. In double precision no product of three floats vanishes.
    const bool is_mirror = glm::determinant(glm::dmat3(world_from_local.linear)) < 0.0;
    const uint32_t begin = static_cast<uint32_t>(mesh.corners.size());
    for (const glm::uvec3& c : from.corners) {
        const glm::uvec3 shifted = c + static_cast<uint32_t>(first);
        mesh.corners.push_back(is_mirror ? glm::uvec3(shifted.x, shifted.z, shifted.y) : shifted);
    }
    for (const MaterialRange& range : from.materials) {
        const MaterialId material = range.material == kNone<MaterialId> ? range.material : materials[index(range.material)];
        mesh.materials.push_back({begin + range.begin, begin + range.end, material});
    }
}

/// The position of an equal thing in `list`, which it joins if it is the first of its kind.
template <typename Id, typename T>
Id find_or_add(std::vector<T>& list, T thing) {
    const auto found = std::find(list.begin(), list.end(), thing);
    const Id id{static_cast<uint32_t>(found - list.begin())};
    if (found == list.end()) list.push_back(std::move(thing));
    return id;
}

/// Moves a frame's materials and images into the scene; what an earlier frame brought is not repeated.
std::vector<MaterialId> merge_materials(Scene& scene, Scene& frame) {
    std::vector<ImageId> images;
    for (Image& image : frame.images) images.push_back(find_or_add<ImageId>(scene.images, std::move(image)));
    std::vector<MaterialId> materials;
    for (Material& material : frame.materials) {
        for (TextureRef* ref : textures_of(material)) {
            if (ref->image != kNone<ImageId>) ref->image = images[index(ref->image)];
        }
        materials.push_back(find_or_add<MaterialId>(scene.materials, std::move(material)));
    }
    return materials;
}

Mesh read_frame(const fs::path& file, const GltfOptions& options, Scene& scene) {
    Scene frame = load_gltf(file, options);
    for (const auto& [text, count] : frame.warnings()) {
        for (uint64_t i = 0; i < count; ++i) scene.warn(text);
    }
    if (!frame.cameras.empty() || !frame.lights.empty()) scene.warn("cameras and lights of a mesh sequence: not used");
    for (const Mesh& mesh : frame.meshes) {
        if (mesh.surface) scene.warn("subdivision surfaces in the files of a mesh sequence: their cages are shown");
    }
    if (!frame.clips.empty()) scene.warn("animations in the files of a mesh sequence: not played");
    const std::vector<MaterialId> materials = merge_materials(scene, frame);
    const std::vector<Affine> world = world_matrices(frame);
    Mesh mesh;
    mesh.name = file.filename().string();
    for (size_t i = 0; i < frame.nodes.size(); ++i) {
        const Node& node = frame.nodes[i];
        if (!node.is_shown || node.mesh == kNone<MeshId>) continue;
        append_node(frame, node, world, world[i], materials, mesh);
    }
    return mesh;
}

}  // namespace

bool is_sequence_pattern(const std::string& pattern) {
    return parse_pattern(fs::path(pattern).filename().string()).has_value();
}

Scene load_sequence(const std::string& pattern, double fps, const GltfOptions& options) {
    if (!(fps > 0.0 && std::isfinite(fps))) throw SceneError(pattern, "", fmt::format("{} frames a second", fps));
    Scene scene;
    scene.file = pattern;
    Node node;
    node.name = fs::path(pattern).filename().string();
    node.sequence.emplace();
    node.sequence->fps = fps;
    for (const auto& [number, file] : find_files(pattern))
        node.sequence->meshes.push_back(scene.add(read_frame(file, options, scene)));
    node.mesh = node.sequence->meshes.front();
    scene.add(std::move(node));
    const std::string broken = check(scene);
    if (!broken.empty()) throw SceneError(pattern, "", broken);
    return scene;
}

}  // namespace zoe
