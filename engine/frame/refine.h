#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "engine/deform/bends.h"
#include "engine/deform/stencils.h"
#include "engine/scene/scene.h"

namespace zoe {

/// A mesh's subdivision surface at one level, shared by all nodes that show it at that level.
struct Refined {
    Mesh mesh;  ///< What is shown: triangles, texture coordinates, materials; positions and normals of the cage at rest.
    StencilTable stencils;
};

/// Refines the cage of a mesh.
/// Requires   that the mesh has a surface, and that its cage passes `check` at the level.
/// Throws     std::runtime_error where OpenSubdiv refuses the cage.
Refined make_refined(const Mesh& mesh, int level);

/// What `choose_level` knows of a cage whose surface is to be as fine as its pixels show.
struct LevelChoice {
    std::vector<Bend> bends;
    int max_level = 0;  ///< The surface's, or less where that would not fit into memory.
    std::array<uint64_t, kMaxSubdivisionLevel + 1> triangle_counts{};  ///< [level]
};

/// Requires   that the mesh has a surface.
LevelChoice make_level_choice(const Mesh& mesh);

/// The coarsest level whose error is at most `pixels`; the finest allowed where none is.
/// last       the level of the frame before, which is kept while it is fine enough and none much coarser would be; 0: none.
/// hysteresis see Viewpoint.
/// is_capped  out: no level that is allowed is fine enough.
int choose_level(const LevelChoice& choice, std::span<const glm::vec3> cage_positions, const Seen& seen, float pixels,
                 float hysteresis, int last, bool* is_capped);

struct FrameState;
struct FrameStats;
/// The last part of `deform`: chooses the level of each node that shows a subdivision surface, refines cages that have not
/// been at theirs, and evaluates the surfaces whose cages were deformed in this frame.
void refine(Scene& scene, FrameState* state, FrameStats* stats);

}  // namespace zoe
