#include "engine/frame/refine.h"

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
    return !shape.has_skin && !is_morphed && mesh.surface->version == 0;
}

// Refines what is not there yet, all of it at once.
void make_missing(const Scene& scene, FrameState* state, FrameStats* stats) {
    std::vector<std::pair<const SurfaceLevel, std::unique_ptr<Refined>>*> missing;
    for (const Shape& shape : state->shapes) {
        if (shape.level == 0) continue;
        const auto [found, is_new] = state->refined.try_emplace({shape.mesh, shape.level});
        if (is_new) missing.push_back(&*found);
    }
    stats->subdivided += static_cast<uint32_t>(missing.size());
    try {
        parallel_for(0, missing.size(), 1, [&](size_t begin, size_t end) {
            for (size_t k = begin; k < end; ++k) {
                const SurfaceLevel& of = missing[k]->first;
                missing[k]->second = std::make_unique<Refined>(make_refined(scene[of.mesh], of.level));
            }
        });
    } catch (const std::runtime_error& error) {
        std::erase_if(state->refined, [](const auto& entry) { return !entry.second; });
        throw SceneError(scene.file.empty() ? "scene" : scene.file, "", error.what());
    }
}

void show(const Scene& scene, FrameState* state, FrameStats* stats) {
    for (Shape& shape : state->shapes) {
        if (shape.level == 0) continue;
        const Refined* refined = state->refined.at({shape.mesh, shape.level}).get();
        if (refined != shape.refined) shape.is_topology_changed = shape.is_changed = true;
        shape.refined = refined;
        shape.shown = &refined->mesh;
        stats->refined += shape.is_changed && !is_at_rest(scene, shape);
    }
}

void evaluate_shape(const Scene& scene, Shape* shape) {
    if (is_at_rest(scene, *shape)) {
        shape->positions = shape->refined->mesh.positions;
        shape->normals = shape->refined->mesh.normals;
        return;
    }
    if (shape->is_changed) {
        shape->refined_positions.resize(shape->refined->mesh.positions.size());
        shape->refined_normals.resize(shape->refined->mesh.normals.size());
        evaluate(shape->refined->stencils, shape->positions, shape->refined_positions, shape->refined_normals);
    }
    shape->positions = shape->refined_positions;
    shape->normals = shape->refined_normals;
}

}  // namespace

void refine(Scene& scene, FrameState* state, FrameStats* stats) {
    for (Shape& shape : state->shapes) {
        const std::optional<SubdivisionSurface>& surface = scene[shape.mesh].surface;
        shape.level = surface ? surface->options.level : 0;
        if (!surface) shape.refined = nullptr;
    }
    make_missing(scene, state, stats);
    show(scene, state, stats);
    parallel_for(0, state->shapes.size(), 1, [&](size_t begin, size_t end) {
        for (size_t k = begin; k < end; ++k) {
            if (state->shapes[k].level > 0) evaluate_shape(scene, &state->shapes[k]);
        }
    });
}

}  // namespace zoe
