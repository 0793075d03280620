#pragma once

namespace zoe {

class Scene;
struct FrameState;

/// Builds trees for deforming nodes over poses of the clips that play, spread evenly: what comes is known, and a tree that
/// serves all of it needs fewer rebuilds than one of its first pose. One for each mesh that deforming nodes show, over the
/// first of them; none where no clip plays. A tree changes what rays cost, never what they hit.
/// state      prepared; its `clip_trees` are filled. Shapes are left in some pose.
/// Cost       bounded: fewer poses where triangles are many, and none where they are very many.
void build_clip_trees(const Scene& scene, FrameState* state);

}  // namespace zoe
