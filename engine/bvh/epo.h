#pragma once

#include <span>

#include "engine/bvh/bvh.h"
#include "engine/math/triangle.h"

namespace zoe {

/// End-point overlap: what a random ray costs because it ends on a surface inside of nodes that do not hold that surface.
/// Each node's cost, as `sah_cost` counts it, times the area of the triangles inside its box (closed) that are not in its
/// subtree, summed over the nodes and divided by the area of all triangles. What a tree costs to trace follows a blend of
/// `sah_cost` and this.
/// triangles  [reference_count] in the order of the leaves: triangles[k] is primitive bvh.primitives[k]. Those without area
///            and those that are not finite add nothing.
/// Requires   a valid tree, whose boxes contain their triangles, or the pieces of those that stand in it more than once:
/// such
///            a triangle counts once, and is in every subtree that has one of its pieces. A subtree's leaves may stand
///            anywhere.
/// Returns    0 where no node reaches into another's surface, and where there is no area. The same number whatever the
///            count of threads.
/// Cost       one walk a triangle, through the nodes that it reaches into; in parallel; 36 bytes a reference, 8 a node.
/// Source     Aila, Karras, Laine. On Quality Metrics of Bounding Volume Hierarchies. HPG 2013.
double epo_cost(const Bvh& bvh, std::span<const Triangle> triangles);

}  // namespace zoe
