#pragma once

#include <span>
#include <vector>

#include "engine/bvh/blas.h"
#include "engine/math/affine.h"
#include "engine/scene/scene.h"

namespace zoe {

inline constexpr uint32_t kNoInstance = 0xffffffffu;

/// A node's BLAS in the world, and this frame's vertices for whoever shades its hits.
struct Instance {
    Affine world_from_local;
    Affine local_from_world;
    Aabb bounds_world;
    const Blas* blas = nullptr;
    const Mesh* mesh = nullptr;            ///< Topology, texture coordinates, colours, materials.
    std::span<const glm::vec3> positions;  ///< [vertex_count] this frame's, local space.
    std::span<const glm::vec3> normals;    ///< [vertex_count] or empty; not normalised, may be zero.
    NodeId node = kNone<NodeId>;
    Motion motion = Motion::kStatic;
    bool is_identity = false;  ///< Local space is world space.
};

/// One tree over all instances of a frame. Valid until the next `advance` or edit of its scene.
struct Tlas {
    Bvh bvh;                                 ///< Primitives are positions in `instances`.
    std::vector<Instance> instances;         ///< In order of their nodes.
    std::vector<uint32_t> instance_of_node;  ///< [node_count]; kNoInstance: nothing shown.

    /// Requires   that the node shows something in this frame (it was hit).
    const Instance& operator[](NodeId node) const { return instances[instance_of_node[index(node)]]; }
    Aabb bounds() const { return bvh.bounds(); }
};

}  // namespace zoe
