#include "apps/demo/window.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include <fmt/format.h>

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
    state.grade = options.grade;
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
    state.note_picture();
    if (!state.picture.is_new_frame) return;
    const double elapsed_s = window.seconds() - *last_new_s;
    *last_new_s = window.seconds();
    const double rate = elapsed_s > 1e-6 ? 1.0 / elapsed_s : 0.0;
    state.frames_a_second = state.frames_a_second > 0.0 ? 0.9 * state.frames_a_second + 0.1 * rate : rate;
}

/// The first name of its kind that is free in the current folder.
std::filesystem::path free_name() {
    for (int k = 0;; ++k) {
        const std::filesystem::path file = fmt::format("zoetrope_{:04}.png", k);
        if (!std::filesystem::exists(file)) return file;
    }
}

void end_frame(GlWindow& window, WindowState& state) {
    if (!std::exchange(state.saves_picture, false)) return window.end_frame("");
    const std::filesystem::path file = free_name();
    try {
        window.end_frame(file);
        state.message = fmt::format("saved {}", file.native());
    } catch (const std::runtime_error& error) {
        state.message = one_line(error.what());
    }
}

}  // namespace

PictureSize first_window_size(const Options& options) {
    return options.size.value_or(kDefaultSize);
}

std::string run_window(GlWindow& window, Content& content, const Options& options, const std::string& message) {
    window.set_title("Zoetrope: " + one_line(options.scene));
    WindowState state = first_state(content, options);
    state.texture = window.texture();
    state.message = message;

    catch_interrupts();
    LiveRenderer renderer(content, options.spp.value_or(kDefaultMaxSamples), &GlWindow::wake);
    double last_s = window.seconds(), last_new_s = last_s;
    const double begin_s = last_s;
    while (!window.is_closing() && !state.is_closing) {
        if (std::string dropped = window.take_dropped(); !dropped.empty()) return dropped;
        if (is_interrupted()) throw Interrupted("interrupted");
        window.begin_frame(state.is_playing ? 1.0 / 60.0 : 0.1);
        const double now_s = window.seconds();
        state.play(std::min(now_s - last_s, 0.25));  // after a stall, the animation goes on from where it was
        last_s = now_s;
        take_picture(renderer, window, state, &last_new_s);
        draw_panels(state, window.take_keys());
        renderer.ask(state.request());

        const bool takes_screenshot =
            options.screenshot && now_s - begin_s >= options.screenshot_after_s && state.picture.width > 0;
        if (takes_screenshot) {
            window.end_frame(*options.screenshot);
            window.close();
        } else {
            end_frame(window, state);
        }
    }
    return "";
}

}  // namespace zoe
