#include "apps/demo/live_renderer.h"

#include <algorithm>
#include <chrono>

#include <gtest/gtest.h>

#include "engine/scene/srgb.h"
#include "tests/apps/lid_scene.h"
#include "tests/apps/run_program.h"

namespace zoe::test {
namespace {

constexpr int kWidth = 48, kHeight = 32;

/// The first picture of what is asked for.
LivePicture show(LiveRenderer& renderer, const LiveRequest& request) {
    renderer.ask(request);
    LivePicture picture;
    const auto is_it = [&] {
        return renderer.take(&picture) && picture.time_s == request.time_s &&
               (request.picked ? picture.picked && picture.picked->node == *request.picked : !picture.picked);
    };
    EXPECT_TRUE(wait_until(is_it)) << "no picture of " << request.time_s << " s";
    return picture;
}

/// Light, of the pictures' whole.
double brightness(const LivePicture& picture) {
    double sum = 0.0;
    for (size_t i = 0; i < picture.rgba.size(); i += 4) sum += linear_from_srgb_byte(picture.rgba[i]);
    return sum / double(picture.nodes.size());
}

LiveRequest playing(const LidScene& scene) {
    LiveRequest request;
    request.camera = scene.cameras[0];
    request.width = kWidth;
    request.height = kHeight;
    request.is_playing = true;
    return request;
}

/// What the frames before have seen is kept while a scene plays, and dropped with a cut to another camera.
TEST(LiveRenderer, ACutDropsTheFramesBefore) {
    double lit[2];
    for (const bool is_cut : {false, true}) {
        LidScene scene;
        LiveRenderer renderer(scene.content, 1, [] {});
        LiveRequest request = playing(scene);
        double dark = 0.0;
        for (int frame = 0; frame < 16; ++frame) {
            request.time_s = frame / 24.0;
            dark = brightness(show(renderer, request));
        }
        request.time_s = LidScene::kOpensS;
        if (is_cut) request.camera = scene.cameras[1];  // which stands where the first one does
        lit[is_cut] = brightness(show(renderer, request));
        double at_last = 0.0;
        for (int frame = 1; frame < 48; ++frame) {
            request.time_s = LidScene::kOpensS + frame / 24.0;
            at_last = brightness(show(renderer, request));
        }
        EXPECT_LT(dark, 0.3 * at_last);
        lit[is_cut] /= at_last;
    }
    EXPECT_LT(lit[false], 0.7) << "the mean follows";
    EXPECT_GT(lit[true], 0.85) << "the cut is seen at once";
}

/// Where nothing is known of times yet, surfaces are shown in half the size, lit by a quarter. Of a still frame both become
/// finer, and in the end the light is the picture's own.
TEST(LiveRenderer, LightIsCoarserThanSurfacesWhilePlaying) {
    LidScene scene;
    LiveRenderer renderer(scene.content, 4, [] {});
    LiveRequest request = playing(scene);
    request.time_s = LidScene::kOpensS;
    LivePicture picture = show(renderer, request);
    EXPECT_EQ(picture.width, kWidth / 2);
    EXPECT_EQ(picture.height, kHeight / 2);
    EXPECT_EQ(picture.light_width, kWidth / 4);
    EXPECT_EQ(picture.light_height, kHeight / 4);
    EXPECT_EQ(picture.rgba.size(), 4 * picture.nodes.size());
    EXPECT_EQ(picture.nodes[picture.nodes.size() / 2], scene.floor);
    EXPECT_GT(brightness(picture), 0.05);
    request.is_playing = false;
    renderer.ask(request);
    int width = picture.width, light_width = picture.light_width;
    for (int wait = 0; wait < 60'000 && !picture.is_finished; ++wait) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
        if (!renderer.take(&picture)) continue;
        EXPECT_GE(picture.width, width);
        EXPECT_GE(picture.light_width, light_width);
        width = picture.width;
        light_width = picture.light_width;
    }
    EXPECT_TRUE(picture.is_finished);
    EXPECT_EQ(width, kWidth);
    EXPECT_EQ(light_width, kWidth);
}

/// A node that is picked while the scene plays is outlined and reported in the pictures that follow.
TEST(LiveRenderer, APickedNodeIsShownWhilePlaying) {
    LidScene scene;
    LiveRenderer renderer(scene.content, 1, [] {});
    LiveRequest request = playing(scene);
    const auto outline_count = [](const LivePicture& picture) {
        int count = 0;
        for (size_t i = 0; i < picture.rgba.size(); i += 4)
            count += picture.rgba[i] == 255 && picture.rgba[i + 1] == 160 && picture.rgba[i + 2] == 0;
        return count;
    };
    for (int frame = 0; frame < 8; ++frame) {
        request.time_s = frame / 24.0;
        request.picked = frame < 4 ? std::nullopt : std::optional(scene.floor);
        const LivePicture picture = show(renderer, request);
        if (frame < 4) {
            EXPECT_EQ(outline_count(picture), 0);
            continue;
        }
        EXPECT_GT(outline_count(picture), 4);
        ASSERT_TRUE(picture.picked);
        EXPECT_EQ(picture.picked->name, "floor");
        EXPECT_EQ(picture.picked->report.triangle_count, 2u);
        EXPECT_EQ(picture.picked->report.motion, Motion::kStatic);
    }
}

/// A class that is forced is seen in the next picture, in its colour and in the node's report; and it can be taken back.
TEST(LiveRenderer, AForcedClassIsSeenAndTakenBack) {
    LidScene scene;
    LiveRenderer renderer(scene.content, 1, [] {});
    LiveRequest request = playing(scene);
    request.shade = Shade::kMotion;
    request.picked = scene.floor;
    request.time_s = 5.0;
    std::vector<uint8_t> own;
    for (const bool is_forced : {false, true, false}) {
        request.time_s += 1.0 / 24.0;
        request.motions.clear();
        if (is_forced) request.motions.emplace_back(scene.floor, Motion::kArbitrary);
        const LivePicture picture = show(renderer, request);
        ASSERT_TRUE(picture.picked);
        EXPECT_EQ(picture.picked->report.motion, is_forced ? Motion::kArbitrary : Motion::kStatic);
        EXPECT_EQ(picture.picked->report.content, Motion::kStatic);
        const size_t middle = (size_t{1} * picture.height / 2 * picture.width + picture.width / 2) * 4;
        ASSERT_EQ(picture.nodes[middle / 4], scene.floor);
        const std::vector<uint8_t> color(picture.rgba.begin() + static_cast<ptrdiff_t>(middle),
                                         picture.rgba.begin() + static_cast<ptrdiff_t>(middle) + 3);
        if (own.empty()) own = color;
        EXPECT_EQ(color == own, !is_forced);
    }
}

/// While a large picture is refined, an edit does not wait for the pass that is running, and the interface for nothing.
/// A pass that only makes the picture finer is left: no picture of the time before comes any more.
TEST(LiveRenderer, AnEditRestartsThePictureWithoutWaiting) {
    LidScene scene;
    LiveRenderer renderer(scene.content, 1000, [] {});
    LiveRequest request = playing(scene);
    request.is_playing = false;
    request.width = 480;
    request.height = 300;
    LivePicture picture;
    constexpr int kEditCount = 8;
    int late_count = 0;
    for (int edit = 0; edit < kEditCount; ++edit) {
        renderer.ask(request);
        EXPECT_TRUE(wait_until(
            [&] { return renderer.take(&picture) && picture.time_s == request.time_s && picture.width == request.width; }));
        // A pass has begun. It may end even so just now, seldom.
        request.time_s += 0.1;
        renderer.ask(request);
        EXPECT_TRUE(wait_until([&] {
            if (!renderer.take(&picture)) return false;
            late_count += picture.time_s != request.time_s;
            return picture.time_s == request.time_s;
        }));
    }
    EXPECT_LE(late_count, kEditCount / 2);
}

}  // namespace
}  // namespace zoe::test
