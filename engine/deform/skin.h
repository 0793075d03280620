#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "engine/deform/packed_joints.h"
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

/// Moves vertices by their joints, as the joints are packed (see `Skinning`). A weight of 0 hides what its joint does.
/// positions, normals                  [vertex_count] in the bind pose; normals may be empty: there are none.
/// skinned_positions, skinned_normals  as many; they may be the same memory. Normals follow the inverse transpose of their
///            vertex's map and are not of length 1; a joint that flattens gives the normal of the plane it flattens onto,
///            one that leaves a line or a point gives zero.
/// Requires   joints below those that are packed.
/// Cost       one pass, no allocation; the same bits with every instruction set and on any number of threads.
/// Source     Magnenat-Thalmann, Laperriere, Thalmann. Joint-Dependent Local Deformations. Graphics Interface 1988.
///            Kavan, Collins, Zara, O'Sullivan. Geometric Skinning with Approximate Dual Quaternion Blending. TOG 2008.
void skin(const SkinBinding& binding, const PackedJoints& joints, std::span<const glm::vec3> positions,
          std::span<const glm::vec3> normals, std::span<glm::vec3> skinned_positions, std::span<glm::vec3> skinned_normals);

}  // namespace zoe
