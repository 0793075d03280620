#include <algorithm>
#include <cfloat>
#include <cstdio>
#include <vector>

#include <imgui.h>

#include "apps/common/open_scene.h"
#include "apps/demo/window_panels.h"

namespace zoe {
namespace {

void draw_motion_choice(WindowState& state, const NodeReport& report) {
    const auto forced =
        std::ranges::find(state.motions, state.picked, [](const auto& entry) { return std::optional(entry.first); });
    const bool is_forced = forced != state.motions.end();
    ImGui::SetNextItemWidth(-1.0f);
    if (!ImGui::BeginCombo("##motion", is_forced ? name(forced->second) : "class as the scene says")) return;
    if (ImGui::Selectable("class as the scene says", !is_forced)) state.force_motion({});
    for (int k = static_cast<int>(report.content); k < kMotionCount; ++k) {
        const auto motion = static_cast<Motion>(k);
        if (ImGui::Selectable(name(motion), is_forced && forced->second == motion)) state.force_motion(motion);
    }
    ImGui::EndCombo();
}

}  // namespace

void draw_node(WindowState& state) {
    if (!state.picked) {
        ImGui::TextDisabled("click on something to pick a node");
        return;
    }
    const std::optional<PickedNode>& picked = state.picture.picked;
    if (!picked || picked->node != state.picked) return;  // Its report is on the way.
    const NodeReport& report = picked->report;
    ImGui::Text("node %u  %s", index(picked->node), one_line(picked->name).c_str());
    draw_motion_choice(state, report);
    ImGui::Text("%s; its content is %s", name(report.motion), name(report.content));
    if (!report.has_tree) return;
    ImGui::Text("triangles  %8u  vertices %u", report.triangle_count, report.vertex_count);
    ImGui::TextUnformatted(report.method);
    ImGui::Text("tree       %s, %s", report.is_shared ? "shared" : "its own", name(report.action));
    ImGui::Text("cost       %8.1f tests a ray", report.tree_cost);
    std::vector<float> losses;
    std::string actions;
    for (const WindowState::NodeFrame& frame : state.node_history) {
        losses.push_back(100.0f * frame.loss);
        actions += frame.action == TreeAction::kKept ? '.' : frame.action == TreeAction::kRefitted ? 'f' : 'R';
    }
    if (losses.empty()) return;
    char text[32];
    std::snprintf(text, sizeof text, "loss %.1f %%", losses.back());
    ImGui::PlotLines("##loss", losses.data(), static_cast<int>(losses.size()), 0, text, 0.0f, FLT_MAX,
                     {ImGui::GetContentRegionAvail().x, 3.0f * ImGui::GetFontSize()});
    const size_t room = static_cast<size_t>(ImGui::GetContentRegionAvail().x / ImGui::CalcTextSize("f").x);
    ImGui::TextUnformatted(actions.c_str() + (actions.size() > room ? actions.size() - room : 0));
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("its tree, frame by frame: . kept, f refitted, R rebuilt");
}

}  // namespace zoe
