#include "engine/frame/frame.h"

#include <chrono>
#include <cmath>
#include <stdexcept>

#include "engine/frame/frame_state.h"

namespace zoe {

namespace {

// Adds the time until it ends to a field.
class Timer {
public:
    explicit Timer(double* ms) : ms_(ms), start_(Clock::now()) {}
    ~Timer() { *ms_ += std::chrono::duration<double, std::milli>(Clock::now() - start_).count(); }
    Timer(const Timer&) = delete;

private:
    using Clock = std::chrono::steady_clock;
    double* ms_;
    Clock::time_point start_;
};

template <typename Stage>
void timed(double* ms, Stage&& stage) {
    const Timer timer(ms);
    stage();
}

FrameState& state_of(Scene& scene) {
    if (scene.frame && scene.frame->written_mesh_count != count_written_meshes(scene)) scene.touch();
    if (!scene.frame) {
        if (const std::string problem = check(scene); !problem.empty()) {
            throw SceneError(scene.file.empty() ? "scene" : scene.file, "", problem);
        }
        scene.frame = std::make_shared<FrameState>();
        prepare(scene, scene.frame.get());
    }
    return *scene.frame;
}

}  // namespace

const Tlas& advance(Scene& scene, double time_s, FrameStats* stats) {
    if (!std::isfinite(time_s)) throw std::invalid_argument("advance: the time is not finite");
    FrameStats ignored;
    FrameStats& s = stats ? *stats : ignored;
    FrameState& state = state_of(scene);
    timed(&s.animate_ms, [&] { animate(scene, time_s, &state); });
    timed(&s.deform_ms, [&] { deform(scene, &state); });
    timed(&s.update_blas_ms, [&] { update_blas(scene, &state, &s); });
    timed(&s.build_tlas_ms, [&] { build_tlas(scene, &state); });
    return state.tlas;
}

const Affine& world_from_node(const Scene& scene, NodeId node) {
    return scene.frame->world_matrices.at(index(node));
}

Motion motion(const Scene& scene, NodeId node) {
    return scene.frame->motions.at(index(node)).motion;
}

}  // namespace zoe
