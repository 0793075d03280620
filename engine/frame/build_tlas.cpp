#include "engine/frame/build_tlas.h"

#include <algorithm>
#include <string>
#include <utility>

#include "engine/bvh/build_agglomerative.h"
#include "engine/frame/frame_state.h"

namespace zoe {

namespace {

// The instance of a shape; false where it cannot be hit in this frame.
bool place(const Shape& shape, Scene& scene, const FrameState& state, Instance* instance) {
    const Aabb bounds = shape.blas->tree.bounds();
    if (bounds.is_empty()) return false;
    const NodeId frame = shape.motion.frame;
    const Affine world_from_local = frame == kNone<NodeId> ? Affine{} : state.world_matrices[index(frame)];
    const bool is_identity = world_from_local == Affine{};
    *instance = {.world_from_local = world_from_local,
                 .local_from_world = Affine{},
                 .bounds_world = is_identity ? bounds : transform(world_from_local, bounds),
                 .blas = shape.blas,
                 .mesh = &scene[shape.mesh],
                 .positions = shape.positions,
                 .normals = shape.normals,
                 .node = shape.node,
                 .motion = shape.motion.motion,
                 .is_identity = is_identity};
    if (!is_identity && !(invert(world_from_local, &instance->local_from_world) && instance->bounds_world.is_finite())) {
        scene.warn("node " + std::to_string(index(shape.node)) + " '" + scene[shape.node].name +
                   "': not shown in frames where its world matrix has no finite inverse (a scale of 0, say)");
        return false;
    }
    return true;
}

// Makes what rays walk through of the binary tree.
void make_traversed(Tlas* tlas) {
    collapse(tlas->bvh, {.block_size = 1, .max_leaf_blocks = 1}, &tlas->tree, &tlas->slots, &tlas->scratch);
    tlas->placed.clear();
    size_t deepest = 0;
    for (const uint32_t slot : tlas->slots) {
        const Instance& instance = tlas->instances[slot];
        tlas->placed.push_back({.local_from_world = instance.local_from_world,
                                .bounds_world = instance.bounds_world,
                                .blas = instance.blas,
                                .id = index(instance.node),
                                .is_identity = instance.is_identity});
        deepest = std::max(deepest, instance.blas->tree.stack_size());
    }
    // One more: what brings the ray back from an instance.
    tlas->stack_size = tlas->tree.stack_size() + deepest + 1;
}

}  // namespace

void build_tlas(Scene& scene, FrameState* state) {
    Tlas& tlas = state->tlas;
    tlas.instances.clear();
    tlas.instance_of_node.assign(scene.nodes.size(), kNoInstance);
    state->bounds.clear();
    for (const Shape& shape : state->shapes) {
        Instance instance;
        if (!place(shape, scene, *state, &instance)) continue;
        tlas.instance_of_node[index(shape.node)] = static_cast<uint32_t>(tlas.instances.size());
        tlas.instances.push_back(instance);
        state->bounds.push_back(instance.bounds_world);
    }
    tlas.bvh = build_agglomerative(state->bounds, std::move(tlas.bvh));
    make_traversed(&tlas);
}

}  // namespace zoe
