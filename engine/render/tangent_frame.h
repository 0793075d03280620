#pragma once

#include <glm/vec3.hpp>

#include "engine/frame/build_tlas.h"

namespace zoe {

/// The axes along which a normal texture bends a normal: world space, unit length or zero.
struct TangentFrame {
    glm::vec3 x{0.0f}, y{0.0f};
};

/// The frame at a point of a triangle. The mesh's tangents stand in its rest pose; what deformed the triangle since, and the
/// node's matrix, carry them along. Where the mesh has none, the triangle's own texture coordinates give the frame.
/// vertex     the triangle's.
/// weights    barycentric.
/// uv_set     of the normal texture.
/// normal     the world's shading normal on the mesh's front; both axes are across it.
TangentFrame tangent_frame(const Instance& instance, const glm::uvec3& vertex, const glm::vec3& weights, size_t uv_set,
                           const glm::vec3& normal);

}  // namespace zoe
