#include "engine/frame/frame.h"

#include <chrono>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <utility>

#include "engine/frame/clip_trees.h"
#include "engine/frame/frame_state.h"

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

// Makes the scene's state where there is none, and anew where nodes, meshes or a first write came since.
void have_state(Scene& scene, FrameStats* stats) {
    if (scene.frame && !scene.frame->is_in_use && !fits(*scene.frame, scene)) scene.touch();
    if (!scene.frame) {
        if (const std::string problem = check(scene); !problem.empty()) {
            throw SceneError(scene.file.empty() ? "scene" : scene.file, "", problem);
        }
        auto state = std::make_shared<FrameState>();
        prepare(scene, state.get());
        build_clip_trees(scene, state.get(), stats);
        scene.frame = std::move(state);
    }
}

}  // namespace

FrameInMaking::FrameInMaking(Scene& scene, FrameStats* stats) : scene_(scene) {
    have_state(scene, stats);
    if (scene.frame->is_in_use.exchange(true))
        throw std::logic_error("advance: another thread is making a frame of this scene");
    state_ = scene.frame;
}

FrameInMaking::~FrameInMaking() {
    state_->is_in_use = false;
    if (!is_finished_) scene_.frame.reset();
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
