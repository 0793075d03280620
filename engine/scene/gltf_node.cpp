#include "engine/scene/gltf_node.h"

#include <algorithm>
#include <cmath>

namespace zoe {
namespace {

constexpr double kLengthTolerance = 1e-2;

std::string place_of(size_t node) {
    return fmt::format("/nodes/{}", node);
}

glm::vec3 vec3_of(const std::vector<double>& v, const glm::vec3& missing) {
    if (v.empty()) return missing;
    return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}

glm::quat rotation_of(const std::vector<double>& q, Scene& scene) {
    if (q.empty()) return {1.0f, 0.0f, 0.0f, 0.0f};
    const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    if (!(length > 1e-12)) {
        scene.warn("a node's rotation of length 0: taken as none");
        return {1.0f, 0.0f, 0.0f, 0.0f};
    }
    if (std::fabs(length - 1.0) > kLengthTolerance) scene.warn("a node's rotation whose length is not 1: normalised");
    return {static_cast<float>(q[3] / length), static_cast<float>(q[0] / length), static_cast<float>(q[1] / length),
            static_cast<float>(q[2] / length)};
}

Affine matrix_of(const std::vector<double>& m, Scene& scene) {
    if (m[3] != 0.0 || m[7] != 0.0 || m[11] != 0.0 || m[15] != 1.0) {
        scene.warn("a node's matrix whose last row is not 0 0 0 1: taken as such");
    }
    Affine a;
    for (size_t column = 0; column < 3; ++column) {
        for (size_t row = 0; row < 3; ++row) {
            a.linear[static_cast<int>(column)][static_cast<int>(row)] = static_cast<float>(m[column * 4 + row]);
        }
    }
    a.translation = {static_cast<float>(m[12]), static_cast<float>(m[13]), static_cast<float>(m[14])};
    return a;
}

template <typename Id>
Id id_or_none(int i) {
    return i < 0 ? kNone<Id> : Id{static_cast<uint32_t>(i)};
}

/// extras.motion and extras.mesh_sequence: this project's own words.
void read_extras(const GltfFile& file, size_t i, Node& node, Scene& scene) {
    const tinygltf::Value& extras = file.model.nodes[i].extras;
    if (extras.Has("motion")) {
        const tinygltf::Value& word = extras.Get("motion");
        if (word.IsString()) node.motion = motion_from_name(word.Get<std::string>());
        if (!node.motion) scene.warn("extras.motion is none of static, rigid, deforming, arbitrary: ignored");
    }
    if (extras.Has("mesh_sequence")) {
        const tinygltf::Value& from = extras.Get("mesh_sequence");
        MeshSequence sequence;
        if (from.Has("fps")) sequence.fps = from.Get("fps").GetNumberAsDouble();
        if (!(sequence.fps > 0.0)) file.fail(place_of(i) + "/extras/mesh_sequence/fps", "it must be above 0");
        const tinygltf::Value& meshes = from.Get("meshes");
        for (size_t k = 0; k < meshes.ArrayLen(); ++k) {
            sequence.meshes.push_back(MeshId(meshes.Get(static_cast<int>(k)).GetNumberAsInt()));
        }
        if (node.mesh == kNone<MeshId>) node.mesh = sequence.meshes.front();
        node.sequence = std::move(sequence);
    }
}

Node read_node(const GltfFile& file, size_t i, Scene& scene) {
    const tinygltf::Node& from = file.model.nodes[i];
    Node node;
    node.name = from.name;
    node.local.translation = vec3_of(from.translation, glm::vec3(0.0f));
    node.local.rotation = rotation_of(from.rotation, scene);
    node.local.scale = vec3_of(from.scale, glm::vec3(1.0f));
    if (!from.matrix.empty()) node.matrix = matrix_of(from.matrix, scene);
    node.mesh = id_or_none<MeshId>(from.mesh);
    node.skin = id_or_none<SkinId>(from.skin);
    node.camera = id_or_none<CameraId>(from.camera);
    const auto light = from.extensions.find("KHR_lights_punctual");
    if (light != from.extensions.end()) node.light = id_or_none<LightId>(light->second.Get("light").GetNumberAsInt());
    read_extras(file, i, node, scene);

    if (!from.weights.empty()) {
        const size_t target_count = node.mesh == kNone<MeshId> ? 0 : scene[node.mesh].targets.size();
        if (from.weights.size() == target_count) {
            node.weights.assign(from.weights.begin(), from.weights.end());
        } else {
            scene.warn("a node's weights are not as many as its mesh's morph targets: ignored");
        }
    }
    if (node.sequence) {
        const std::vector<float>& weights = node.weights.empty() ? scene[node.mesh].default_weights : node.weights;
        const bool is_morphed = std::any_of(weights.begin(), weights.end(), [](float w) { return w != 0.0f; });
        if (node.skin != kNone<SkinId>) scene.warn("a node with extras.mesh_sequence and a skin: the skin is ignored");
        if (is_morphed) scene.warn("a node with extras.mesh_sequence and morph weights: the weights are ignored");
    }
    return node;
}

void link_parents(const GltfFile& file, Scene& scene) {
    for (size_t i = 0; i < scene.nodes.size(); ++i) {
        const std::vector<int>& children = file.model.nodes[i].children;
        for (size_t k = 0; k < children.size(); ++k) {
            Node& child = scene.nodes[static_cast<size_t>(children[k])];
            if (child.parent != kNone<NodeId>) {
                file.fail(fmt::format("{}/children/{}", place_of(i), k),
                          fmt::format("node {} is already a child of node {}", children[k], index(child.parent)));
            }
            child.parent = NodeId(i);
        }
    }
    // Every node has one parent at most: from one in a cycle, the way up comes back to it.
    std::vector<uint32_t> seen_from(scene.nodes.size(), index(kNone<NodeId>));
    for (uint32_t i = 0; i < scene.nodes.size(); ++i) {
        for (uint32_t at = i; at != index(kNone<NodeId>); at = index(scene.nodes[at].parent)) {
            if (seen_from[at] == i) file.fail(place_of(at), "it is its own ancestor");
            if (seen_from[at] != index(kNone<NodeId>)) break;
            seen_from[at] = i;
        }
    }
}

void choose_scene(const GltfFile& file, const GltfOptions& options, Scene& scene) {
    const size_t scene_count = file.model.scenes.size();
    if (options.scene && (*options.scene < 0 || static_cast<size_t>(*options.scene) >= scene_count)) {
        file.fail("/scenes", fmt::format("there is no scene {}; the file has {}", *options.scene, scene_count));
    }
    for (size_t s = 0; s < scene_count; ++s) {
        const std::vector<int>& roots = file.model.scenes[s].nodes;
        for (size_t k = 0; k < roots.size(); ++k) {
            if (scene.nodes[static_cast<size_t>(roots[k])].parent != kNone<NodeId>) {
                file.fail(fmt::format("/scenes/{}/nodes/{}", s, k), fmt::format("node {} is no root", roots[k]));
            }
        }
    }
    if (scene_count == 0) return;  // Everything is shown.
    const size_t chosen = static_cast<size_t>(options.scene.value_or(std::max(file.model.defaultScene, 0)));
    for (Node& node : scene.nodes) node.is_shown = false;
    std::vector<int> to_show = file.model.scenes[chosen].nodes;
    while (!to_show.empty()) {
        const size_t i = static_cast<size_t>(to_show.back());
        to_show.pop_back();
        if (scene.nodes[i].is_shown) continue;
        scene.nodes[i].is_shown = true;
        const std::vector<int>& children = file.model.nodes[i].children;
        to_show.insert(to_show.end(), children.begin(), children.end());
    }
}

}  // namespace

void read_nodes(const GltfFile& file, const GltfOptions& options, Scene& scene) {
    scene.nodes.reserve(file.model.nodes.size());
    for (size_t i = 0; i < file.model.nodes.size(); ++i) scene.nodes.push_back(read_node(file, i, scene));
    link_parents(file, scene);
    choose_scene(file, options, scene);
}

void check_zeros_shown(GltfFile& file, const Scene& scene) {
    std::vector<uint64_t> zeros_of(scene.meshes.size(), 0);
    for (size_t i = 0; i < zeros_of.size(); ++i) {
        for (const tinygltf::Primitive& primitive : file.model.meshes[i].primitives) {
            const auto position = primitive.attributes.find("POSITION");
            if (position == primitive.attributes.end()) continue;
            const int view = file.model.accessors[static_cast<size_t>(position->second)].bufferView;
            const bool is_backed = view >= 0 && static_cast<size_t>(view) < file.views.size();
            if (!is_backed) zeros_of[i] = scene.meshes[i].positions.size();
        }
    }
    for (size_t i = 0; i < scene.nodes.size(); ++i) {
        const Node& node = scene.nodes[i];
        if (node.mesh == kNone<MeshId>) continue;
        uint64_t count = zeros_of[index(node.mesh)];
        if (node.sequence) {
            for (const MeshId mesh : node.sequence->meshes) count = std::max(count, zeros_of[index(mesh)]);
        }
        // Instances stand behind the file's own nodes, and name the one that they came from as their parent.
        file.spend(count, place_of(i < file.model.nodes.size() ? i : index(node.parent)));
    }
}

void decompose_animated(Scene& scene) {
    for (const Clip& clip : scene.clips) {
        for (const AnimationChannel& channel : clip.channels) {
            Node& node = scene[channel.node];
            if (channel.path == ChannelPath::kWeights || !node.matrix) continue;
            const bool is_exact = decompose(*node.matrix, &node.local);
            scene.warn(is_exact ? "an animated node with a matrix: decomposed"
                                : "an animated node with a matrix that shears: decomposed, without the shear");
            node.matrix.reset();
        }
    }
}

}  // namespace zoe
