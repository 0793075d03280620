#pragma once

#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "apps/common/parse.h"

struct GLFWwindow;

namespace zoe {

/// On screens of 96 dots an inch.
constexpr PictureSize kDefaultWindowSize{1280, 720};

/// There is no display, or it cannot show OpenGL; says why.
class NoWindow : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// A key that went down, by GLFW's number, or that the system repeats while it is held down.
struct KeyPress {
    int key = 0;
    bool is_repeated = false;
};

/// A window with OpenGL, Dear ImGui on it, and one texture that holds a picture. One at a time, on the main thread.
class GlWindow {
public:
    /// size       in the screen's pixels; none: kDefaultWindowSize, larger where the screen's pixels are small.
    /// Throws     NoWindow.
    explicit GlWindow(std::optional<PictureSize> size);
    ~GlWindow();
    GlWindow(const GlWindow&) = delete;
    GlWindow& operator=(const GlWindow&) = delete;

    bool is_closing() const;
    void close();
    void hide();
    double seconds() const;  ///< Since the window was made.
    void set_title(const std::string& title);
    /// Those since the last call. (Dear ImGui forgets keys that went up again before its next frame.)
    std::vector<KeyPress> take_keys();
    /// The path of a file that was dropped on the window since the last call; empty: none.
    std::string take_dropped();

    /// Waits for input, `wake`, or the time; then starts the interface's next frame.
    void begin_frame(double wait_s);
    /// Draws what was put on the interface.
    /// screenshot  Where to save it as a PNG file, unless empty.
    void end_frame(const std::filesystem::path& screenshot);

    /// Ends the wait of `begin_frame`; from any thread.
    static void wake();

    /// rgba       [height * width * 4], top row first.
    void set_texture(int width, int height, const uint8_t* rgba);
    unsigned texture() const { return texture_; }

private:
    GLFWwindow* window_ = nullptr;
    unsigned texture_ = 0;
    std::string dropped_;
    std::vector<KeyPress> keys_;
};

}  // namespace zoe
