#pragma once

#include <span>
#include <string>
#include <vector>

#include "engine/bvh/blas.h"
#include "engine/math/ray.h"

namespace zoe::test {

/// A triangle mesh before and after a motion.
struct BenchMesh {
    std::string name;
    std::vector<glm::vec3> rest;       ///< [vertex_count] what a tree to be refitted is built over.
    std::vector<glm::vec3> positions;  ///< [vertex_count] what everything else is measured on.
    std::vector<glm::uvec3> corners;

    /// Of the triangles in `positions`.
    std::vector<Aabb> boxes() const;
};

/// `torus`: 80,000 even triangles, waving. `room`: the content `static` with 72,000 triangles, half of them long and thin,
/// without motion. `explosion`: the content `arbitrary` with 20,000 triangles, at rest and farthest out.
inline constexpr const char* kMeshNames[] = {"torus", "room", "explosion"};
/// Makes a mesh at its first use.
const BenchMesh& mesh_named(const std::string& name);

/// Rays from an eye before the box, over a square picture, row by row.
std::vector<Ray> coherent_rays(const Aabb& box, int side);
/// Rays from anywhere in the box to anywhere around.
std::vector<Ray> incoherent_rays(const Aabb& box, int count);

}  // namespace zoe::test
