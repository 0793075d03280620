#pragma once

#include <cstdint>

#include "engine/scene/scene.h"

namespace zoe {

/// What a frame did to a node's BLAS.
enum class TreeAction : uint8_t { kKept, kRefitted, kRebuilt };
const char* name(TreeAction action);

/// How a node stands in the last frame.
struct NodeReport {
    bool has_tree = false;  ///< It shows triangles; the rest is worth something only then.
    Motion content = Motion::kStatic;
    Motion motion = Motion::kStatic;  ///< As `content`, or the more general class that was asked for.
    const char* method = "";          ///< What its class does for the tree, in words.
    TreeAction action = TreeAction::kKept;
    bool is_shared = false;  ///< The tree is that of all nodes that show the mesh undeformed.
    uint32_t triangle_count = 0, vertex_count = 0;
    double tree_cost = 0.0;  ///< By SAH: tests of eight boxes, or of a block of triangles, for a ray that enters.
    double ray_loss = 0.0;   ///< Of that, estimated, what a new tree would save; 0 for trees that are not refitted.
};

/// Throws     std::logic_error before the first `advance`.
NodeReport report_node(const Scene& scene, NodeId node);

}  // namespace zoe
