#pragma once

#include <functional>

#include "engine/math/aabb.h"
#include "engine/scene/mesh.h"

namespace zoe {

/// Makes a mesh of the surface where a field is 0: one vertex in each cell that the surface crosses, joined across the
/// cell edges that it crosses. Closed where the field is positive all around the border; smooth normals.
/// field      negative inside, continuous.
/// box        where to look. cell: edge length of the grid's cubes.
/// Cost       O(cells) calls of `field`.
/// Source     Gibson. Constrained Elastic SurfaceNets. MICCAI 1998. Deviation: vertices are moved onto the surface along
///            the gradient, not relaxed.
Mesh polygonise(const std::function<float(const glm::vec3&)>& field, const Aabb& box, float cell);

}  // namespace zoe
