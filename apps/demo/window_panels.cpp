#include "apps/demo/window_panels.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <vector>

#include <imgui.h>

#include "apps/demo/window_keys.h"

namespace zoe {
namespace {

constexpr const char* kShadeNames[kShadeCount] = {"path", "albedo", "normal", "motion", "cost"};
constexpr float kClickDistance = 0.25f;  // A button that was moved farther, in letters, was a drag.

constexpr const char* kMouseUses[][2] = {
    {"left drag", "orbit"},
    {"left click", "pick a node; on the sky: none"},
    {"middle drag, shift + drag", "pan"},
    {"wheel", "zoom"},
    {"a file dropped here", "is opened"},
};

/// Orbit, pan and zoom, with the mouse over the picture.
/// height     of the picture, in units of the interface.
void use_mouse(WindowState& state, float height) {
    const ImGuiIO& io = ImGui::GetIO();
    const bool is_turning = ImGui::IsItemActive() && ImGui::IsMouseDragging(ImGuiMouseButton_Left, 1.0f) && !io.KeyShift;
    const bool is_panning = ImGui::IsItemActive() && (ImGui::IsMouseDragging(ImGuiMouseButton_Middle, 1.0f) ||
                                                      (ImGui::IsMouseDragging(ImGuiMouseButton_Left, 1.0f) && io.KeyShift));
    const bool has_moved = io.MouseDelta.x != 0.0f || io.MouseDelta.y != 0.0f;
    if ((is_turning || is_panning) && has_moved) {
        state.free_camera();
        if (is_turning) state.orbit.turn(io.MouseDelta.x, io.MouseDelta.y, height);
        if (is_panning) state.orbit.pan(io.MouseDelta.x, io.MouseDelta.y, height);
    }
    if (ImGui::IsItemHovered() && io.MouseWheel != 0.0f) {
        state.free_camera();
        state.orbit.zoom(io.MouseWheel);
    }
}

void draw_picture(WindowState& state, const ImVec2& size) {
    const ImGuiIO& io = ImGui::GetIO();
    state.picture_width = static_cast<int>(size.x * io.DisplayFramebufferScale.x);
    state.picture_height = static_cast<int>(size.y * io.DisplayFramebufferScale.y);
    const ImVec2 corner = ImGui::GetCursorScreenPos();
    ImGui::InvisibleButton("picture", size, ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonMiddle);
    use_mouse(state, size.y);
    const bool is_click =
        ImGui::IsItemDeactivated() && io.MouseReleased[ImGuiMouseButton_Left] &&
        std::sqrt(io.MouseDragMaxDistanceSqr[ImGuiMouseButton_Left]) < kClickDistance * ImGui::GetFontSize();
    if (is_click) state.pick((io.MousePos.x - corner.x) / size.x, (io.MousePos.y - corner.y) / size.y);
    if (state.picture.width > 0) {
        ImGui::GetWindowDrawList()->AddImage(reinterpret_cast<ImTextureID>(static_cast<uintptr_t>(state.texture)), corner,
                                             {corner.x + size.x, corner.y + size.y});
    }
}

void draw_choices(WindowState& state) {
    ImGui::TextUnformatted("clip");
    ImGui::SetNextItemWidth(-1.0f);
    if (ImGui::BeginCombo("##clip", state.clips[state.clip].name.c_str())) {
        for (size_t i = 0; i < state.clips.size(); ++i) {
            ImGui::PushID(static_cast<int>(i));
            if (ImGui::Selectable(state.clips[i].name.c_str(), i == state.clip)) {
                state.clip = i;
                state.time_s = 0.0;
            }
            ImGui::PopID();
        }
        ImGui::EndCombo();
    }
    ImGui::TextUnformatted("camera");
    ImGui::SetNextItemWidth(-1.0f);
    if (ImGui::BeginCombo("##camera", state.camera < 0 ? "free" : state.cameras[state.camera].name.c_str())) {
        if (ImGui::Selectable("free", state.camera < 0)) state.free_camera();
        for (int i = 0; i < static_cast<int>(state.cameras.size()); ++i) {
            ImGui::PushID(i);
            if (ImGui::Selectable(state.cameras[i].name.c_str(), i == state.camera)) state.camera = i;
            ImGui::PopID();
        }
        ImGui::EndCombo();
    }
    ImGui::TextUnformatted("shade");
    ImGui::SetNextItemWidth(-1.0f);
    int shade = static_cast<int>(state.shade);
    if (ImGui::Combo("##shade", &shade, kShadeNames, kShadeCount)) state.shade = static_cast<Shade>(shade);
}

void draw_rates(const WindowState& state) {
    const LivePicture& picture = state.picture;
    const FrameStats& stats = picture.stats;
    const double rays_a_second = stats.trace_ms > 0.0 ? double(stats.rays) / stats.trace_ms / 1000.0 : 0.0;
    ImGui::Text("new frames %.1f a second", state.is_playing ? state.frames_a_second() : 0.0);
    ImGui::Text("rays       %.2f million a second", rays_a_second);
    ImGui::Text("picture    %dx%d of %dx%d", picture.width, picture.height, state.picture_width, state.picture_height);
    ImGui::Text("light      %dx%d", picture.light_width, picture.light_height);
    ImGui::Text("samples    %d%s", picture.sample_count, picture.is_finished ? ", done" : "");
}

void draw_counts(const WindowState& state) {
    const FrameStats& stats = state.picture.stats;
    ImGui::Text("kept %u  refitted %u  rebuilt %u", stats.kept, stats.refitted, stats.rebuilt);
    for (int i = 0; i < kMotionCount; ++i) ImGui::Text("%-10s %8u nodes", name(static_cast<Motion>(i)), state.node_count[i]);
    ImGui::Text("triangles  %8llu", static_cast<unsigned long long>(state.triangle_count));
}

void draw_timeline(WindowState& state) {
    const double end_s = state.clips[state.clip].duration_s;
    if (ImGui::Button(state.is_playing ? "pause" : "play", {5.0f * ImGui::GetFontSize(), 0.0f}))
        state.is_playing = !state.is_playing;
    ImGui::SameLine();
    ImGui::Checkbox("loop", &state.is_looping);
    ImGui::SameLine();
    ImGui::SetNextItemWidth(-1.0f);
    float time_s = static_cast<float>(state.time_s);
    char format[64];
    std::snprintf(format, sizeof format, "%%.2f of %.2f s, frame %d", end_s, static_cast<int>(state.time_s * state.fps));
    if (ImGui::SliderFloat("##time", &time_s, 0.0f, static_cast<float>(end_s), format, ImGuiSliderFlags_NoInput)) {
        state.time_s = time_s;
        state.is_playing = false;
    }
}

void draw_wrapped(const std::string& text) {
    ImGui::PushTextWrapPos(0.0f);
    ImGui::TextUnformatted(text.c_str());
    ImGui::PopTextWrapPos();
}

void draw_note(const std::string& text) {
    ImGui::Separator();
    draw_wrapped(text);
}

void draw_help(WindowState& state) {
    const ImGuiViewport* const viewport = ImGui::GetMainViewport();
    ImGui::SetNextWindowPos(viewport->GetCenter(), ImGuiCond_Appearing, {0.5f, 0.5f});
    if (ImGui::Begin("keys", &state.is_help_shown, ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoCollapse)) {
        if (ImGui::BeginTable("keys", 2)) {
            const auto row = [](const char* input, const char* what) {
                ImGui::TableNextRow();
                ImGui::TableNextColumn();
                ImGui::TextUnformatted(input);
                ImGui::TableNextColumn();
                ImGui::TextUnformatted(what);
            };
            for (const auto& [input, what] : kMouseUses) row(input, what);
            for (const KeyUse& key : key_uses()) row(key.name, key.what);
            ImGui::EndTable();
        }
    }
    ImGui::End();
}

}  // namespace

void draw_panels(WindowState& state, std::span<const KeyPress> keys) {
    if (!ImGui::GetIO().WantTextInput) {
        for (const KeyPress& key : keys) use_key(state, key);
    }
    const float font = ImGui::GetFontSize();
    const float panel_width = 20.0f * font, timeline_height = ImGui::GetFrameHeightWithSpacing();
    const ImGuiViewport* const viewport = ImGui::GetMainViewport();
    ImGui::SetNextWindowPos(viewport->Pos);
    ImGui::SetNextWindowSize(viewport->Size);
    ImGui::Begin("zoetrope", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoBringToFrontOnFocus |
                     ImGuiWindowFlags_NoNavInputs);
    const ImVec2 room = ImGui::GetContentRegionAvail();
    const float gap = ImGui::GetStyle().ItemSpacing.x;
    const ImVec2 picture_size(std::max(1.0f, room.x - panel_width - gap), std::max(1.0f, room.y - timeline_height));

    ImGui::BeginGroup();
    draw_picture(state, picture_size);
    ImGui::EndGroup();
    ImGui::SameLine();
    ImGui::BeginChild("panel", {panel_width, picture_size.y});
    draw_wrapped(state.scene_name);
    ImGui::TextDisabled("F1 shows the keys");
    if (!state.opening.empty()) draw_note("opening " + state.opening);
    if (!state.message.empty()) draw_note(state.message);
    ImGui::Separator();
    draw_rates(state);
    ImGui::Separator();
    draw_choices(state);
    ImGui::Separator();
    draw_node(state);
    ImGui::Separator();
    draw_stage_graph(state.history);
    ImGui::Separator();
    draw_counts(state);
    ImGui::EndChild();
    draw_timeline(state);
    ImGui::End();
    if (state.is_help_shown) draw_help(state);
}

}  // namespace zoe
