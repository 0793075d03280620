#include "engine/frame/build_tlas.h"

#include <algorithm>
#include <cstring>
#include <string>
#include <utility>

#include "engine/frame/frame.h"
#include "engine/frame/frame_state.h"
#include "engine/math/parallel.h"

namespace zoe {

namespace {

constexpr size_t kGrain = 512;
constexpr size_t kAhead = 8;  // Instances that memory is asked for before their turn.

// Looks at a BLAS once for all shapes in a row that show it.
class BlasSummary {
public:
    void look_at(const Shape& shape, const TlasScratch& scratch) {
        if (shape.blas == blas_) return;
        blas_ = shape.blas;
        bounds_ = blas_->tree.bounds();
        const bool is_measured = shape.is_shared() && !scratch.reaches.empty();
        reach_ = is_measured ? scratch.reaches[index(shape.mesh)].get() : nullptr;
    }
    const Aabb& bounds() const { return bounds_; }
    const Reach* reach() const { return reach_; }  // Null: not measured.

private:
    const Blas* blas_ = nullptr;
    const Reach* reach_ = nullptr;
    Aabb bounds_;
};

const Affine& world_from_local(const Shape& shape, const FrameState& state) {
    static const Affine identity;
    const NodeId frame = shape.motion.frame;
    return frame == kNone<NodeId> ? identity : state.world_matrices[index(frame)];
}

// What follows from the matrix and the local bounds; false where the instance cannot be hit.
bool place(Instance* instance) {
    if (instance->bounds_local.is_empty()) return false;
    instance->is_identity = instance->world_from_local == Affine{};
    instance->local_from_world = Affine{};
    instance->bounds_world = instance->bounds_local;
    if (instance->is_identity) return true;
    instance->bounds_world = transform(instance->world_from_local, instance->bounds_local);
    return invert(instance->world_from_local, &instance->local_from_world) && instance->bounds_world.is_finite();
}

bool can_be_hit(const Shape& shape, const FrameState& state, const Aabb& bounds_local) {
    return !bounds_world(shape, state, bounds_local).is_empty();
}

// Measures the trees that stay as they are and are turned, once a scene: those that move, and those that many nodes show.
void measure_reaches(const Scene& scene, FrameState* state) {
    TlasScratch& scratch = state->tlas_scratch;
    if (!scene.placing.has_tight_boxes || scratch.is_reach_measured) return;
    scratch.reaches.resize(scene.meshes.size());
    std::vector<uint32_t> still_count(scene.meshes.size());
    for (const Shape& shape : state->shapes) {
        std::unique_ptr<Reach>& reach = scratch.reaches[index(shape.mesh)];
        if (!shape.is_shared() || reach) continue;
        const bool is_turned = !(world_from_local(shape, *state) == Affine{});
        if (shape.motion.motion == Motion::kRigid || (is_turned && ++still_count[index(shape.mesh)] > 1)) {
            reach = std::make_unique<Reach>();
            scratch.has_reaches = true;
        }
    }
    parallel_for(0, scratch.reaches.size(), 1, [&](size_t begin, size_t end) {
        for (size_t k = begin; k < end; ++k) {
            const Blas& blas = state->shared_blases[k];
            if (scratch.reaches[k] && !blas.tree.nodes.empty()) measure_reach(blas, scratch.reaches[k].get());
        }
    });
    scratch.is_reach_measured = true;
}

// Finds out which shapes can be hit in this frame, and makes room for their instances, in order.
void choose_shown(const Scene& scene, FrameState* state) {
    std::vector<uint8_t>& is_shown = state->tlas_scratch.is_shown;
    is_shown.resize(state->shapes.size());
    parallel_for(0, state->shapes.size(), kGrain, [&](size_t begin, size_t end) {
        BlasSummary summary;
        for (size_t k = begin; k < end; ++k) {
            const Shape& shape = state->shapes[k];
            summary.look_at(shape, state->tlas_scratch);
            is_shown[k] = can_be_hit(shape, *state, summary.bounds());
        }
    });
    Tlas& tlas = state->tlas;
    tlas.instance_of_node.assign(scene.nodes.size(), kNoInstance);
    uint32_t count = 0;
    for (size_t k = 0; k < is_shown.size(); ++k) {
        if (is_shown[k]) tlas.instance_of_node[index(state->shapes[k].node)] = count++;
    }
    tlas.instances.resize(count);
    // With room for parts of them.
    tlas.parts.reserve(count + scene.placing.most_parts);
    tlas.boxes.reserve(count + scene.placing.most_parts);
}

// To the last bit: what is worked out of 0 and -0 may differ.
template <typename Floats>
bool is_same(const Floats& a, const Floats& b) {
    static_assert(sizeof(Affine) == 12 * sizeof(float) && sizeof(Aabb) == 6 * sizeof(float), "no gaps between numbers");
    return std::memcmp(&a, &b, sizeof(Floats)) == 0;
}

// Brings an instance up to date, and the box that the tree holds of it. They are worked out anew only where what they
// follow from is other than it was.
// Returns    false where it cannot be hit.
bool update(const Scene& scene, const Shape& shape, const FrameState& state, const BlasSummary& summary, Instance* instance,
            Aabb* box, TlasScratch::Part* part) {
    const Aabb& bounds_local = summary.bounds();
    const Affine& matrix = world_from_local(shape, state);
    const bool is_kept = instance->blas == shape.blas && instance->node == shape.node &&
                         is_same(instance->world_from_local, matrix) && is_same(instance->bounds_local, bounds_local);
    instance->mesh = shape.shown;
    instance->positions = shape.positions;
    instance->normals = shape.normals;
    instance->motion = shape.motion.motion;
    if (is_kept) return true;
    part->is_moved = true;
    instance->world_from_local = matrix;
    instance->bounds_local = bounds_local;
    instance->blas = shape.blas;
    instance->node = shape.node;
    if (!place(instance)) return false;
    *box = instance->bounds_world;
    if (summary.reach() && !instance->is_identity && scene.placing.has_tight_boxes) {
        *box = tight_bounds(*summary.reach(), instance->world_from_local, instance->local_from_world, *box);
    }
    return true;
}

// Returns what holds for all of them together.
TlasScratch::Part update_instances(const Scene& scene, FrameState* state) {
    Tlas& tlas = state->tlas;
    TlasScratch& scratch = state->tlas_scratch;
    tlas.parts.resize(tlas.instances.size());
    tlas.boxes.resize(tlas.instances.size());
    scratch.parts.resize((state->shapes.size() + kGrain - 1) / kGrain);
    parallel_for(0, state->shapes.size(), kGrain, [&](size_t begin, size_t end) {
        TlasScratch::Part part{};
        BlasSummary summary;
        for (size_t k = begin; k < end; ++k) {
            const Shape& shape = state->shapes[k];
            summary.look_at(shape, scratch);
            const uint32_t at = tlas.instance_of_node[index(shape.node)];
            if (at == kNoInstance) {
                if (can_be_hit(shape, *state, summary.bounds())) part.is_shown_other = true;
                continue;
            }
            Instance& instance = tlas.instances[at];
            if (!update(scene, shape, *state, summary, &instance, &tlas.boxes[at], &part)) part.is_shown_other = true;
            if (instance.is_identity) tlas.boxes[at] = instance.bounds_world;  // Its parts' may have stood there.
            tlas.parts[at] = {at, 0};
            part.has_identity |= instance.is_identity;
            part.bounds_world.extend(instance.bounds_world);
            part.deepest = std::max(part.deepest, shape.blas->tree.stack_size());
        }
        scratch.parts[begin / kGrain] = part;
    });
    TlasScratch::Part all{};
    for (const TlasScratch::Part& part : scratch.parts) {
        all.is_shown_other |= part.is_shown_other;
        all.is_moved |= part.is_moved;
        all.deepest = std::max(all.deepest, part.deepest);
        all.bounds_world.extend(part.bounds_world);
    }
    return all;
}

// Puts parts of large instances in their places. Returns whether the parts are other than in the last frame.
bool open_largest(const Scene& scene, FrameState* state) {
    TlasScratch& scratch = state->tlas_scratch;
    const std::vector<Shape>& shapes = state->shapes;
    scratch.identities.clear();
    for (size_t k = 0; k < scratch.parts.size(); ++k) {
        if (!scratch.parts[k].has_identity) continue;
        for (size_t s = k * kGrain; s < std::min((k + 1) * kGrain, shapes.size()); ++s) {
            const uint32_t at = state->tlas.instance_of_node[index(shapes[s].node)];
            if (at != kNoInstance && state->tlas.instances[at].is_identity) scratch.identities.push_back(at);
        }
    }
    return open_instances(scene.placing, scratch.identities, &state->tlas, &scratch.opening);
}

void warn_of_hidden(Scene& scene, const FrameState& state) {
    if (state.tlas.instances.size() == state.shapes.size()) return;
    for (const Shape& shape : state.shapes) {
        if (state.tlas.instance_of_node[index(shape.node)] != kNoInstance || shape.blas->tree.bounds().is_empty()) continue;
        scene.warn("node " + std::to_string(index(shape.node)) + " '" + scene[shape.node].name +
                   "': not shown in frames where its world matrix has no finite inverse (a scale of 0, say)");
    }
}

// What rays need of an instance.
void prefetch(const Instance& instance) {
    __builtin_prefetch(&instance.local_from_world);
    __builtin_prefetch(&instance.bounds_world);
    __builtin_prefetch(&instance.is_identity);
}

// Builds the tree, and makes what rays walk through of it.
void build(const ClusterConfig& config, Tlas* tlas, TlasScratch* scratch) {
    tlas->bvh = build_clusters(tlas->boxes, config, std::move(tlas->bvh), &scratch->clusters);
    collapse(tlas->bvh, {.block_size = 1, .max_leaf_blocks = 1}, &tlas->tree, &tlas->slots, &scratch->collapse);
    tlas->placed.resize(tlas->slots.size());
    tlas->bounds_placed.resize(tlas->slots.size());
    parallel_for(0, tlas->slots.size(), kGrain, [&](size_t begin, size_t end) {
        for (size_t k = begin; k < end; ++k) {
            if (k + kAhead < end) prefetch(tlas->instances[tlas->parts[tlas->slots[k + kAhead]].instance]);
            const PlacedPart& part = tlas->parts[tlas->slots[k]];
            const Instance& instance = tlas->instances[part.instance];
            tlas->placed[k] = {.local_from_world = instance.local_from_world,
                               .blas = instance.blas,
                               .start = part.start,
                               .id = index(instance.node),
                               .is_identity = instance.is_identity,
                               .is_shifted = instance.local_from_world.linear == glm::mat3(1.0f)};
            tlas->bounds_placed[k] = instance.bounds_world;
        }
    });
}

}  // namespace

Aabb bounds_world(const Shape& shape, const FrameState& state, const Aabb& bounds_local) {
    Instance instance;
    instance.world_from_local = world_from_local(shape, state);
    instance.bounds_local = bounds_local;
    return place(&instance) ? instance.bounds_world : Aabb{};
}

void build_tlas(Scene& scene, FrameState* state, FrameStats* stats) {
    Tlas& tlas = state->tlas;
    TlasScratch& scratch = state->tlas_scratch;
    const bool was_valid = std::exchange(scratch.is_valid, false);
    // Most often the same nodes are shown as in the last frame.
    TlasScratch::Part all{.is_shown_other = true};
    if (was_valid) all = update_instances(scene, state);
    bool is_built = all.is_moved || all.is_shown_other;
    if (all.is_shown_other) {
        measure_reaches(scene, state);
        choose_shown(scene, state);
        all = update_instances(scene, state);
    }
    tlas.bounds_world = all.bounds_world;
    is_built |= open_largest(scene, state);
    warn_of_hidden(scene, *state);
    if (is_built) {
        build(scene.tlas_build, &tlas, &scratch);
        // Other parts, of a tree that was rebuilt, may make other nodes.
        tlas.tree.nodes.reserve(tlas.instances.size() < tlas.parts.size() ? tlas.parts.capacity() : 0);
    }
    stats->tlas_builds += is_built;
    // One more: what brings the ray back from an instance.
    tlas.stack_size = tlas.tree.stack_size() + all.deepest + 1;
    tlas.slack = scratch.has_reaches ? kTightSlack : 0.0f;
    scratch.is_valid = true;
}

}  // namespace zoe
