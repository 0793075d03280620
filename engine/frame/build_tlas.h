#pragma once

#include <memory>
#include <span>
#include <vector>

#include "engine/bvh/traverse.h"
#include "engine/math/affine.h"
#include "engine/scene/scene.h"
#include "engine/scene/trace_watch.h"

namespace zoe {

inline constexpr uint32_t kNoInstance = 0xffffffffu;

/// A node's BLAS in the world, and this frame's vertices for whoever shades its hits.
struct Instance {
    Affine local_from_world;
    Aabb bounds_world;  ///< Around bounds_local.
    const Blas* blas = nullptr;
    NodeId node = kNone<NodeId>;
    bool is_identity = false;  ///< Local space is world space.
    Motion motion = Motion::kStatic;
    Affine world_from_local;
    Aabb bounds_local;                     ///< Around the whole BLAS.
    const Mesh* mesh = nullptr;            ///< Topology, texture coordinates, colours, materials of what is shown.
    std::span<const glm::vec3> positions;  ///< [vertex_count] this frame's, local space.
    std::span<const glm::vec3> normals;    ///< [vertex_count] or empty; not normalised, may be zero.
};

/// What a leaf of the top level holds.
struct PlacedPart {
    uint32_t instance;  ///< Position in Tlas::instances.
    uint32_t start;     ///< A child's word in its tree; 0: all of it.
};

/// One tree over all instances of a frame. Valid until the next `advance` or edit of its scene.
struct Tlas {
    Bvh bvh;                                 ///< As built; primitives are positions in `parts`.
    WideBvh tree;                            ///< As traversed: block k is placed[k].
    std::vector<PlacedBlas> placed;          ///< [parts] what the kernels read of them,
    std::vector<Aabb> bounds_placed;         ///< and that of their whole trees in the world.
    size_t stack_size = 0;                   ///< Entries that a ray may have to keep, on both levels.
    float slack = 0.0f;                      ///< See TwoLevels.
    std::vector<Instance> instances;         ///< In order of their nodes.
    std::vector<PlacedPart> parts;           ///< Of each instance, then more of those that were opened.
    std::vector<Aabb> boxes;                 ///< [parts] what the tree is built over: each in bounds_world.
    Aabb bounds_world;                       ///< Around those of all instances.
    std::vector<uint32_t> instance_of_node;  ///< [node_count]; kNoInstance: nothing shown.
    std::vector<uint32_t> slots;             ///< [parts] positions in `parts`, in order of `placed`.
    std::shared_ptr<TraceWatch> watch;       ///< Who is at the trees, which copies share; null: nobody looks.

    /// Requires   that the node shows something in this frame (it was hit).
    const Instance& operator[](NodeId node) const { return instances[instance_of_node[index(node)]]; }
    Aabb bounds() const { return bounds_world; }
    TwoLevels levels() const { return {&tree, placed.data(), bounds_placed.data(), stack_size, slack}; }
};

}  // namespace zoe
