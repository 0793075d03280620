// What the demo's interface says, and what it does when it is clicked on.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <set>

#include <gtest/gtest.h>

#include "apps/demo/window_keys.h"
#include "tests/apps/interface.h"
#include "tests/apps/small_scene.h"

namespace zoe::test {
namespace {

/// What a user may change.
auto choices(const WindowState& state) {
    const Orbit& orbit = state.orbit;
    return std::tuple(state.is_playing, state.time_s, state.shade, state.camera, orbit.yaw, orbit.pitch, orbit.distance,
                      orbit.target.x, orbit.target.y, state.is_help_shown, state.saves_picture, state.is_closing,
                      state.picked, state.clip, state.is_looping, state.motions);
}

/// A state in which every key has something to do.
void set_up(WindowState& state) {
    state.is_playing = false;
    state.time_s = 0.5;
    state.camera = -1;
    state.orbit.yaw = 1.0f;
    state.is_help_shown = state.saves_picture = state.is_closing = false;
}

TEST(Panels, EveryKeyOfTheHelpWorksAndNoOther) {
    const TempFolder folder;
    write_small_scene(folder);
    Interface interface(folder / "scene.gltf");
    WindowState& state = interface.state();
    std::set<int> listed;
    for (const KeyUse& use : key_uses()) {
        for (int key = use.first; key <= use.last; ++key) {
            EXPECT_TRUE(listed.insert(key).second) << use.name << " does two things";
            set_up(state);
            state.shade = static_cast<Shade>((key - use.first + 1) % kShadeCount);
            const auto before = choices(state);
            interface.frame({KeyPress{key}});
            EXPECT_NE(choices(state), before) << use.name;
        }
    }
    set_up(state);
    const auto before = choices(state);
    for (int key = -1; key < 512; ++key) {
        if (!listed.contains(key)) interface.frame({KeyPress{key}});
    }
    EXPECT_EQ(choices(state), before);

    EXPECT_FALSE(interface.find("play, pause"));
    constexpr int kF1 = 290;
    ASSERT_TRUE(listed.contains(kF1));
    interface.frame({KeyPress{kF1}});
    interface.frame();  // It finds its size first.
    for (const KeyUse& use : key_uses()) {
        const auto tells_it = [&](const SeenLine& line) {
            return line.text.starts_with(use.name + std::string(" ")) && line.text.ends_with(std::string(" ") + use.what);
        };
        EXPECT_TRUE(std::ranges::any_of(interface.lines(), tells_it)) << use.name;
    }
    interface.frame({KeyPress{kF1}});
    interface.frame();
    EXPECT_FALSE(interface.find("play, pause"));
}

TEST(Panels, KeysDoWhatTheirNamesSay) {
    const TempFolder folder;
    write_small_scene(folder);
    Interface interface(folder / "scene.gltf");
    WindowState& state = interface.state();
    const auto press = [&](const std::string& name, int offset = 0) {
        for (const KeyUse& use : key_uses()) {
            if (use.name == name) interface.frame({KeyPress{use.first + offset}});
        }
    };
    ASSERT_EQ(state.camera, 0) << "the file's";
    ASSERT_TRUE(state.is_playing);
    press("space");
    EXPECT_FALSE(state.is_playing);
    press("home");
    EXPECT_EQ(state.time_s, 0.0);
    for (int k = 0; k < 5; ++k) press("right");
    EXPECT_EQ(state.time_s, 5.0 / 24.0);
    press("left");
    EXPECT_EQ(state.time_s, 4.0 / 24.0);
    for (int k = 0; k < kShadeCount; ++k) {
        press("1 to 5", k);
        EXPECT_EQ(static_cast<int>(state.shade), k);
    }
    press("C");
    EXPECT_EQ(state.camera, -1) << "the free one, after the file's last";
    press("C");
    EXPECT_EQ(state.camera, 0);
    press("space");
    EXPECT_TRUE(state.is_playing);
    interface.frame();
    EXPECT_GT(state.time_s, 4.0 / 24.0);
}

/// Systems repeat what is held down, many times a second: that steps on, and switches nothing.
TEST(Panels, HeldKeysOnlyStep) {
    const TempFolder folder;
    write_small_scene(folder);
    Interface interface(folder / "scene.gltf");
    WindowState& state = interface.state();
    for (const KeyUse& use : key_uses()) {
        const std::string name = use.name;
        set_up(state);
        state.shade = Shade::kNormal;
        const auto before = choices(state);
        interface.frame({KeyPress{use.first, true}});
        EXPECT_EQ(choices(state) != before, name == "left" || name == "right") << name;
    }
}

/// Where a node is seen with itself around; none: nowhere.
std::optional<glm::vec2> place_of(Interface& interface, NodeId node) {
    const LivePicture& picture = interface.state().picture;
    const glm::vec2 room = interface.picture_size();
    for (int y = 4; y + 4 < picture.height; ++y) {
        for (int x = 4; x + 4 < picture.width; ++x) {
            const auto is_it = [&](int dx, int dy) {
                return picture.nodes[size_t{1} * (y + dy) * picture.width + x + dx] == node;
            };
            if (is_it(0, 0) && is_it(4, 0) && is_it(-4, 0) && is_it(0, 4) && is_it(0, -4)) {
                const glm::vec2 share((float(x) + 0.5f) / float(picture.width), (float(y) + 0.5f) / float(picture.height));
                return interface.picture_corner() + share * room;
            }
        }
    }
    return std::nullopt;
}

TEST(Panels, AClickPicksWhatIsSeenThereAndTheMouseMovesTheCamera) {
    const TempFolder folder;
    write_small_scene(folder);
    for (const float pixels_a_unit : {1.0f, 2.0f}) {
        SCOPED_TRACE(pixels_a_unit);
        Interface interface(folder / "scene.gltf", {600, 400}, pixels_a_unit);
        WindowState& state = interface.state();
        state.is_playing = false;
        state.time_s = 0.0;
        ASSERT_TRUE(interface.wait_for_picture());
        EXPECT_EQ(state.picture.width, state.picture_width);
        EXPECT_EQ(state.picture_width, static_cast<int>(pixels_a_unit * (600 - 16 - 8 - 20 * 13)));
        for (const NodeId node : {NodeId{0}, NodeId{1}, kNone<NodeId>}) {
            const std::optional<glm::vec2> place = place_of(interface, node);
            ASSERT_TRUE(place);
            interface.click(*place);
            EXPECT_EQ(state.picked, node == kNone<NodeId> ? std::nullopt : std::optional(node));
            ASSERT_TRUE(interface.wait_for_picture());
        }

        const glm::vec2 middle = interface.picture_corner() + 0.5f * interface.picture_size();
        interface.drag(middle, middle + glm::vec2(30, 10));
        EXPECT_EQ(state.camera, -1);
        const Orbit turned = state.orbit;
        EXPECT_NE(turned.yaw, state.first_orbit.yaw);
        EXPECT_NE(turned.pitch, state.first_orbit.pitch);
        interface.drag(middle, middle + glm::vec2(30, 0), 0, true);
        EXPECT_EQ(state.orbit.yaw, turned.yaw);
        const float shifted = state.orbit.target.x;
        EXPECT_NE(shifted, turned.target.x);
        interface.drag(middle, middle + glm::vec2(30, 0), 2);
        EXPECT_NE(state.orbit.target.x, shifted);
        interface.turn_wheel(2.0f);
        EXPECT_LT(state.orbit.distance, turned.distance);
        EXPECT_FALSE(state.picked) << "a drag is no click";
    }
}

/// The number that follows a word.
double number_after(const std::string& line, const std::string& word) {
    const size_t at = line.find(word);
    double number = NAN;
    if (at != std::string::npos) std::sscanf(line.c_str() + at + word.size(), "%lf", &number);
    return number;
}

TEST(Panels, ThePickedNodeIsDescribed) {
    Interface interface("deforming-24");
    WindowState& state = interface.state();
    ASSERT_TRUE(interface.find("click on something"));
    ASSERT_TRUE(interface.wait([&] { return state.picture.width > 0; }));
    interface.click(interface.picture_corner() + 0.5f * interface.picture_size());
    ASSERT_TRUE(state.picked);
    ASSERT_TRUE(interface.wait([&] { return state.node_history.size() >= 8; }));
    interface.frame();
    const NodeReport report = state.picture.picked->report;
    const std::string name = interface.scene()[*state.picked].name;
    EXPECT_FALSE(name.empty());
    EXPECT_TRUE(interface.line("node ").ends_with("  " + name)) << interface.line("node ");
    EXPECT_TRUE(interface.find("deforming; its content is deforming"));
    EXPECT_TRUE(interface.find("refitted, rebuilt when worn"));
    EXPECT_EQ(number_after(interface.line("triangles  "), "triangles"), 24 * 24 * 2);
    EXPECT_EQ(number_after(interface.line("triangles  "), "vertices"), report.vertex_count);
    EXPECT_TRUE(interface.find("its own, refitted"));
    EXPECT_NEAR(number_after(interface.line("cost"), "cost"), report.tree_cost, 0.051);
    const float loss = 100.0f * state.node_history.back().loss;
    EXPECT_NEAR(number_after(interface.line("loss"), "loss"), loss, 0.051);
    std::string history;
    for (const WindowState::NodeFrame& frame : state.node_history) history += ".fR"[static_cast<int>(frame.action)];
    EXPECT_NE(history.find("ffff"), std::string::npos) << history;
    EXPECT_EQ(interface.line(history), history);
}

/// Of a stage, over new frames from now on.
double median_ms(Interface& interface, double FrameStats::*stage) {
    WindowState& state = interface.state();
    state.history.clear();
    EXPECT_TRUE(interface.wait([&] { return state.history.size() >= 9; }));
    std::vector<double> times;
    for (const FrameStats& stats : state.history) times.push_back(stats.*stage);
    std::ranges::nth_element(times, times.begin() + 4);
    return times[4];
}

TEST(Panels, AForcedClassChangesStageTimesAndTheCostView) {
    Interface interface("deforming-60");
    WindowState& state = interface.state();
    state.shade = Shade::kCost;
    ASSERT_TRUE(interface.wait([&] { return state.picture.width > 0; }));
    interface.click(interface.picture_corner() + 0.5f * interface.picture_size());
    ASSERT_TRUE(state.picked);
    ASSERT_TRUE(interface.wait([&] { return interface.find("its own, refitted").has_value(); }));

    const auto costs = [&] {
        state.is_playing = false;
        state.time_s = 0.25;
        EXPECT_TRUE(interface.wait_for_picture());
        state.is_playing = true;
        return state.picture.rgba;
    };
    const auto choose = [&](const std::string& from, const std::string& to) {
        interface.click(interface.find(from).value());
        interface.frame();
        ASSERT_TRUE(interface.wait([&] { return interface.find(to).has_value(); }));
        interface.click(interface.find(to).value());
    };
    const double own_ms = median_ms(interface, &FrameStats::update_blas_ms);
    const std::vector<uint8_t> own_costs = costs();
    choose("class as the scene says", "arbitrary");
    EXPECT_EQ(state.motions, (std::vector{std::pair(*state.picked, Motion::kArbitrary)}));
    ASSERT_TRUE(interface.wait([&] { return interface.find("arbitrary; its content is deforming").has_value(); }));
    EXPECT_TRUE(interface.find("rebuilt: binned"));
    const double forced_ms = median_ms(interface, &FrameStats::update_blas_ms);
    EXPECT_GT(state.history.back().rebuilt, 0u);
    EXPECT_GT(forced_ms, 1.5 * own_ms);
    interface.frame();
    EXPECT_NEAR(number_after(interface.line("update_blas"), "update_blas"), state.history.back().update_blas_ms, 0.0006);
    EXPECT_NE(costs(), own_costs);

    choose("arbitrary", "class as the scene says");
    EXPECT_TRUE(state.motions.empty());
    ASSERT_TRUE(interface.wait([&] { return interface.find("deforming; its content is deforming").has_value(); }));
    EXPECT_LT(median_ms(interface, &FrameStats::update_blas_ms), forced_ms / 1.5);
}

TEST(Panels, RatesAreThoseOfTheCounts) {
    const TempFolder folder;
    write_small_scene(folder);
    Interface interface(folder / "scene.gltf");
    WindowState& state = interface.state();
    ASSERT_TRUE(interface.wait([&] { return state.shown_s.size() >= 8; }));
    interface.frame();
    const LivePicture& picture = state.picture;
    // By classes a pixel is one ray.
    EXPECT_EQ(picture.stats.rays, uint64_t(picture.width) * picture.height);
    EXPECT_NEAR(number_after(interface.line("rays"), "rays"), double(picture.stats.rays) / picture.stats.trace_ms / 1e3,
                0.0051);
    EXPECT_NEAR(number_after(interface.line("new frames"), "new frames"), state.frames_a_second(), 0.051);
    char size[64];
    std::snprintf(size, sizeof size, "%dx%d of %dx%d", picture.width, picture.height, state.picture_width,
                  state.picture_height);
    EXPECT_TRUE(interface.line("picture").ends_with(size)) << interface.line("picture");
}

TEST(WindowState, CountsNewFramesASecond) {
    WindowState state;
    state.picture.is_new_frame = true;
    EXPECT_EQ(state.frames_a_second(), 0.0);
    // Pictures come in pairs: 25 pairs a second.
    for (int frame = 0; frame < 100; ++frame) {
        state.now_s += frame % 2 == 0 ? 0.035 : 0.005;
        state.note_picture();
    }
    EXPECT_NEAR(state.frames_a_second(), 50.0, 1.0);
    state.now_s += 2.0;
    EXPECT_LT(state.frames_a_second(), 20.0) << "none for two seconds";
    WindowState slow;
    slow.picture.is_new_frame = true;
    for (int frame = 0; frame < 5; ++frame) {
        slow.now_s += 4.0;
        slow.note_picture();
    }
    EXPECT_DOUBLE_EQ(slow.frames_a_second(), 0.25);
}

TEST(Panels, WhatIsBeingOpenedAndWhatWentWrongIsSaid) {
    const TempFolder folder;
    write_small_scene(folder);
    Interface interface(folder / "scene.gltf");
    interface.state().opening = "other.glb";
    interface.state().message = "broken.glb: not a glTF file";
    interface.frame();
    EXPECT_TRUE(interface.find("opening other.glb"));
    EXPECT_TRUE(interface.find("broken.glb: not a glTF file"));
}

}  // namespace
}  // namespace zoe::test
