#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "tests/apps/run_program.h"

namespace zoe::test {

/// Colours that differ by no more than rounding.
bool is_near(uint32_t a, uint32_t b);

/// What a screen shows, or a part of that.
struct Screenful {
    int width = 0, height = 0;
    std::vector<uint32_t> pixels;  ///< [height * width] 0xRRGGBB, top row first.

    uint32_t at(int x, int y) const { return pixels[size_t{1} * y * width + x]; }
    /// Columns and rows [begin, end).
    Screenful part(int x_begin, int y_begin, int x_end, int y_end) const;
    int count(uint32_t color) const;  ///< Of its pixels, and those near it.
    int color_count() const;

    friend bool operator==(const Screenful&, const Screenful&) = default;
};

/// A screen without a device: a window is looked at and given input as by a user.
class VirtualScreen {
public:
    /// Whether Xvfb and xdotool are installed.
    static bool is_there();

    /// repeats_keys   that are held down, as other screens do: who waits between down and up types more than one.
    VirtualScreen(int width, int height, bool repeats_keys = false);
    ~VirtualScreen();
    VirtualScreen(const VirtualScreen&) = delete;
    VirtualScreen& operator=(const VirtualScreen&) = delete;

    /// What a program's environment needs to show a window there.
    std::vector<std::string> environment() const;
    const std::string& display() const { return display_; }

    Screenful read() const;
    /// Sends commands of xdotool: {"key", "space"}, {"mousemove", "20", "30", "click", "1"}.
    void send(std::vector<std::string> commands) const;

private:
    const TempFolder folder_;
    std::unique_ptr<RunningProgram> server_;
    std::string display_;
};

/// Drops a file on the window whose title begins so, as another program's window does.
/// Returns    what went wrong; empty: the window took it.
std::string drop_file(const std::string& display, const std::string& title, const std::string& file);

/// Tells programs that start later how many dots an inch has; 96 is usual.
void set_dots_per_inch(const std::string& display, int dots);

}  // namespace zoe::test
