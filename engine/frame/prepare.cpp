#include <algorithm>
#include <set>
#include <string>

#include "engine/frame/frame_state.h"

namespace zoe {

namespace {

// The nodes between a skin's frame node and its joints.
// position   [node_count] all kNoPathNode, here and on return: one scratch array for all skins.
SkinPath find_path(const Scene& scene, const Skin& skin, std::span<const uint8_t> is_used, NodeId frame,
                   std::span<const uint32_t> rank, std::span<uint32_t> position) {
    SkinPath path;
    const auto add = [&](NodeId node) {
        position[index(node)] = 0;
        path.nodes.push_back(node);
    };
    add(frame);
    for (size_t joint = 0; joint < skin.joints.size(); ++joint) {
        if (!is_used[joint]) continue;
        for (NodeId node = skin.joints[joint]; position[index(node)] == kNoPathNode; node = scene[node].parent) add(node);
    }
    std::sort(path.nodes.begin(), path.nodes.end(), [&](NodeId a, NodeId b) { return rank[index(a)] < rank[index(b)]; });
    for (uint32_t k = 0; k < path.nodes.size(); ++k) position[index(path.nodes[k])] = k;
    for (const NodeId node : path.nodes) path.parents.push_back(node == frame ? 0 : position[index(scene[node].parent)]);
    for (size_t joint = 0; joint < skin.joints.size(); ++joint) {
        path.joints.push_back(is_used[joint] ? position[index(skin.joints[joint])] : kNoPathNode);
    }
    for (const NodeId node : path.nodes) position[index(node)] = kNoPathNode;
    path.frame_from_node.resize(path.nodes.size());
    return path;
}

void warn_of_refused_motion(Scene& scene, const std::vector<NodeMotion>& motions) {
    for (size_t k = 0; k < motions.size(); ++k) {
        const Node& node = scene.nodes[k];
        if (!node.motion || *node.motion >= motions[k].content) continue;
        scene.warn("/nodes/" + std::to_string(k) + "/extras/motion: '" + name(*node.motion) +
                   "' refused: the node's content is " + name(motions[k].content));
    }
}

// All that static and rigid nodes show, each shared tree once.
uint64_t count_still_triangles(const Scene& scene, const FrameState& state) {
    uint64_t count = 0;
    std::set<const Blas*> counted;
    for (const Shape& shape : state.shapes) {
        const MeshId mesh = scene[shape.node].mesh;
        if (shape.motion.motion > Motion::kRigid || mesh == kNone<MeshId> || !counted.insert(shape.blas).second) continue;
        const std::optional<SubdivisionSurface>& surface = scene[mesh].surface;
        count += surface ? count_triangles(surface->cage, surface->options.level) : scene[mesh].corners.size();
    }
    return count;
}

}  // namespace

void prepare(Scene& scene, FrameState* state) {
    const size_t node_count = scene.nodes.size();
    state->parents_first = scene.parents_first();
    state->motions = classify(scene);
    state->locals.resize(node_count);
    state->scene_from_nodes.resize(node_count);
    state->local_matrices.resize(node_count);
    state->world_matrices.resize(node_count);
    state->weights.resize(node_count);
    state->morph_reaches.resize(scene.meshes.size());
    state->shared_blases.resize(scene.meshes.size());
    state->is_shared_blas_built.resize(scene.meshes.size());
    state->written_mesh_count = count_written_meshes(scene);
    for (uint32_t k = 0; k < scene.meshes.size(); ++k) {
        const Mesh& mesh = scene.meshes[k];
        if (mesh.surface && mesh.surface->pixels > 0.0f) state->level_choices[MeshId{k}] = make_level_choice(mesh);
    }
    warn_of_refused_motion(scene, state->motions);

    std::vector<uint32_t> rank(node_count), position(node_count, kNoPathNode);
    for (uint32_t k = 0; k < node_count; ++k) rank[index(state->parents_first[k])] = k;
    for (uint32_t k = 0; k < node_count; ++k) {
        const Node& node = scene.nodes[k];
        if (node.mesh != kNone<MeshId>) state->weights[k].resize(scene[node.mesh].targets.size());
        const bool shows_mesh = node.mesh != kNone<MeshId> || (node.sequence && !node.sequence->meshes.empty());
        if (!node.is_shown || !shows_mesh) continue;
        Shape& shape = state->shapes.emplace_back();
        shape.node = NodeId{k};
        shape.motion = state->motions[k];
        shape.has_skin = !node.sequence && node.skin != kNone<SkinId> && scene[node.mesh].binding.influence_count > 0;
        if (!shape.has_skin) continue;
        const Skin& skin = scene.skins[index(node.skin)];
        shape.used_joints = used_joints(scene[node.mesh].binding, skin.joints.size());
        if (skin.skinning == Skinning::kDualQuaternion) shape.joint_centres = joint_centres(skin.joint_from_mesh);
        if (shape.motion.frame != kNone<NodeId>) {
            shape.skin_path = find_path(scene, skin, shape.used_joints, shape.motion.frame, rank, position);
        }
    }
    for (size_t k = 0; k < scene.meshes.size(); ++k) {
        if (!scene.meshes[k].targets.empty()) state->morph_reaches[k] = find_reach(scene.meshes[k].targets);
    }
    for (Shape& shape : state->shapes) {
        const Node& node = scene[shape.node];
        const bool is_undeformed = !node.sequence && !shape.has_skin && scene[node.mesh].targets.empty();
        const bool has_one_level = node.sequence || !scene[node.mesh].surface || scene[node.mesh].surface->pixels == 0.0f;
        const bool is_shared = is_undeformed && has_one_level && shape.motion.motion <= Motion::kRigid;
        shape.blas = is_shared ? &state->shared_blases[index(node.mesh)] : &shape.own_blas;
        state->active_shapes.push_back(&shape);
    }
    state->still_builder = choose_builder(count_still_triangles(scene, *state), scene.tree_build);
}

size_t count_written_meshes(const Scene& scene) {
    size_t count = 0;
    // A cage that was written may be written as a mesh later, which is more.
    for (const Mesh& mesh : scene.meshes) count += mesh.version > 0 ? 2 : mesh.surface && mesh.surface->version > 0 ? 1 : 0;
    return count;
}

}  // namespace zoe
