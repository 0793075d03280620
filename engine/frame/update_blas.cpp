#include <string>
#include <vector>

#include "engine/frame/frame.h"
#include "engine/frame/frame_state.h"
#include "engine/math/parallel.h"

namespace zoe {

namespace {

struct Method {
    BlasBuilder builder;
    bool is_refitted;  // Moved vertices refit the tree; else they rebuild it.
};

// By motion class: what its BLAS is built with, and what moving vertices do to it.
constexpr Method kMethods[kMotionCount] = {
    {BlasBuilder::kReinserted, false},  // static: built once
    {BlasBuilder::kReinserted, false},  // rigid: built once, rays are transformed
    {BlasBuilder::kSweep, true},        // deforming
    {BlasBuilder::kBinned, false},      // arbitrary
};

enum class Action { kKeep, kRefit, kRebuild };

// The cheapest that leaves the tree valid for this frame's vertices.
Action action_for(const Shape& shape) {
    if (!shape.has_blas || shape.is_topology_changed) return Action::kRebuild;
    if (!shape.is_changed) return Action::kKeep;
    return kMethods[static_cast<int>(shape.motion.motion)].is_refitted ? Action::kRefit : Action::kRebuild;
}

void update(const Scene& scene, Shape* shape) {
    const Mesh& mesh = scene[shape->mesh];
    if (action_for(*shape) == Action::kRefit) {
        refit_blas(shape->positions, mesh.corners, shape->blas);
    } else {
        const bool is_rebuilt_often = shape->motion.motion == Motion::kArbitrary;
        build_blas(shape->positions, mesh.corners, kMethods[static_cast<int>(shape->motion.motion)].builder, shape->blas,
                   &shape->blas_scratch);
        if (!is_rebuilt_often) shape->blas_scratch = {};
    }
    shape->has_blas = true;
}

}  // namespace

void update_blas(Scene& scene, FrameState* state, FrameStats* stats) {
    // A shared BLAS is built by the first node that shows it; the work list holds every tree once.
    std::vector<Shape*>& work = state->blas_work;
    work.clear();
    for (Shape& shape : state->shapes) {
        const Action action = action_for(shape);
        (action == Action::kKeep ? stats->kept : action == Action::kRefit ? stats->refitted : stats->rebuilt) += 1;
        if (action == Action::kKeep) continue;
        const bool is_shared = shape.blas != &shape.own_blas;
        if (is_shared && state->is_shared_blas_built[index(shape.mesh)]) {
            shape.has_blas = true;
            continue;
        }
        if (is_shared) state->is_shared_blas_built[index(shape.mesh)] = 1;
        work.push_back(&shape);
    }
    parallel_for(0, work.size(), 1, [&](size_t begin, size_t end) {
        for (size_t k = begin; k < end; ++k) update(scene, work[k]);
    });
    for (const Shape* shape : work) {
        if (const uint32_t count = shape->blas->not_finite_count; count > 0) {
            scene.warn("node " + std::to_string(index(shape->node)) + " '" + scene[shape->node].name +
                       "': triangles with NaN or infinite corners are never hit");
        }
    }
}

}  // namespace zoe
