#pragma once

#include <string>

#include "engine/scene/scene.h"

namespace zoe {

/// The most triangles that all nodes together may show of subdivision surfaces at their levels.
inline constexpr uint64_t kMaxSubdividedTriangles = uint64_t{1} << 26;

/// Checks the cage of a mesh's subdivision surface, and that the mesh is one that shows nothing but it.
/// Requires   that the mesh has a surface.
/// Returns    the first broken invariant in words, empty when all hold.
std::string check_surface(const Mesh& mesh);

/// Checks that the nodes' surfaces, each of which is evaluated on its own, fit into memory.
/// most       triangles that all of them may have at their levels.
/// Requires   that each surface is sound by `check_surface`.
/// Returns    as above; with the number of triangles that they would have.
std::string check_surface_size(const Scene& scene, uint64_t most = kMaxSubdividedTriangles);

}  // namespace zoe
