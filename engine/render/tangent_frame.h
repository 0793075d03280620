#pragma once

#include <glm/vec3.hpp>

#include "engine/frame/build_tlas.h"

namespace zoe {

/// The axes along which a normal texture bends a normal: world space, unit length or zero.
struct TangentFrame {
    glm::vec3 x{0.0f}, y{0.0f};
};

/// The frame at a point of a triangle: its corners' tangents and normals, interpolated, and w * cross(normal, tangent), as
/// MikkTSpace has it. The mesh's tangents stand in its rest pose; what deformed the triangle since, and the node's matrix,
/// carry them along. Where the mesh has none, the triangle's own texture coordinates give the frame.
/// Deviation: MikkTSpace takes all three as interpolated. Here the shading normal has unit length, and both axes are brought
/// across it and to unit length at every point, so that what leans by 45 degrees in the texture does so on the surface.
/// weights    barycentric.
/// uv_set     of the normal texture.
/// normal     the world's shading normal on the mesh's front; both axes are across it.
TangentFrame tangent_frame(const Instance& instance, uint32_t triangle, const glm::vec3& weights, size_t uv_set,
                           const glm::vec3& normal);

}  // namespace zoe
