// The demo's window on a virtual screen: it is sent input, and what it shows is looked at.

#include <algorithm>
#include <filesystem>
#include <memory>
#include <set>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <glm/common.hpp>
#include <glm/vec2.hpp>

#include "engine/scene/image.h"
#include "tests/apps/small_scene.h"
#include "tests/apps/virtual_screen.h"

namespace zoe::test {
namespace {

constexpr uint32_t kOutline = 0xffa000;

std::string places_that_differ(const Screenful& a, const Screenful& b) {
    glm::ivec2 low(a.width, a.height), high(-1);
    for (int y = 0; y < a.height; ++y) {
        for (int x = 0; x < a.width; ++x) {
            if (a.at(x, y) == b.at(x, y)) continue;
            low = glm::min(low, {x, y});
            high = glm::max(high, {x, y});
        }
    }
    return fmt::format("columns {} to {}, rows {} to {}", low.x, high.x, low.y, high.y);
}

/// The small scene in a window that fills a screen; its two triangles face the camera.
class ShownWindow {
public:
    const int width, height;
    const TempFolder folder;
    const VirtualScreen screen;

    /// dots           an inch of the screen has.
    /// repeats_keys   VirtualScreen::VirtualScreen.
    explicit ShownWindow(int w = 640, int h = 400, int dots = 96, bool repeats_keys = false)
        : width(w),
          height(h),
          screen(w, h, repeats_keys),
          picture_width_(w - 284 * dots / 96),
          picture_height_(h - 39 * dots / 96) {
        write_small_scene(folder);
        set_dots_per_inch(screen.display(), dots);
    }

    void start(const std::string& scene = "scene.gltf", const std::vector<std::string>& options = {"--shade", "motion"}) {
        std::vector<std::string> arguments = {scene, "--spp", "1", "--size",
                                              std::to_string(width) + "x" + std::to_string(height)};
        arguments.insert(arguments.end(), options.begin(), options.end());
        program_ = std::make_unique<RunningProgram>(demo_command(arguments), folder.path(), environment());
    }
    std::vector<std::string> environment() const {
        std::vector<std::string> all = screen.environment();
        all.push_back("ASAN_OPTIONS=detect_leaks=0");  // The graphics driver never frees some of what it allocates.
        return all;
    }
    RunningProgram& program() { return *program_; }

    /// The part of the screen where the picture is, without what its edges may share with other things.
    Screenful picture() const { return screen.read().part(kEdge, kEdge, picture_width_ - kEdge, picture_height_ - kEdge); }
    bool wait(const std::function<bool(const Screenful& picture)>& holds) const {
        return wait_until([&] { return holds(picture()); });
    }
    /// Stops the animation at time 0, and waits until nothing moves any more.
    Screenful rest() {
        EXPECT_TRUE(wait([](const Screenful& shown) { return shown.color_count() >= 3; })) << "two classes and the sky";
        screen.send({"mousemove", "20", "20", "key", "Right", "Home"});
        Screenful last = screen.read(), changed = last;
        int same_count = 0;
        const bool rests = wait_until([&] {
            const Screenful now = screen.read();
            same_count = now == last ? same_count + 1 : 0;
            if (now != last) changed = std::exchange(last, now);
            return same_count == 30;
        });
        EXPECT_TRUE(rests) << "changed last: " << places_that_differ(changed, last);
        return picture();
    }

    /// Where something that is not the sky is seen with its colour all around: the lowest such place, or the highest.
    /// There is the triangle that rests, or the one that turns.
    static glm::ivec2 find_resting(const Screenful& shown) { return find(shown, true); }
    static glm::ivec2 find_turning(const Screenful& shown) { return find(shown, false); }
    /// place      in the picture.
    void click(glm::ivec2 place) const {
        screen.send({"mousemove", std::to_string(place.x + kEdge), std::to_string(place.y + kEdge), "click", "1"});
    }

private:
    static constexpr int kEdge = 20;

    static glm::ivec2 find(const Screenful& shown, bool is_from_below) {
        for (int row = 8; row < shown.height - 8; ++row) {
            const int y = is_from_below ? shown.height - 1 - row : row;
            for (int x = 8; x < shown.width - 8; ++x) {
                const uint32_t color = shown.at(x, y);
                const bool is_inside = color == shown.at(x - 8, y) && color == shown.at(x + 8, y) &&
                                       color == shown.at(x, y - 8) && color == shown.at(x, y + 8);
                if (is_inside && !is_near(color, shown.at(0, 0))) return {x, y};
            }
        }
        throw std::runtime_error("nothing is seen");
    }

