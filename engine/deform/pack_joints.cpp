#include <cmath>

#include "engine/deform/packed_joints.h"

namespace zoe {

void pack_joints(std::span<const Affine> skin_from_mesh, PackedJoints* packed) {
    packed->skinning = Skinning::kLinearBlend;
    packed->is_finite = true;
    packed->common_scale = 1.0f;
    packed->affines.resize(skin_from_mesh.size());
    for (size_t joint = 0; joint < skin_from_mesh.size(); ++joint) {
        const Affine& from = skin_from_mesh[joint];
        for (int row = 0; row < 3; ++row) {
            float* to = packed->affines[joint].rows[row];
            for (int column = 0; column < 3; ++column) to[column] = from.linear[column][row];
            to[3] = from.translation[row];
        }
        packed->is_finite &= is_finite(from);
    }
}

std::vector<glm::vec3> joint_centres(std::span<const Affine> joint_from_mesh) {
    std::vector<glm::vec3> centres(joint_from_mesh.size(), glm::vec3(0.0f));
    for (size_t joint = 0; joint < centres.size(); ++joint) {
        Affine mesh_from_joint;
        if (invert(joint_from_mesh[joint], &mesh_from_joint)) centres[joint] = mesh_from_joint.translation;
    }
    return centres;
}

}  // namespace zoe
