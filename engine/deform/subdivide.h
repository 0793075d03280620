#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "engine/deform/cage.h"
#include "engine/deform/stencils.h"

namespace zoe {

/// A cage refined to triangles. It holds topology and weights only, and serves every frame until the topology changes.
/// Vertices that no triangle has are left out. Where texture coordinates or normals differ across an edge (seams, sharp
/// creases) a vertex is there several times, with the same position to the last bit.
struct Subdivision {
    std::vector<glm::uvec3> corners;   ///< [triangle_count] vertices. Quads split from their first corner to their third.
    std::vector<uint32_t> cage_faces;  ///< [triangle_count] the face of the cage that each is of.
    std::array<std::vector<glm::vec2>, kMaxUvSets> uvs;  ///< As the cage has them: [vertex_count], or empty.
    StencilTable stencils;
};

struct SubdivisionOptions {
    int level = 2;  ///< Rounds of refinement; a quad gives 2 * 4^level triangles. Chart `subdivision`.
    /// Vertices lie on the limit surface, instead of where `level` rounds leave them. Sharpness that `level` rounds leave
    /// above 0 then counts as infinite, and where a crease ends inside of the surface the limit is an approximation.
    bool limit_positions = true;
    bool normals = true;  ///< Tangents are made, so that `evaluate` can give normals.
};

/// Refines a cage, and works out how the refined vertices follow those of the cage.
/// Normals are those of the limit surface, by the schemes' tangent masks, whether positions are at the limit or not. At a
/// sharp edge each side has its own; at a sharp corner each face has.
/// Requires   that `check(cage, vertex_count, options.level)` is empty.
/// Cost       about two microseconds a refined vertex; for loading, not for frames.
/// Throws     std::runtime_error where OpenSubdiv refuses the cage.
/// Source     Catmull, Clark. Recursively generated B-spline surfaces on arbitrary topological meshes. CAD 1978.
///            Loop. Smooth Subdivision Surfaces Based on Triangles. University of Utah 1987.
///            DeRose, Kass, Truong. Subdivision Surfaces in Character Animation. SIGGRAPH 1998 (creases).
///            Halstead, Kass, DeRose. Efficient, Fair Interpolation using Catmull-Clark Surfaces. SIGGRAPH 1993 (limits).
Subdivision make_subdivision(const Cage& cage, size_t vertex_count, const SubdivisionOptions& options);

}  // namespace zoe
