#include "engine/scene/gltf_mesh.h"

#include <algorithm>

#include "engine/scene/gltf_primitive.h"

namespace zoe {
namespace {

/// Primitives with the same vertex data.
struct VertexGroup {
    const tinygltf::Primitive* primitive;
    std::string place;
    GltfRange used;
    uint32_t first = 0;  ///< Where vertex used.begin stands in the mesh.
};

struct Part {
    std::vector<glm::uvec3> corners;
    size_t group = 0;
};

/// The sets of texture coordinates in which the textures of a primitive's material are looked up.
UvSets find_uv_sets(const tinygltf::Primitive& primitive, const Scene& scene) {
    UvSets sets;
    if (primitive.material < 0) return sets;
    for (const TextureRef* ref : textures_of(scene.materials[static_cast<size_t>(primitive.material)])) {
        if (ref->image != kNone<ImageId>) sets.set(ref->uv_set);
    }
    return sets;
}

void warn_of_missing(const UvSets& uv_sets, const tinygltf::Primitive& primitive, Scene& scene) {
    for (size_t set = 0; set < kMaxUvSets; ++set) {
        if (!uv_sets[set] || primitive.attributes.contains(fmt::format("TEXCOORD_{}", set))) continue;
        scene.warn(fmt::format("a primitive with a texture but without its TEXCOORD_{}: (0, 0) is taken", set));
    }
}

void add_morph_weights(const tinygltf::Mesh& from, Mesh& mesh, Scene& scene) {
    mesh.default_weights.assign(from.weights.begin(), from.weights.end());
    if (!from.weights.empty() && from.weights.size() != mesh.targets.size()) {
        scene.warn("a mesh's weights are not as many as its morph targets");
    }
    mesh.default_weights.resize(mesh.targets.size(), 0.0f);
}

}  // namespace

Mesh read_mesh(GltfFile& file, size_t mesh_index, Scene& scene) {
    const tinygltf::Mesh& from = file.model.meshes[mesh_index];
    Mesh mesh;
    mesh.name = from.name;

    // Triangles first: they tell which vertices are needed.
    using Key = std::pair<std::map<std::string, int>, std::vector<std::map<std::string, int>>>;
    std::map<Key, size_t> group_of;
    std::vector<VertexGroup> groups;
    std::vector<Part> parts(from.primitives.size());
    UvSets uv_sets{1};  // Whoever gives the mesh another texture expects the first.
    size_t target_count = 0;
    bool is_first = true;
    for (size_t i = 0; i < from.primitives.size(); ++i) {
        const tinygltf::Primitive& primitive = from.primitives[i];
        const std::string place = fmt::format("/meshes/{}/primitives/{}", mesh_index, i);
        const auto position = primitive.attributes.find("POSITION");
        if (position == primitive.attributes.end()) {
            scene.warn("a primitive without POSITION: not shown");
            continue;
        }
        const uint64_t vertex_count = file.model.accessors[static_cast<size_t>(position->second)].count;
        parts[i].corners = read_corners(file, primitive, vertex_count, place, scene);
        if (parts[i].corners.empty()) continue;
        if (!is_first && primitive.targets.size() != target_count) {
            file.fail(place + "/targets", fmt::format("{} morph targets, where the primitive before has {}",
                                                      primitive.targets.size(), target_count));
        }
        target_count = primitive.targets.size();
        is_first = false;

        const UvSets own_sets = find_uv_sets(primitive, scene);
        warn_of_missing(own_sets, primitive, scene);
        uv_sets |= own_sets;

        const auto [found, is_new] = group_of.try_emplace({primitive.attributes, primitive.targets}, groups.size());
        parts[i].group = found->second;
        if (is_new) groups.push_back({&primitive, place, {vertex_count, 0}});
        GltfRange& used = groups[found->second].used;
        for (const glm::uvec3& corner : parts[i].corners) {
            used.begin = std::min<uint64_t>({used.begin, corner.x, corner.y, corner.z});
            used.end =
                std::max<uint64_t>({used.end, corner.x + uint64_t{1}, corner.y + uint64_t{1}, corner.z + uint64_t{1}});
        }
    }

    mesh.targets.resize(target_count);
    for (VertexGroup& group : groups) {
        group.first = static_cast<uint32_t>(mesh.positions.size());
        append_vertices(file, *group.primitive, group.used, uv_sets, group.place, mesh, scene);
    }
    for (size_t i = 0; i < parts.size(); ++i) {
        const uint32_t begin = static_cast<uint32_t>(mesh.corners.size());
        if (!parts[i].corners.empty()) {
            const VertexGroup& group = groups[parts[i].group];
            const uint32_t shift = group.first - static_cast<uint32_t>(group.used.begin);  // Modulo 2^32, and undone by it.
            for (const glm::uvec3& corner : parts[i].corners) mesh.corners.push_back(corner + shift);
        }
        const int material = from.primitives[i].material;
        mesh.materials.push_back(
            {begin, static_cast<uint32_t>(mesh.corners.size()), material < 0 ? kNone<MaterialId> : MaterialId(material)});
    }
    add_morph_weights(from, mesh, scene);
    return mesh;
}

}  // namespace zoe
