#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "engine/scene/image.h"
#include "tests/apps/run_program.h"
#include "tests/apps/small_scene.h"

namespace zoe::test {
namespace {

/// Starts the demo's window on a virtual display.
Outcome run_window(const TempFolder& folder, const std::vector<std::string>& options) {
    std::vector<std::string> arguments = {"xvfb-run", "-a", "-s", "-screen 0 800x600x24", ZOETROPE_DEMO, "scene.gltf"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    // The graphics driver never frees some of what it allocates; that is not this program's.
    return run_program(arguments, folder.path(), {"WAYLAND_DISPLAY", "ASAN_OPTIONS=detect_leaks=0"});
}

bool has_xvfb() {
    try {
        return run_program({"xvfb-run", "--help"}, "/").exit_code == 0;
    } catch (const std::runtime_error&) {
        return false;
    }
}

TEST(Window, ShowsThePictureAndThePanel) {
    if (!has_xvfb()) GTEST_SKIP() << "xvfb-run is not installed";
    const TempFolder folder;
    write_small_scene(folder);
    const Outcome outcome =
        run_window(folder, {"--size", "640x400", "--shade", "motion", "--screenshot", "window.png", "--after", "1"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.out << outcome.err;
    const FloatImage image = read_picture(folder / "window.png");
    ASSERT_EQ(image.width, 640);
    ASSERT_EQ(image.height, 400);
    const auto color_count = [&](int x_begin, int x_end) {
        std::vector<std::vector<float>> colors;
        const size_t channels = image.channels.size();
        for (int y = 0; y < image.height; ++y) {
            for (int x = x_begin; x < x_end; ++x) {
                const float* const p = &image.values[(size_t{1} * y * image.width + x) * channels];
                colors.push_back({p[0], p[1], p[2]});
            }
        }
        std::sort(colors.begin(), colors.end());
        return std::unique(colors.begin(), colors.end()) - colors.begin();
    };
    EXPECT_GE(color_count(0, 340), 3);    // two classes and the sky
    EXPECT_GE(color_count(380, 640), 8);  // text, graph, buttons
    EXPECT_FALSE(std::filesystem::exists(folder / "out"));
    EXPECT_FALSE(std::filesystem::exists(folder / "imgui.ini"));
}

bool has_xdotool() {
    try {
        return run_program({"xdotool", "-v"}, "/").exit_code == 0;
    } catch (const std::runtime_error&) {
        return false;
    }
}

/// Starts the demo's window, sends it input, and saves it with F12. The small scene's two triangles face the camera.
/// input      commands of xdotool, one a line. start: the same, before them; paused and at time 0, unless told.
FloatImage window_after(const TempFolder& folder, const std::string& input,
                        const std::string& start = "xdotool key space\nsleep 0.5\nxdotool key Home\nsleep 0.5\n") {
    // On a loaded machine all takes longer: each picture is waited for, and the last of three counts.
    const std::string script = "set -e\n" + std::string(ZOETROPE_DEMO) +
                               " scene.gltf --size 640x400 --shade motion --spp 1 --screenshot end.png --after 40 &\n"
                               "xdotool search --sync --onlyvisible --name Zoetrope >window.txt\n"
                               "sleep 1\n" +
                               start + input +
                               "for k in 0 1 2; do\n"
                               "  sleep 0.5\n  xdotool key F12\n"
                               "  for wait in $(seq 100); do [ -e zoetrope_000$k.png ] || sleep 0.1; done\n"
                               "done\nxdotool key Escape\nwait $!\n";
    folder.write("script.sh", script);
    const Outcome outcome = run_program({"xvfb-run", "-a", "-s", "-screen 0 640x400x24", "sh", "script.sh"}, folder.path(),
                                        {"WAYLAND_DISPLAY", "ASAN_OPTIONS=detect_leaks=0"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.out << outcome.err;
    return read_picture(folder / "zoetrope_0002.png");
}

/// Pixels whose colour is near, in [x_begin, x_end).
int count_color(const FloatImage& image, const glm::vec3& color, int x_begin, int x_end) {
    int count = 0;
    for (int y = 0; y < image.height; ++y) {
        for (int x = x_begin; x < x_end; ++x) {
            const float* const p = &image.values[(size_t{1} * y * image.width + x) * image.channels.size()];
            count += glm::distance(glm::vec3(p[0], p[1], p[2]), color) < 0.02f;
        }
    }
    return count;
}

constexpr glm::vec3 kOutline(1.0f, 160.0f / 255.0f, 0.0f);
constexpr int kRight = 340;  // Left of it is the picture.

/// A command that moves the mouse to where something is seen that is neither sky nor edge: a class's colour with itself all
/// around. The lowest such place: there is the triangle that rests.
std::string move_to_something(const FloatImage& image) {
    const auto color_at = [&](int x, int y) {
        return &image.values[(size_t{1} * y * image.width + x) * image.channels.size()];
    };
    const auto is_same = [&](int x, int y, int dx, int dy) {
        return std::equal(color_at(x, y), color_at(x, y) + 3, color_at(x + dx, y + dy));
    };
    const float* const sky = color_at(12, 12);
    for (int y = 340; y >= 20; --y) {
        for (int x = 20; x < kRight - 20; ++x) {
            const bool is_inside =
                is_same(x, y, 8, 0) && is_same(x, y, -8, 0) && is_same(x, y, 0, 8) && is_same(x, y, 0, -8);
            if (is_inside && !std::equal(sky, sky + 3, color_at(x, y)))
                return "xdotool mousemove " + std::to_string(x) + " " + std::to_string(y) + "\nsleep 0.5\n";
        }
    }
    ADD_FAILURE() << "nothing is seen";
    return "";
}

TEST(Window, AnswersKeysAndClicks) {
    if (!has_xvfb() || !has_xdotool()) GTEST_SKIP() << "xvfb-run or xdotool is not installed";
    const TempFolder plain, clicked, playing, helped;
    for (const TempFolder* folder : {&plain, &clicked, &playing, &helped}) write_small_scene(*folder);
    const FloatImage before = window_after(plain, "");
    EXPECT_EQ(count_color(before, kOutline, 0, kRight), 0);
    const std::string click = move_to_something(before) + "xdotool click 1\n";
    EXPECT_GT(count_color(window_after(clicked, click), kOutline, 0, kRight), 20) << "the picked node's outline";
    EXPECT_GT(count_color(window_after(playing, click + "sleep 1\nxdotool key space\n", ""), kOutline, 0, kRight), 20)
        << "the same, while it plays";
    EXPECT_NE(window_after(helped, "xdotool key F1\n").values, before.values) << "the keys";
}

TEST(Window, StepsByFramesAndTakesAnotherSize) {
    if (!has_xvfb() || !has_xdotool()) GTEST_SKIP() << "xvfb-run or xdotool is not installed";
    const TempFolder plain, stepped, back;
    for (const TempFolder* folder : {&plain, &stepped, &back}) write_small_scene(*folder);
    const std::string steps = "for k in 1 2 3 4 5 6; do xdotool key Right; sleep 0.2; done\n";
    const FloatImage first = window_after(plain, ""), later = window_after(stepped, steps);
    const FloatImage again = window_after(back, steps + "for k in 1 2 3 4 5 6; do xdotool key Left; sleep 0.2; done\n");
    const auto is_same_picture = [](const FloatImage& a, const FloatImage& b) {
        for (int y = 0; y < a.height; ++y) {
            const size_t row = size_t{1} * y * a.width * a.channels.size();
            const auto begin = a.values.begin() + static_cast<ptrdiff_t>(row);
            if (!std::equal(begin, begin + static_cast<ptrdiff_t>(kRight * a.channels.size()),
                            b.values.begin() + static_cast<ptrdiff_t>(row)))
                return false;
        }
        return true;
    };
    EXPECT_FALSE(is_same_picture(first, later)) << "six frames on";
    EXPECT_TRUE(is_same_picture(first, again)) << "six frames on and back";

    const TempFolder resized;
    write_small_scene(resized);
    const FloatImage small = window_after(resized, "xdotool windowsize $(head -n 1 window.txt) 560 360\n");
    EXPECT_EQ(small.width, 560);
    EXPECT_EQ(small.height, 360);
}

TEST(Window, DisplayThatCannotBeOpenedMeansHeadless) {
    const TempFolder folder;
    write_small_scene(folder);
    const Outcome outcome = run_program({ZOETROPE_DEMO, "scene.gltf", "--size", "32x18", "--spp", "1"}, folder.path(),
                                        {"DISPLAY=:4711", "WAYLAND_DISPLAY"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_TRUE(outcome.out.starts_with("no window (")) << outcome.out;
    EXPECT_TRUE(std::filesystem::exists(folder / "out/frame_0000.png"));
}

}  // namespace
}  // namespace zoe::test
