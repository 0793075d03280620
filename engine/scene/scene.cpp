#include "engine/scene/scene.h"

#include <algorithm>
#include <iterator>

#include <fmt/format.h>

#include "engine/scene/trace_watch.h"

namespace zoe {
namespace {

constexpr const char* kMotionNames[kMotionCount] = {"static", "rigid", "deforming", "arbitrary"};

/// Keeps the ranges that are still there and stretches the last one to the end.
void fit_materials(std::vector<MaterialRange>& materials, uint32_t triangle_count) {
    for (MaterialRange& range : materials) {
        range.begin = std::min(range.begin, triangle_count);
        range.end = std::min(range.end, triangle_count);
    }
    if (materials.empty()) materials.push_back({});
    materials.back().end = triangle_count;
}

// Keeps rays and frames out for as long as an edit takes.
class Edit {
public:
    explicit Edit(const Scene& scene) : traces_(scene.traces.get()) {
        if (traces_) traces_->hold();
    }
    ~Edit() {
        if (traces_) traces_->let_go();
    }
    Edit(const Edit&) = delete;
    Edit& operator=(const Edit&) = delete;

private:
    TraceWatch* traces_;
};

}  // namespace

const char* name(Motion motion) {
    return kMotionNames[static_cast<int>(motion)];
}

std::optional<Motion> motion_from_name(std::string_view name) {
    const auto found = std::find(std::begin(kMotionNames), std::end(kMotionNames), name);
    if (found == std::end(kMotionNames)) return std::nullopt;
    return static_cast<Motion>(found - std::begin(kMotionNames));
}

Mesh make_surface(std::vector<glm::vec3> positions, SubdivisionSurface surface) {
    Mesh mesh;
    mesh.positions = std::move(positions);
    mesh.corners = split_faces(surface.cage);
    mesh.surface = std::move(surface);
    return mesh;
}

void Scene::touch() {
    // Held for good: rays through copies of the tree, which lead nowhere now, are refused.
    if (traces) traces->hold();
    traces.reset();
    frame.reset();
}

NodeId Scene::add(Node node) {
    const Edit edit(*this);
    nodes.push_back(std::move(node));
    return NodeId(nodes.size() - 1);
}

MeshId Scene::add(Mesh mesh) {
    const Edit edit(*this);
    meshes.push_back(std::move(mesh));
    return MeshId(meshes.size() - 1);
}

MaterialId Scene::add(Material material) {
    const Edit edit(*this);
    materials.push_back(std::move(material));
    return MaterialId(materials.size() - 1);
}

void Scene::write_mesh(MeshId id, std::span<const glm::vec3> positions, std::span<const glm::vec3> normals,
                       std::span<const glm::uvec3> corners) {
    const Edit edit(*this);
    const std::string place = fmt::format("mesh {}", index(id));
    if (index(id) >= meshes.size()) throw SceneError(file, place, "there is no such mesh");
    if (!normals.empty() && normals.size() != positions.size()) {
        throw SceneError(file, place, fmt::format("{} normals for {} vertices", normals.size(), positions.size()));
    }
    for (size_t i = 0; i < corners.size(); ++i) {
        const glm::uvec3& c = corners[i];
        if (std::max({c.x, c.y, c.z}) >= positions.size()) {
            throw SceneError(file, place,
                             fmt::format("triangle {} names vertex {}, but there are {}", i, std::max({c.x, c.y, c.z}),
                                         positions.size()));
        }
    }

    Mesh& mesh = (*this)[id];
    const size_t count = positions.size();
    const bool fits = mesh.positions.size() == count;
    mesh.positions.assign(positions.begin(), positions.end());
    mesh.normals.assign(normals.begin(), normals.end());
    mesh.tangent_corners.clear();
    mesh.tangents.clear();  // Those of other triangles; without any, each triangle has its own.
    mesh.corners.assign(corners.begin(), corners.end());
    fit_materials(mesh.materials, static_cast<uint32_t>(corners.size()));
    const bool has_attributes = has_uvs(mesh) || !mesh.colors.empty();
    if (!fits && has_attributes) {
        warn(fmt::format("mesh {} '{}': written with another vertex count; its uvs and colours are dropped", index(id),
                         mesh.name));
        for (std::vector<glm::vec2>& uvs : mesh.uvs) uvs.clear();
        mesh.colors.clear();
    }
    if (!mesh.targets.empty() || mesh.binding.influence_count > 0) {
        warn(fmt::format("mesh {} '{}': written by the user; its skin and morph targets are dropped", index(id), mesh.name));
        mesh.targets.clear();
        mesh.default_weights.clear();
        mesh.binding = {};
    }
    if (mesh.surface) {
        warn(fmt::format("mesh {} '{}': its triangles are written by the user; its subdivision surface is dropped",
                         index(id), mesh.name));
        mesh.surface.reset();
    }
    ++mesh.version;
}

void Scene::write_cage(MeshId id, std::span<const glm::vec3> positions) {
    const Edit edit(*this);
    const std::string place = fmt::format("mesh {}", index(id));
    if (index(id) >= meshes.size()) throw SceneError(file, place, "there is no such mesh");
    Mesh& mesh = (*this)[id];
    if (!mesh.surface) throw SceneError(file, place, "it is no cage of a subdivision surface");
    if (positions.size() != mesh.positions.size()) {
        throw SceneError(file, place,
                         fmt::format("{} positions for a cage of {} vertices", positions.size(), mesh.positions.size()));
    }
    if (mesh.surface->version == 0) mesh.surface->rest_positions = mesh.positions;
    std::copy(positions.begin(), positions.end(), mesh.positions.begin());
    ++mesh.surface->version;
}

std::vector<NodeId> Scene::parents_first() const {
    // Children of each node, as lists threaded through two arrays.
    const uint32_t count = static_cast<uint32_t>(nodes.size());
    const uint32_t none = index(kNone<NodeId>);
    std::vector<uint32_t> first_child(count, none), next_sibling(count, none);
    std::vector<NodeId> order;
    order.reserve(count);
    for (uint32_t i = count; i-- > 0;) {
        const uint32_t parent = index(nodes[i].parent);
        if (parent == none) continue;
        if (parent >= count) {
            throw SceneError(file, fmt::format("node {}", i), fmt::format("its parent is {}, not below {}", parent, count));
        }
        next_sibling[i] = first_child[parent];
        first_child[parent] = i;
    }
    for (uint32_t i = 0; i < count; ++i) {
        if (nodes[i].parent == kNone<NodeId>) order.push_back(NodeId{i});
    }
    for (size_t at = 0; at < order.size(); ++at) {
        for (uint32_t c = first_child[index(order[at])]; c != none; c = next_sibling[c]) order.push_back(NodeId{c});
    }
    if (order.size() < count) {
        std::vector<bool> is_reached(count, false);
        for (const NodeId id : order) is_reached[index(id)] = true;
        const auto lost = std::find(is_reached.begin(), is_reached.end(), false) - is_reached.begin();
        throw SceneError(file, fmt::format("node {}", lost), "its ancestors form a cycle");
    }
    return order;
}

}  // namespace zoe
