#pragma once

#include "engine/bvh/blas.h"
#include "engine/math/affine.h"

namespace zoe {

/// How far a mesh reaches in each direction: what the boxes around it are worked out of, however it is turned. Directions
/// are those from the centre of a cube to a grid of points on its faces, and the opposite ones, where the mesh is scaled to
/// reach from -1 to 1 along each axis.
struct Reach {
    static constexpr int kCells = 8;

    glm::vec3 centre, scale;  ///< The mesh is the scaled one times `scale`, and then moved by `centre`.
    /// The point at cell corners (column, row) of face `axis` has 1 along the axis, and goes from -1 to 1 along the next
    /// two. The largest dot product of a vertex with it, and with its opposite.
    float farthest[3][kCells + 1][kCells + 1][2];
};

/// Measures the triangles of a tree.
/// Requires   a tree that is not empty.
/// Cost       243 times what looking for the farthest triangle takes: no more than a few hundred nodes each; where that does
///            not find it, the nodes' boxes do.
void measure_reach(const Blas& blas, Reach* reach);

/// A box around the image of what was measured, for the top level, padded as TwoLevels asks for: tighter than that of the
/// image of its box.
/// local_from_world   the inverse.
/// bounds_world       around the whole: the result is in it.
/// Returns    bounds_world where the map is skewed by more than kMostSpread.
/// Cost       some two hundred operations, however large the mesh.
/// Source     a support function is convex and scales with its argument, so between directions whose weighted sum is the one
///            that is asked for, it is at most the weighted sum: Rockafellar. Convex Analysis. Princeton 1970, section 13.
Aabb tight_bounds(const Reach& reach, const Affine& world_from_local, const Affine& local_from_world,
                  const Aabb& bounds_world);

}  // namespace zoe