    int picture_width_, picture_height_;
    std::unique_ptr<RunningProgram> program_;
};

class Window : public testing::Test {
protected:
    void SetUp() override {
        if (!VirtualScreen::is_there()) GTEST_SKIP() << "Xvfb or xdotool is not installed";
    }
};

TEST_F(Window, ShowsThePictureAndThePanel) {
    const ShownWindow window;
    const Outcome outcome = run_program(demo_command({"scene.gltf", "--size", "640x400", "--shade", "motion", "--screenshot",
                                                      "window.png", "--after", "0.5"}),
                                        window.folder.path(), window.environment());
    ASSERT_EQ(outcome.exit_code, 0) << outcome.out << outcome.err;
    const FloatImage image = read_picture(window.folder / "window.png");
    ASSERT_EQ(image.width, 640);
    ASSERT_EQ(image.height, 400);
    const auto color_count = [&](int x_begin, int x_end) {
        std::set<std::vector<float>> colors;
        for (int y = 0; y < image.height; ++y) {
            for (int x = x_begin; x < x_end; ++x) {
                const float* const p = &image.values[(size_t{1} * y * image.width + x) * image.channels.size()];
                colors.insert({p[0], p[1], p[2]});
            }
        }
        return colors.size();
    };
    EXPECT_GE(color_count(0, 340), 3u);    // two classes and the sky
    EXPECT_GE(color_count(380, 640), 8u);  // text, graph, buttons
    EXPECT_FALSE(std::filesystem::exists(window.folder / "out"));
    EXPECT_FALSE(std::filesystem::exists(window.folder / "imgui.ini"));
}

TEST_F(Window, AnswersKeysAndClicks) {
    ShownWindow window;
    window.start();
    const Screenful before = window.rest();
    EXPECT_EQ(before.count(kOutline), 0);
    window.click(window.find_resting(before));
    const auto is_outlined = [](const Screenful& shown) { return shown.count(kOutline) > 20; };
    EXPECT_TRUE(window.wait(is_outlined)) << "the picked node's outline";
    const Screenful picked = window.picture();
    window.screen.send({"key", "space"});
    EXPECT_TRUE(window.wait([&](const Screenful& shown) { return shown != picked; })) << "it plays";
    window.screen.send({"key", "space"});
    // While it plays, its few pixels are stretched, and with them the outline's colour.
    EXPECT_TRUE(window.wait(is_outlined)) << "the same node";
    window.screen.send({"mousemove", "20", "20", "click", "1"});
    EXPECT_TRUE(window.wait([](const Screenful& shown) { return shown.count(kOutline) == 0; })) << "no node: the sky";
    window.screen.send({"key", "Home"});
    EXPECT_TRUE(window.wait([&](const Screenful& shown) { return shown == before; })) << "the start again";
    window.screen.send({"key", "F1"});
    EXPECT_TRUE(window.wait([&](const Screenful& shown) { return shown != before; })) << "the keys";
    window.screen.send({"key", "F1"});
    EXPECT_TRUE(window.wait([&](const Screenful& shown) { return shown == before; }));
    window.screen.send({"key", "Escape"});
    const Outcome outcome = window.program().wait();
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
}

TEST_F(Window, StepsByFramesAndTakesAnotherSize) {
    ShownWindow window;
    window.start();
    const Screenful first = window.rest();
    window.screen.send({"key", "Right", "Right", "Right", "Right", "Right", "Right"});
    EXPECT_TRUE(window.wait([&](const Screenful& shown) { return shown != first; })) << "six frames on";
    window.screen.send({"key", "Left", "Left", "Left", "Left", "Left", "Left"});
    EXPECT_TRUE(window.wait([&](const Screenful& shown) { return shown == first; })) << "and back";

    const auto size_of_screenshot = [&](const std::string& file) {
        window.screen.send({"key", "F12"});
        EXPECT_TRUE(wait_until([&] { return std::filesystem::exists(window.folder / file); }));
        const FloatImage image = read_picture(window.folder / file);
        return std::pair(image.width, image.height);
    };
    EXPECT_EQ(size_of_screenshot("zoetrope_0000.png"), std::pair(640, 400));
    window.screen.send({"search", "--name", "Zoetrope", "windowsize", "--sync", "560", "360"});
    EXPECT_EQ(size_of_screenshot("zoetrope_0001.png"), std::pair(560, 360));
}

TEST_F(Window, SavesOnePictureHoweverLongTheKeyIsHeld) {
    ShownWindow window(640, 400, 96, true);
    window.start();
    window.rest();
    window.screen.send({"keydown", "F12", "sleep", "1.5", "keyup", "F12", "keydown", "Right"});
    std::set<std::vector<uint32_t>> pictures;
    const auto are_many = [&](const Screenful& shown) {
        pictures.insert(shown.pixels);
        return pictures.size() > 8;  // more than one step's, which get finer
    };
    EXPECT_TRUE(window.wait(are_many)) << "this one is repeated";
    window.screen.send({"keyup", "Right", "key", "Escape"});
    EXPECT_EQ(window.program().wait().exit_code, 0);
    EXPECT_TRUE(std::filesystem::exists(window.folder / "zoetrope_0000.png"));
    EXPECT_FALSE(std::filesystem::exists(window.folder / "zoetrope_0001.png"));
}

TEST_F(Window, OpensWhatIsDroppedOnIt) {
    ShownWindow window;
    auto other = small_scene();
    other["scenes"][0]["nodes"] = {1, 2};  // what turns is not there
    other.erase("animations");
    window.folder.write("other.gltf", other.dump());
    window.folder.write("broken.gltf", "{");
    window.start();
    const Screenful before = window.rest();
    const glm::ivec2 resting = window.find_resting(before), turning = window.find_turning(before);
    const auto drop = [&](const std::string& file) {
        return drop_file(window.screen.display(), "Zoetrope: ", window.folder / file);
    };

    ASSERT_EQ(drop("broken.gltf"), "");
    EXPECT_TRUE(wait_until([&] { return window.program().err().find("broken.gltf") != std::string::npos; }));
    EXPECT_EQ(window.picture(), before);
    window.screen.send({"key", "Right", "Right", "Right", "Right", "Right", "Right"});
    EXPECT_TRUE(window.wait([&](const Screenful& shown) { return shown != before; })) << "it is still there";

    ASSERT_EQ(drop("other.gltf"), "");
    EXPECT_TRUE(window.wait([&](const Screenful& shown) {
        return is_near(shown.at(resting.x, resting.y), before.at(resting.x, resting.y)) &&
               is_near(shown.at(turning.x, turning.y), before.at(0, 0));
    }));
    EXPECT_NO_THROW(window.screen.send({"search", "--name", "other.gltf"})) << "the title";
    window.screen.send({"key", "Escape"});
    EXPECT_EQ(window.program().wait().exit_code, 0);
}

/// Twice the dots an inch: letters are twice as large, and so is the window, unless its size is told.
TEST_F(Window, FillsFineScreens) {
    ShownWindow window(1280, 800, 192);
    window.start();
    const Screenful before = window.rest();
    const glm::ivec2 place = window.find_resting(before);
    window.click(place);
    ASSERT_TRUE(window.wait([](const Screenful& shown) { return shown.count(kOutline) > 20; }));
    const Screenful picked = window.picture();
    for (const int step : {-1, 1}) {
        int x = place.x;
        while (x > 0 && x + 1 < picked.width && is_near(picked.at(x, place.y), before.at(place.x, place.y))) x += step;
        EXPECT_TRUE(is_near(picked.at(x, place.y), kOutline)) << "what was clicked is what is outlined";
    }
    window.screen.send({"key", "Escape"});
    EXPECT_EQ(window.program().wait().exit_code, 0);

    const Outcome outcome = run_program(
        demo_command({"scene.gltf", "--shade", "motion", "--spp", "1", "--screenshot", "window.png", "--after", "0"}),
        window.folder.path(), window.environment());
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    const FloatImage image = read_picture(window.folder / "window.png");
    EXPECT_EQ(image.width, 2 * 1280);
    EXPECT_EQ(image.height, 2 * 720);
}

/// Scenes are opened beside the window: it answers before the first one is there, and does not wait for it when it is
/// closed.
TEST_F(Window, AnswersWhileItOpensAScene) {
    ShownWindow window;
    window.start("static-1000000", {"--cache", "trees"});
    EXPECT_TRUE(window.wait([](const Screenful& shown) { return shown.at(0, 0) != 0; }));
    const Screenful empty = window.picture();
    ASSERT_EQ(empty.color_count(), 1);
    window.screen.send({"mousemove", "20", "20", "key", "F1"});
    EXPECT_TRUE(window.wait([&](const Screenful& shown) { return shown != empty; }));
    EXPECT_EQ(window.picture().at(0, 0), empty.at(0, 0)) << "the picture is not there yet";
    window.screen.send({"key", "Escape"});
    EXPECT_EQ(window.program().wait().exit_code, 0);
    if (!std::filesystem::exists(window.folder / "trees")) return;
    for (const auto& tree : std::filesystem::directory_iterator(window.folder / "trees"))
        EXPECT_LT(tree.file_size(), 5u << 20) << "the tree of its million triangles was built even so";
}

TEST(WindowOrNot, DisplayThatCannotBeOpenedMeansHeadless) {
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
