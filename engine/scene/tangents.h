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

/// Gives tangents to those vertices of a range of triangles that have none: means of their triangles' tangents, weighted
/// by angles. Vertices that are equal in place, normal and texture coordinate count as one. A vertex between a texture
/// and its mirror image, or without any tangent, keeps zero, which asks for the triangle's own.
/// uv_set     the texture's coordinates.
/// Requires   a mesh that passes `check`.
/// Source     Mikkelsen. Simulation of Wrinkled Surfaces Revisited. 2008, and its MikkTSpace. Deviation: no vertices are
///            split, as above; triangles without area in the texture take nothing from their neighbours.
void derive_tangents(Mesh* mesh, const MaterialRange& range, int uv_set);

}  // namespace zoe
