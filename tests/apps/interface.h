#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <glm/vec2.hpp>

#include "apps/demo/gl_window.h"
#include "apps/demo/window_state.h"

struct ImDrawList;

namespace zoe::test {

/// A line of letters that lie on top of no other window's.
struct SeenLine {
    std::string text;               ///< Gaps of a letter or more are spaces.
    std::vector<glm::vec2> places;  ///< Of the letters' middles, in pixels.
};

/// The demo's interface on a scene, with the renderer beside it, but without a window: it is given input, and what it draws
/// is read letter by letter. Its clock goes on by a 60th of a second a frame.
class Interface {
public:
    /// scene          as on the command line.
    /// pixels_a_unit  more than 1 where the system scales windows.
    explicit Interface(const std::string& scene, glm::ivec2 size = {1000, 900}, float pixels_a_unit = 1.0f);
    ~Interface();
    Interface(const Interface&) = delete;
    Interface& operator=(const Interface&) = delete;

    WindowState& state() { return state_; }
    const Scene& scene() const { return opened_->content.scene; }

    /// Draws a frame.
    /// keys       that went down before it, or were repeated.
    void frame(const std::vector<KeyPress>& keys = {});
    /// Draws frames until it holds.
    /// Returns    false where it does not within a minute.
    bool wait(const std::function<bool()>& holds);
    /// Waits for a picture of what is asked for now.
    bool wait_for_picture();

    /// Letters of the last frame, line by line.
    std::vector<SeenLine> lines() const;
    /// The first line that begins with it; empty: none.
    std::string line(const std::string& beginning) const;
    /// Where a text is; none: nowhere.
    std::optional<glm::vec2> find(const std::string& text) const;

    /// Where the picture lies, in units.
    glm::vec2 picture_corner() const;
    glm::vec2 picture_size() const;

    void move(glm::vec2 place);
    /// button     0 left, 2 middle.
    void click(glm::vec2 place, int button = 0);
    void drag(glm::vec2 from, glm::vec2 to, int button = 0, bool with_shift = false);
    void turn_wheel(float steps);

private:
    void read(const ImDrawList& list, std::vector<SeenLine>* lines) const;

    std::unique_ptr<Opened> opened_;
    WindowState state_;
    std::optional<LiveRenderer> renderer_;
};

}  // namespace zoe::test
