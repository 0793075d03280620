#include "tests/apps/interface.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <imgui.h>

#include "apps/demo/window_panels.h"
#include "tests/apps/run_program.h"

namespace zoe::test {
namespace {

constexpr double kFrameS = 1.0 / 60.0;

Options options_of(const std::string& scene) {
    Options options;
    options.scene = scene;
    options.shade = Shade::kMotion;
    options.cache.clear();
    return options;
}

}  // namespace

Interface::Interface(const std::string& scene, glm::ivec2 size, float pixels_a_unit)
    : opened_(open(options_of(scene))), state_(first_state(*opened_)) {
    ImGui::CreateContext();
    ImGuiIO& io = ImGui::GetIO();
    io.IniFilename = nullptr;
    io.DeltaTime = static_cast<float>(kFrameS);
    io.DisplaySize = {float(size.x), float(size.y)};
    io.DisplayFramebufferScale = {pixels_a_unit, pixels_a_unit};
    unsigned char* texels = nullptr;
    int width = 0, height = 0;
    io.Fonts->GetTexDataAsAlpha8(&texels, &width, &height);
    renderer_.emplace(opened_->content, 1, [] {});
    frame();
}

Interface::~Interface() {
    renderer_.reset();
    ImGui::DestroyContext();
}

void Interface::frame(const std::vector<KeyPress>& keys) {
    state_.now_s += kFrameS;
    state_.play(kFrameS);
    if (renderer_->take(&state_.picture)) state_.note_picture();
    ImGui::NewFrame();
    draw_panels(state_, keys);
    ImGui::Render();
    renderer_->ask(state_.request());
}

bool Interface::wait(const std::function<bool()>& holds) {
    return wait_until([&] {
        frame();
        return holds();
    });
}

bool Interface::wait_for_picture() {
    return wait([&] {
        const LivePicture& picture = state_.picture;
        const bool is_pick_shown =
            state_.picked ? picture.picked && picture.picked->node == *state_.picked : !picture.picked;
        return picture.is_finished && picture.time_s == state_.time_s && is_pick_shown;
    });
}

/// A letter is two triangles; the first goes from its upper left over its upper right to its lower right corner, and what
/// these have on the font's texture is a glyph's.
void Interface::read(const ImDrawList& list, std::vector<SeenLine>* lines) const {
    struct Letter {
        char letter;
        glm::vec2 place;
        float line, x, advance;
    };
    const ImFont& font = *ImGui::GetFont();
    std::vector<Letter> letters;
    for (const ImDrawCmd& command : list.CmdBuffer) {
        for (unsigned k = 0; k + 2 < command.ElemCount; k += 3) {
            const ImDrawIdx* const corners = &list.IdxBuffer[static_cast<int>(command.IdxOffset + k)];
            const ImDrawVert& a = list.VtxBuffer[static_cast<int>(command.VtxOffset + corners[0])];
            const ImDrawVert& c = list.VtxBuffer[static_cast<int>(command.VtxOffset + corners[2])];
            const glm::vec2 middle((a.pos.x + c.pos.x) / 2.0f, (a.pos.y + c.pos.y) / 2.0f);
            const ImVec4& clip = command.ClipRect;
            if (middle.x < clip.x || middle.x > clip.z || middle.y < clip.y || middle.y > clip.w) continue;
            const auto glyph = std::find_if(font.Glyphs.begin(), font.Glyphs.end(), [&](const ImFontGlyph& entry) {
                return entry.U0 == a.uv.x && entry.V0 == a.uv.y && entry.U1 == c.uv.x && entry.V1 == c.uv.y;
            });
            if (glyph == font.Glyphs.end() || glyph->Codepoint > 126) continue;
            const float scale = (c.pos.x - a.pos.x) / (glyph->X1 - glyph->X0);
            letters.push_back({static_cast<char>(glyph->Codepoint), middle, a.pos.y - scale * glyph->Y0,
                               a.pos.x - scale * glyph->X0, scale * glyph->AdvanceX});
        }
    }
    std::ranges::stable_sort(letters, [](const Letter& a, const Letter& b) {
        return std::pair(std::round(a.line), a.x) < std::pair(std::round(b.line), b.x);
    });
    const Letter* last = nullptr;
    for (const Letter& letter : letters) {
        if (!last || std::round(letter.line) != std::round(last->line)) {
            lines->emplace_back();
        } else {
            const float gap = (letter.x - last->x) / last->advance - 1.0f;
            for (int k = 0; k < static_cast<int>(std::round(gap)); ++k) {
                lines->back().text += ' ';
                lines->back().places.push_back(last->place);
            }
        }
        lines->back().text += letter.letter;
        lines->back().places.push_back(letter.place);
        last = &letter;
    }
}

std::vector<SeenLine> Interface::lines() const {
    std::vector<SeenLine> lines;
    const ImDrawData& drawn = *ImGui::GetDrawData();
    // What is drawn last is in front: of two equal texts, that one is found.
    for (int k = drawn.CmdListsCount; k-- > 0;) read(*drawn.CmdLists[k], &lines);
    return lines;
}

std::string Interface::line(const std::string& beginning) const {
    for (const SeenLine& line : lines()) {
        if (line.text.starts_with(beginning)) return line.text;
    }
    return "";
}

std::optional<glm::vec2> Interface::find(const std::string& text) const {
    for (const SeenLine& line : lines()) {
        const size_t at = line.text.find(text);
        if (at != std::string::npos) return line.places[at + text.size() / 2];
    }
    return std::nullopt;
}

glm::vec2 Interface::picture_corner() const {
    const ImVec2& padding = ImGui::GetStyle().WindowPadding;
    return {padding.x, padding.y};
}

glm::vec2 Interface::picture_size() const {
    return glm::vec2(state_.picture_width, state_.picture_height) / ImGui::GetIO().DisplayFramebufferScale.x;
}

void Interface::move(glm::vec2 place) {
    ImGui::GetIO().MousePos = {place.x, place.y};
    frame();
}

void Interface::click(glm::vec2 place, int button) {
    drag(place, place, button);
}

void Interface::drag(glm::vec2 from, glm::vec2 to, int button, bool with_shift) {
    ImGuiIO& io = ImGui::GetIO();
    io.KeyShift = with_shift;
    move(from);
    io.MouseDown[button] = true;
    frame();
    if (from != to) move(from + 0.5f * (to - from));
    if (from != to) move(to);
    io.MouseDown[button] = false;
    frame();
    io.KeyShift = false;
    frame();
}

void Interface::turn_wheel(float steps) {
    ImGui::GetIO().MouseWheel = steps;
    frame();
}

}  // namespace zoe::test
