#include <algorithm>
#include <cmath>

#include "engine/frame/frame.h"
#include "engine/frame/frame_state.h"
#include "engine/math/parallel.h"

namespace zoe {

namespace {

// The mesh of a sequence at a time. Frame numbers are times * fps: a millionth of a frame early still counts as that frame.
MeshId mesh_at(const MeshSequence& sequence, double time_s, bool is_looping) {
    const double count = static_cast<double>(sequence.meshes.size());
    double frame = std::floor(time_s * sequence.fps + 1e-6);
    frame = is_looping ? frame - count * std::floor(frame / count) : std::clamp(frame, 0.0, count - 1.0);
    if (!std::isfinite(frame)) frame = 0.0;  // A time that overflows.
    return sequence.meshes[static_cast<size_t>(std::clamp(frame, 0.0, count - 1.0))];
}

// Joint matrices into `joints`, in world space or in that of the skin's frame node. Those that move no vertex rest.
void pose_joints(const Skin& skin, Shape* shape, const FrameState& state, std::vector<Affine>* joints) {
    joints->resize(skin.joints.size());
    SkinPath& path = shape->skin_path;
    for (size_t k = 1; k < path.nodes.size(); ++k) {
        path.frame_from_node[k] = path.frame_from_node[path.parents[k]] * state.local_matrices[index(path.nodes[k])];
    }
    for (size_t joint = 0; joint < skin.joints.size(); ++joint) {
        if (!shape->used_joints[joint]) {
            (*joints)[joint] = Affine{};
        } else if (path.nodes.empty()) {
            (*joints)[joint] = state.world_matrices[index(skin.joints[joint])] * skin.joint_from_mesh[joint];
        } else {
            (*joints)[joint] = path.frame_from_node[path.joints[joint]] * skin.joint_from_mesh[joint];
        }
    }
}

// Vertices that no target moves are written the first time only.
void morph_vertices(const Mesh& mesh, const MorphReach& reach, std::span<const float> weights,
                    std::vector<glm::vec3>* positions, std::vector<glm::vec3>* normals) {
    if (positions->size() != mesh.positions.size()) *positions = mesh.positions;
    if (normals->size() != mesh.normals.size()) *normals = mesh.normals;
    morph_positions(mesh.positions, mesh.targets, reach, weights, *positions);
    morph_normals(mesh.normals, mesh.targets, reach, weights, *normals);
}

void skin_vertices(const Skin& skin, const SkinBinding& binding, std::span<const glm::vec3> positions,
                   std::span<const glm::vec3> normals, Shape* shape) {
    if (skin.skinning == Skinning::kDualQuaternion) {
        pack_joints_dual(shape->joints, shape->joint_centres, shape->used_joints, &shape->packed_joints);
    } else {
        pack_joints(shape->joints, &shape->packed_joints);
    }
    shape->deformed_positions.resize(positions.size());
    shape->deformed_normals.resize(normals.size());
    zoe::skin(binding, shape->packed_joints, positions, normals, shape->deformed_positions, shape->deformed_normals);
}

void deform_shape(const Scene& scene, const FrameState& state, Shape* shape) {
    const Node& node = scene[shape->node];
    const MeshId mesh_id = node.sequence ? mesh_at(*node.sequence, state.time_s, scene.playback.is_looping) : node.mesh;
    const Mesh& mesh = scene[mesh_id];
    shape->is_topology_changed = mesh_id != shape->mesh || mesh.version != shape->mesh_version || !shape->has_blas;
    shape->is_changed = shape->is_topology_changed;
    shape->mesh = mesh_id;
    shape->mesh_version = mesh.version;
    shape->is_deformed = false;
    shape->shown = &mesh;
    if (mesh.surface && shape->cage_version != mesh.surface->version) {
        shape->cage_version = mesh.surface->version;
        shape->is_changed = true;
        // Whatever no target moves is other than it was, too.
        for (auto* vertices :
             {&shape->morphed_positions, &shape->morphed_normals, &shape->deformed_positions, &shape->deformed_normals}) {
            vertices->clear();
        }
    }

    const bool is_morphed = !mesh.targets.empty() && !node.sequence;
    if (!is_morphed && !shape->has_skin) {
        shape->positions = mesh.positions;
        shape->normals = mesh.normals;
        return;
    }
    // Morphs first, then the skin: targets are offsets in the bind pose.
    std::span<const glm::vec3> positions = mesh.positions, normals = mesh.normals;
    if (is_morphed) {
        auto& morphed_positions = shape->has_skin ? shape->morphed_positions : shape->deformed_positions;
        auto& morphed_normals = shape->has_skin ? shape->morphed_normals : shape->deformed_normals;
        if (shape->is_changed || shape->weights != state.weights[index(shape->node)]) {
            shape->weights = state.weights[index(shape->node)];
            morph_vertices(mesh, state.morph_reaches[index(mesh_id)], shape->weights, &morphed_positions, &morphed_normals);
            shape->is_changed = shape->is_deformed = true;
        }
        positions = morphed_positions;
        normals = morphed_normals;
    }
    if (shape->has_skin) {
        const Skin& skin = scene.skins[index(node.skin)];
        thread_local std::vector<Affine> joints;
        pose_joints(skin, shape, state, &joints);
        if (shape->is_changed || joints != shape->joints) {
            shape->joints = joints;
            skin_vertices(skin, mesh.binding, positions, normals, shape);
            shape->is_changed = shape->is_deformed = true;
        }
    }
    shape->positions = shape->deformed_positions;
    shape->normals = shape->deformed_normals;
}

}  // namespace

void deform(Scene& scene, FrameState* state, FrameStats* stats) {
    parallel_for(0, state->active_shapes.size(), 1, [&](size_t begin, size_t end) {
        for (size_t k = begin; k < end; ++k) deform_shape(scene, *state, state->active_shapes[k]);
    });
    for (const Shape* shape : state->active_shapes) stats->deformed += shape->is_deformed ? 1 : 0;
    refine(scene, state, stats);
}

}  // namespace zoe
