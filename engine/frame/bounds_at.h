#pragma once

#include "engine/math/aabb.h"
#include "engine/scene/scene.h"

namespace zoe {

/// Works out the box that the frame at a time has, without building trees: what `advance` would bound it by, to the last bit
/// unless trees hold triangles in pieces. Like `advance` it moves the nodes, whose matrices and places are then those of
/// this time, and ends the last frame's tree. Trees that did not follow are rebuilt by the next `advance`.
///
/// Returns    empty where nothing can be hit.
/// Cost       `advance` without its last two stages, and one pass over the triangles; over those of shared trees once.
/// Throws     as `advance`.
Aabb bounds_at(Scene& scene, double time_s);

}  // namespace zoe
