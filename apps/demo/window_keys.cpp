#include "apps/demo/window_keys.h"

#include <GLFW/glfw3.h>

namespace zoe {
namespace {

void next_camera(WindowState& state) {
    if (state.camera + 1 < static_cast<int>(state.cameras.size())) {
        ++state.camera;
    } else {
        state.free_camera();
    }
}

void first_view(WindowState& state) {
    state.orbit = state.first_orbit;
    state.camera = -1;
}

constexpr KeyUse kUses[] = {
    {GLFW_KEY_SPACE, GLFW_KEY_SPACE, "space", "play, pause",
     [](WindowState& state, int) { state.is_playing = !state.is_playing; }},
    {GLFW_KEY_LEFT, GLFW_KEY_LEFT, "left", "one frame back", [](WindowState& state, int) { state.step(-1); }, true},
    {GLFW_KEY_RIGHT, GLFW_KEY_RIGHT, "right", "one frame on", [](WindowState& state, int) { state.step(1); }, true},
    {GLFW_KEY_HOME, GLFW_KEY_HOME, "home", "to the start", [](WindowState& state, int) { state.time_s = 0.0; }},
    {GLFW_KEY_1, GLFW_KEY_1 + kShadeCount - 1, "1 to 5", "shade: path, albedo, normal, motion, cost",
     [](WindowState& state, int offset) { state.shade = static_cast<Shade>(offset); }},
    {GLFW_KEY_C, GLFW_KEY_C, "C", "next camera", [](WindowState& state, int) { next_camera(state); }},
    {GLFW_KEY_R, GLFW_KEY_R, "R", "the first view again", [](WindowState& state, int) { first_view(state); }},
    {GLFW_KEY_F12, GLFW_KEY_F12, "F12", "save the window as a picture",
     [](WindowState& state, int) { state.saves_picture = true; }},
    {GLFW_KEY_F1, GLFW_KEY_F1, "F1", "these keys",
     [](WindowState& state, int) { state.is_help_shown = !state.is_help_shown; }},
    {GLFW_KEY_ESCAPE, GLFW_KEY_ESCAPE, "escape", "close", [](WindowState& state, int) { state.is_closing = true; }},
};

}  // namespace

std::span<const KeyUse> key_uses() {
    return kUses;
}

void use_key(WindowState& state, const KeyPress& press) {
    for (const KeyUse& entry : kUses) {
        if (press.key < entry.first || press.key > entry.last || (press.is_repeated && !entry.is_repeated)) continue;
        entry.use(state, press.key - entry.first);
    }
}

}  // namespace zoe
