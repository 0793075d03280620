#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include <gtest/gtest.h>

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
