#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "engine/scene/mesh.h"

namespace zoe {

/// The frame in which normal textures are read, as glTF has it: x along a tangent, the direction in which u grows; z along
/// the normal; y along cross(normal, tangent) * w, where v falls. w is 1, or -1 where the texture is mirrored.

/// A flat triangle's tangent: unit length, and w. Zero where the triangle or its texture coordinates have no area.
glm::vec4 triangle_tangent(const glm::vec3 (&positions)[3], const glm::vec2 (&uvs)[3]);

/// Gives tangents to those corners of a range of triangles that have none, in `tangent_corners`: means of the tangents of
/// the triangles around a vertex, across its normal, weighted by angles. Triangles count as around one vertex where edges
/// connect them there, and where the texture is the same way round; so a texture and its mirror image each have their own
/// on the vertices where they meet. Vertices that are equal in place, normal and texture coordinate are one. A triangle
/// without area in the texture joins the first such group that reaches it. Corners that are left over take the first
/// tangent at their vertex; where there is none, they have zero, which asks for the triangle's own.
/// uv_set     the texture's coordinates.
/// Requires   a mesh that passes `check`; at most 2^30 triangles.
/// Cost       O(n log n) for n triangles; for loading, not for frames.
/// Source     Mikkelsen. Simulation of Wrinkled Surfaces Revisited. 2008, and its MikkTSpace. Deviation: what is left over
///            without a neighbour has zero, not the x axis.
void derive_tangents(Mesh* mesh, const MaterialRange& range, int uv_set);

}  // namespace zoe
