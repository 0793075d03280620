#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "engine/math/affine.h"

namespace zoe {

/// Which joints move each vertex, and how much. Vertex v has entries [v * influence_count, (v + 1) * influence_count).
struct SkinBinding {
    uint32_t influence_count = 0;  ///< 0 (no binding), 4, 8, ...
    std::vector<uint16_t> joints;  ///< Index into the skin's joints.
    std::vector<float>
        weights;  ///< Sum 1 a vertex: the reader sees to it. All zero: the vertex follows the first joint of its list.
};

/// Tells, by joint, whether any vertex follows it.
/// Returns    [joint_count] 1 or 0.
std::vector<uint8_t> used_joints(const SkinBinding& binding, size_t joint_count);

/// Linear blend skinning of positions.
/// skin_from_mesh   [joint_count] joint matrices: joint's world (or skin space) * inverse bind matrix.
/// Source     Magnenat-Thalmann, Laperriere, Thalmann. Joint-dependent local deformations. Graphics Interface 1988.
void skin_positions(const SkinBinding& binding, std::span<const Affine> skin_from_mesh, std::span<const glm::vec3> in,
                    std::span<glm::vec3> out);
/// The same for normals, by the inverse transpose of the blended matrix. Not normalised. A joint that
/// flattens gives the normal of the plane it flattens onto; one that leaves a line or a point gives zero.
void skin_normals(const SkinBinding& binding, std::span<const Affine> skin_from_mesh, std::span<const glm::vec3> in,
                  std::span<glm::vec3> out);

}  // namespace zoe
