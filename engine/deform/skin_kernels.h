#pragma once

#include <cstddef>
#include <cstdint>

#include <glm/vec3.hpp>

#include "engine/deform/packed_joints.h"

namespace zoe {

/// What `skin` is asked for, in plain pointers.
struct SkinWork {
    uint32_t influence_count = 0;
    const uint16_t* joints = nullptr;
    const float* weights = nullptr;
    const PackedJoints* packed = nullptr;
    const glm::vec3* positions = nullptr;
    const glm::vec3* normals = nullptr;  ///< Null: none are wanted.
    glm::vec3* skinned_positions = nullptr;
    glm::vec3* skinned_normals = nullptr;
};

/// Vertices [begin, end), with the best instruction set that the processor has.
/// Source     see `skin`.
void skin_linear(const SkinWork& work, size_t begin, size_t end);
void skin_dual(const SkinWork& work, size_t begin, size_t end);

}  // namespace zoe
