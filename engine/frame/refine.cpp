#include "engine/frame/refine.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>

#include "engine/frame/frame.h"
#include "engine/frame/frame_state.h"
#include "engine/math/parallel.h"

namespace zoe {

namespace {

// Its cage stands as it does at rest: it shows the surface that was evaluated when its cage was refined.
bool is_at_rest(const Scene& scene, const Shape& shape) {
    const Mesh& mesh = scene[shape.mesh];
    const bool is_morphed = !mesh.targets.empty() && !scene[shape.node].sequence;
    return !shape.own->has_skin && !is_morphed && mesh.surface->version == 0;
}

const Affine& world_from_local(const Shape& shape, const FrameState& state) {
    static const Affine identity;
    return shape.motion.frame == kNone<NodeId> ? identity : state.world_matrices[index(shape.motion.frame)];
}

// Of the shape's surface in this frame. What it depends on did not change where the cage and the view are as they were.
int level_of(const Scene& scene, const FrameState& state, Shape* shape) {
    const SubdivisionSurface& surface = *scene[shape->mesh].surface;
    if (!(surface.pixels > 0.0f) || !scene.viewpoint) {
        shape->own->is_capped = false;
        shape->own->seen = {};
        return surface.options.level;
    }
    const Viewpoint& viewpoint = *scene.viewpoint;
    const bool has_node = viewpoint.node != kNone<NodeId>;
    const float tangent = std::tan(0.5f * viewpoint.yfov);
    const Seen seen{.world_from_local = world_from_local(*shape, state),
                    .eye_world = has_node ? state.world_matrices[index(viewpoint.node)].translation : viewpoint.eye_world,
                    .pixels_at_1m = 0.5f * static_cast<float>(viewpoint.height_pixels) / tangent};
    const bool is_same_mesh = shape->own->refined && !shape->is_topology_changed;
    if (is_same_mesh && !shape->is_changed && seen == shape->own->seen) return shape->own->wanted_level;
    shape->own->seen = seen;
    return choose_level(state.level_choices.at(shape->mesh), shape->positions, seen, surface.pixels, viewpoint.hysteresis,
                        is_same_mesh ? shape->own->wanted_level : 0, &shape->own->is_capped);
}

// Where surfaces with `pixels` would have more triangles than the viewpoint allows, makes some of them coarser. It depends
// on this frame's levels alone.
void limit_triangles(Scene& scene, FrameState* state) {
    const auto count_of = [&](const Shape& shape, int level) {
        return state->level_choices.at(shape.mesh).triangle_counts[level];
    };
    const auto is_chosen = [&](const Shape& shape) {
        return shape.own->level > 0 && state->level_choices.contains(shape.mesh);
    };
    const uint64_t most = scene.viewpoint->max_triangles;
    uint64_t sum = 0;
    for (const Shape* shape : state->own_shapes) sum += is_chosen(*shape) ? count_of(*shape, shape->own->level) : 0;
    if (sum <= most) return;
    scene.warn("surfaces as fine as their pixels show would have more than " + std::to_string(most) +
               " triangles: the finest are coarser");
    std::vector<Shape*>& finest = state->finest;
    for (int level = kMaxSubdivisionLevel; level > 1 && sum > most; --level) {
        finest.clear();
        for (Shape* shape : state->own_shapes) {
            if (is_chosen(*shape) && shape->own->level == level) finest.push_back(shape);
        }
        std::sort(finest.begin(), finest.end(), [&](const Shape* a, const Shape* b) {
            const uint64_t of_a = count_of(*a, level), of_b = count_of(*b, level);
            return of_a != of_b ? of_a > of_b : index(a->node) < index(b->node);
        });
        for (Shape* shape : finest) {
            if (sum <= most) break;
            sum -= count_of(*shape, level) - count_of(*shape, level - 1);
            --shape->own->level;
        }
    }
}

void choose_levels(Scene& scene, FrameState* state) {
    if (scene.viewpoint && scene.viewpoint->node != kNone<NodeId> && index(scene.viewpoint->node) >= scene.nodes.size()) {
        throw SceneError(scene.file, "viewpoint", "there is no node " + std::to_string(index(scene.viewpoint->node)));
    }
    parallel_for(0, state->own_shapes.size(), 1, [&](size_t begin, size_t end) {
        for (size_t k = begin; k < end; ++k) {
            Shape& shape = *state->own_shapes[k];
            shape.own->is_capped = shape.own->is_capped && scene[shape.mesh].surface;
            const int level = scene[shape.mesh].surface ? level_of(scene, *state, &shape) : 0;
            if (level == 0) shape.own->refined = nullptr;
            shape.own->level = shape.own->wanted_level = level;
        }
    });
    if (scene.viewpoint && !state->level_choices.empty()) limit_triangles(scene, state);
    for (const Shape* shape : state->own_shapes) {
        if (!shape->own->is_capped) continue;
        scene.warn("node " + std::to_string(index(shape->node)) + " '" + scene[shape->node].name +
                   "': its subdivision surface would have to be finer than its finest level for the pixels asked for");
    }
}

// Levels that nodes have gone away from: their stencils are large.
void drop_unused(FrameState* state) {
    if (state->level_choices.empty()) return;
    std::erase_if(state->refined, [&](const auto& entry) {
        if (!state->level_choices.contains(entry.first.mesh)) return false;
        return std::ranges::none_of(state->own_shapes, [&](const Shape* shape) {
            return shape->mesh == entry.first.mesh && shape->own->level == entry.first.level;
        });
    });
}

// Refines what is not there yet, all of it at once.
void make_missing(const Scene& scene, FrameState* state, FrameStats* stats) {
    std::vector<std::pair<const SurfaceLevel, std::unique_ptr<Refined>>*> missing;
    for (const Shape* shape : state->own_shapes) {
        if (shape->own->level == 0) continue;
        const auto [found, is_new] = state->refined.try_emplace({shape->mesh, shape->own->level});
        if (is_new) missing.push_back(&*found);
    }
    stats->subdivided += static_cast<uint32_t>(missing.size());
    // A mesh of its own, wherever in memory it comes to lie.
    static std::atomic<uint64_t> refined_count{0};
    const uint64_t first_version = refined_count.fetch_add(missing.size()) + 1;
    try {
        parallel_for(0, missing.size(), 1, [&](size_t begin, size_t end) {
            for (size_t k = begin; k < end; ++k) {
                const SurfaceLevel& of = missing[k]->first;
                missing[k]->second = std::make_unique<Refined>(make_refined(scene[of.mesh], of.level));
                missing[k]->second->mesh.version = first_version + k;
            }
        });
    } catch (const std::runtime_error& error) {
        std::erase_if(state->refined, [](const auto& entry) { return !entry.second; });
        throw SceneError(scene.file.empty() ? "scene" : scene.file, "", error.what());
    }
}

void show(const Scene& scene, FrameState* state, FrameStats* stats) {
    for (Shape* shape : state->own_shapes) {
        OwnShape& own = *shape->own;
        if (own.level == 0) continue;
        const Refined* refined = state->refined.at({shape->mesh, own.level}).get();
        if (refined != own.refined || own.level != own.refined_level) shape->is_topology_changed = shape->is_changed = true;
        own.refined = refined;
        own.refined_level = own.level;
        shape->shown = &refined->mesh;
        stats->refined += shape->is_changed && !is_at_rest(scene, *shape);
    }
}

void evaluate_shape(const Scene& scene, Shape* shape) {
    OwnShape& own = *shape->own;
    if (is_at_rest(scene, *shape)) {
        shape->positions = own.refined->mesh.positions;
        shape->normals = own.refined->mesh.normals;
        return;
    }
    if (shape->is_changed) {
        own.refined_positions.resize(own.refined->mesh.positions.size());
        own.refined_normals.resize(own.refined->mesh.normals.size());
        evaluate(own.refined->stencils, shape->positions, own.refined_positions, own.refined_normals);
    }
    shape->positions = own.refined_positions;
    shape->normals = own.refined_normals;
}

}  // namespace

void refine(Scene& scene, FrameState* state, FrameStats* stats) {
    choose_levels(scene, state);
    drop_unused(state);
    make_missing(scene, state, stats);
    show(scene, state, stats);
    parallel_for(0, state->own_shapes.size(), 1, [&](size_t begin, size_t end) {
        for (size_t k = begin; k < end; ++k) {
            if (Shape* shape = state->own_shapes[k]; shape->own->level > 0) evaluate_shape(scene, shape);
        }
    });
}

}  // namespace zoe
