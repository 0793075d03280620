#include "apps/demo/window.h"

#include <algorithm>

#include "apps/common/interrupt.h"
#include "apps/common/write_file.h"
#include "apps/demo/first_view.h"
#include "apps/demo/window_panels.h"
#include "apps/demo/window_state.h"

namespace zoe {
namespace {

constexpr PictureSize kDefaultSize{1280, 720};
constexpr int kDefaultMaxSamples = 1024;

/// The scene at time 0, and the view that was asked for.
WindowState first_state(Content& content, const Options& options) {
    const ViewChoice choice = first_view(content, options);
    const Tlas& tlas = advance(content, 0.0, nullptr);
    WindowState state = make_window_state(options.scene, content.scene, tlas);
    state.fps = options.fps;
    state.shade = options.shade;
    state.environment = options.environment.get();
    const auto is_chosen = [&](const WindowState::CameraChoice& camera) { return camera.node == choice.camera; };
    const auto camera = std::find_if(state.cameras.begin(), state.cameras.end(), is_chosen);
    if (camera != state.cameras.end()) state.camera = static_cast<int>(camera - state.cameras.begin());
    const float aspect = float(kDefaultSize.width) / kDefaultSize.height;
    const Aabb bounds = choice.bounds.is_empty() ? tlas.bounds() : choice.bounds;
    state.orbit = orbit_from_view(choice.view(content.scene, aspect), bounds);
    if (choice.look_at) state.orbit.target = choice.look_at->target;
    if (choice.look_at) state.orbit.distance = glm::distance(choice.look_at->eye, choice.look_at->target);
    state.first_orbit = state.orbit;
    return state;
}

/// Takes what the render thread has made.
void take_picture(LiveRenderer& renderer, GlWindow& window, WindowState& state, double* last_new_s) {
    if (!renderer.take(&state.picture)) return;
    window.set_texture(state.picture.width, state.picture.height, state.picture.rgba.data());
    if (!state.picture.is_new_frame) return;
    state.history.push_back(state.picture.stats);
    if (state.history.size() > WindowState::kHistorySize) state.history.pop_front();
    const double elapsed_s = window.seconds() - *last_new_s;
    *last_new_s = window.seconds();
    const double rate = elapsed_s > 1e-6 ? 1.0 / elapsed_s : 0.0;
    state.frames_a_second = state.frames_a_second > 0.0 ? 0.9 * state.frames_a_second + 0.1 * rate : rate;
}

}  // namespace

void run_window(Content& content, const Options& options) {
    if (options.screenshot) require_writable(*options.screenshot);
    GlWindow window("Zoetrope: " + one_line(options.scene), options.size.value_or(kDefaultSize));
    WindowState state = first_state(content, options);
    state.texture = window.texture();

    catch_interrupts();
    LiveRenderer renderer(content, options.spp.value_or(kDefaultMaxSamples), &GlWindow::wake);
    double last_s = window.seconds(), last_new_s = last_s;
    const double begin_s = last_s;
    while (!window.is_closing() && !state.is_closing) {
        if (is_interrupted()) throw Interrupted("interrupted");
        window.begin_frame(state.is_playing ? 1.0 / 60.0 : 0.1);
        const double now_s = window.seconds();
        state.play(std::min(now_s - last_s, 0.25));  // after a stall, the animation goes on from where it was
        last_s = now_s;
        take_picture(renderer, window, state, &last_new_s);
        draw_panels(state);
        renderer.ask(state.request());

        const bool takes_screenshot =
            options.screenshot && now_s - begin_s >= options.screenshot_after_s && state.picture.width > 0;
        window.end_frame(takes_screenshot ? *options.screenshot : "");
        if (takes_screenshot) window.close();
    }
}

}  // namespace zoe
