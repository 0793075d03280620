#include <algorithm>
#include <cmath>
#include <cstdio>

#include <imgui.h>

#include "apps/demo/window_panels.h"

namespace zoe {
namespace {

struct Stage {
    const char* name;
    double FrameStats::*ms;
    ImU32 color;
};

constexpr Stage kStages[] = {
    {"animate", &FrameStats::animate_ms, IM_COL32(120, 200, 255, 255)},
    {"deform", &FrameStats::deform_ms, IM_COL32(120, 230, 120, 255)},
    {"update_blas", &FrameStats::update_blas_ms, IM_COL32(255, 210, 90, 255)},
    {"build_tlas", &FrameStats::build_tlas_ms, IM_COL32(255, 130, 200, 255)},
    {"trace", &FrameStats::trace_ms, IM_COL32(255, 110, 80, 255)},
};

// Stages differ a thousandfold: a logarithmic scale shows all five.
constexpr double kLeastMs = 0.001, kMostMs = 10000.0;

/// 0 at the bottom of the graph, 1 at its top.
float height_of(double ms) {
    const double clamped = std::clamp(ms, kLeastMs, kMostMs);
    return static_cast<float>(std::log(clamped / kLeastMs) / std::log(kMostMs / kLeastMs));
}

}  // namespace

void draw_stage_graph(const std::deque<FrameStats>& history) {
    const float font = ImGui::GetFontSize();
    const ImVec2 corner = ImGui::GetCursorScreenPos();
    const ImVec2 size(ImGui::GetContentRegionAvail().x, 10.0f * font);
    ImDrawList* const draw = ImGui::GetWindowDrawList();
    draw->AddRectFilled(corner, {corner.x + size.x, corner.y + size.y}, IM_COL32(20, 20, 24, 255));
    for (double ms = 0.01; ms < kMostMs; ms *= 10.0) {
        const float y = corner.y + size.y * (1.0f - height_of(ms));
        draw->AddLine({corner.x, y}, {corner.x + size.x, y}, IM_COL32(60, 60, 66, 255));
        char label[32];
        std::snprintf(label, sizeof label, "%g ms", ms);
        draw->AddText({corner.x + 3.0f, y - font}, IM_COL32(120, 120, 128, 255), label);
    }
    const float step = size.x / static_cast<float>(WindowState::kHistorySize - 1);
    for (const Stage& stage : kStages) {
        for (size_t i = 1; i < history.size(); ++i) {
            const float x = corner.x + size.x - step * static_cast<float>(history.size() - 1 - i);
            const float y0 = corner.y + size.y * (1.0f - height_of(history[i - 1].*stage.ms));
            const float y1 = corner.y + size.y * (1.0f - height_of(history[i].*stage.ms));
            draw->AddLine({x - step, y0}, {x, y1}, stage.color, 1.5f);
        }
    }
    ImGui::Dummy(size);
    for (const Stage& stage : kStages) {
        ImGui::TextColored(ImGui::ColorConvertU32ToFloat4(stage.color), "%-12s", stage.name);
        ImGui::SameLine();
        if (history.empty()) {
            ImGui::TextUnformatted("-");
        } else {
            ImGui::Text("%9.3f ms", history.back().*stage.ms);
        }
    }
}

}  // namespace zoe
