#pragma once

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

struct FrameState;
struct FrameStats;
/// The last part of `deform`: chooses the level of each node that shows a subdivision surface, refines cages that have not
/// been at theirs, and evaluates the surfaces whose cages were deformed in this frame.
void refine(Scene& scene, FrameState* state, FrameStats* stats);

}  // namespace zoe
