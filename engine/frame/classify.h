#pragma once

#include <vector>

#include "engine/scene/scene.h"

namespace zoe {

/// What the content allows each node to do, and the space its vertices live in.
struct NodeMotion {
    Motion content = Motion::kStatic;  ///< From the content alone.
    Motion motion = Motion::kStatic;   ///< `content`, or the more general class that was asked for.
    /// The node whose space the vertices are in after `deform`: the node itself; for a skin, the nearest animated node
    /// that all its joints hang from; none: world space.
    NodeId frame = kNone<NodeId>;
};

/// Works out the motion class of every node from channels, skins, morph targets, sequences and writes.
/// Returns    [node_count]; nodes without a mesh get the class of their transform.
std::vector<NodeMotion> classify(const Scene& scene);

/// Forces a node's motion class, and the BLAS method that goes with it, from the next frame on.
/// Throws     SceneError with the reason where the content moves more than the class allows.
void set_motion(Scene& scene, NodeId node, Motion motion);

}  // namespace zoe
