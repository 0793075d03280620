#include "engine/frame/frame.h"

#include <chrono>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <utility>

#include "engine/frame/clip_trees.h"
#include "engine/frame/frame_state.h"
#include "engine/scene/trace_watch.h"

namespace zoe {

namespace {

// Adds what the stage takes to a field.
template <typename Stage>
void timed(double* ms, Stage&& stage) {
    using Clock = std::chrono::steady_clock;
    const Clock::time_point start = Clock::now();
    stage();
    *ms += std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

// Nodes, meshes or a first write that came since the state was made ask for a new one.
bool fits(const FrameState& state, const Scene& scene) {
    return state.locals.size() == scene.nodes.size() && state.shared_blases.size() == scene.meshes.size() &&
           state.written_mesh_count == count_written_meshes(scene);
}

const FrameState& made_state(const Scene& scene) {
    if (!scene.frame) throw std::logic_error("the scene has no frame yet: call advance first");
    return *scene.frame;
}

void make_state(Scene& scene, FrameStats* stats) {
    if (const std::string problem = check(scene); !problem.empty()) {
        throw SceneError(scene.file.empty() ? "scene" : scene.file, "", problem);
    }
    auto state = std::make_shared<FrameState>();
    prepare(scene, state.get());
    build_clip_trees(scene, state.get(), stats);
    state->tlas.watch = std::make_shared<TraceWatch>();
    scene.traces = state->tlas.watch;
    scene.frame = std::move(state);
}

// What is left behind stays held: it is traced no more.
void drop_state(Scene& scene) {
    scene.frame.reset();
    scene.traces.reset();
}

}  // namespace

FrameInMaking::FrameInMaking(Scene& scene, FrameStats* stats) : scene_(scene) {
    if (scene.frame) {
        scene.traces->hold();
        if (!fits(*scene.frame, scene)) drop_state(scene);
    }
    if (!scene.frame) {
        make_state(scene, stats);
        scene.traces->hold();
    }
    state_ = scene.frame;
}

FrameInMaking::~FrameInMaking() {
    if (is_finished_) {
        state_->tlas.watch->let_go();
    } else {
        drop_state(scene_);
    }
}

const Tlas& advance(Scene& scene, double time_s, FrameStats* stats) {
    if (!std::isfinite(time_s)) throw std::invalid_argument("advance: the time is not finite");
    FrameStats ignored;
    FrameStats& s = stats ? *stats : ignored;
    FrameInMaking frame(scene, &s);
    FrameState& state = frame.state();
    timed(&s.animate_ms, [&] { animate(scene, time_s, &state); });
    timed(&s.deform_ms, [&] { deform(scene, &state, &s); });
    timed(&s.update_blas_ms, [&] { update_blas(scene, &state, &s); });
    timed(&s.build_tlas_ms, [&] { build_tlas(scene, &state, &s); });
    frame.finish();
    return state.tlas;
}

void report_rays(Scene& scene, uint64_t ray_count) {
    made_state(scene);
    scene.frame->traced_rays.add(static_cast<double>(ray_count));
}

const Affine& world_from_node(const Scene& scene, NodeId node) {
    return made_state(scene).world_matrices.at(index(node));
}

glm::dvec3 place_in_scene(const Scene& scene, NodeId node) {
    return made_state(scene).scene_from_nodes.at(index(node)).translation;
}

Motion motion(const Scene& scene, NodeId node) {
    return made_state(scene).motions.at(index(node)).motion;
}

}  // namespace zoe
