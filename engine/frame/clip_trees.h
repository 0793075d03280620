#pragma once

#include <span>
#include <vector>

#include "engine/bvh/bvh.h"

namespace zoe {

class Scene;
struct FrameState;
struct Shape;
struct FrameStats;

/// Builds trees for deforming nodes over poses of the clips that play, spread evenly: what comes is known, and a tree that
/// serves all of it needs fewer rebuilds than one of its first pose. One for each mesh that deforming nodes show, over the
/// first of them; none where no clip plays, or where surfaces are as fine as their pixels show: the triangles change then.
/// A tree changes what rays cost, never what they hit.
///
/// state      prepared; its `clip_trees` are filled. Shapes are left in some pose.
/// stats      surfaces that were refined on the way are added.
/// Cost       bounded: fewer poses where triangles are many, and none where they are very many.
void build_clip_trees(Scene& scene, FrameState* state, FrameStats* stats);

/// Adds the boxes of a shape's triangles in this frame; empty ones of those that are not finite.
void add_boxes(const Shape& shape, std::vector<Aabb>* boxes);

/// Fits a tree to other boxes of its primitives; empty ones bound nothing.
/// Returns    what it costs then, by SAH.
double fit(std::span<const Aabb> boxes, Bvh* tree);

}  // namespace zoe
