// Surfaces that are as fine as their pixels show.

#include <algorithm>
#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "engine/frame/frame.h"
#include "engine/frame/refine.h"
#include "tests/deform/subdivide_oracle.h"
#include "tests/support/point_distance.h"

namespace zoe::test {
namespace {

constexpr float kYfov = 0.8f;
constexpr int kHeight = 720;

Mesh cube_mesh(float pixels) {
    PolygonMesh mesh = cube();
    mesh.creases[{0, 1}] = 1.5;
    return make_surface(mesh.positions(), {.cage = mesh.cage(), .options = {.level = 3}, .pixels = pixels, .max_level = 6});
}

// A cube's surface in the scene's middle, and one that moves away from it.
Scene make_scene(float pixels) {
    Scene scene;
    Node node;
    node.mesh = scene.add(cube_mesh(pixels));
    scene.add(node);
    scene.add(node);
    scene.nodes[1].local.translation = {3, 0, 0};
    Clip clip;
    clip.duration_s = 10.0;
    clip.samplers = {Sampler{.times_s = {0, 10}, .values = {3, 0, 0, 3, 0, -1000}}};
    clip.channels = {{NodeId{1}, ChannelPath::kTranslation, 0}};
    scene.clips.push_back(clip);
    scene.playback.clips = {ClipId{0}};
    return scene;
}

Viewpoint seen_from(const glm::vec3& eye, float hysteresis = 0.25f) {
    return {.eye_world = eye, .yfov = kYfov, .height_pixels = kHeight, .hysteresis = hysteresis};
}

int level_of(const Tlas& tlas, uint32_t node) {
    int level = 0;
    for (size_t count = 12; count < tlas.instances[node].mesh->corners.size(); count *= 4) ++level;
    return level;
}

TEST(SubdivisionLevel, ErrorsAreWithinThePixelsAskedFor) {
    constexpr float kPixels = 0.5f;
    const Refined fine = make_refined(cube_mesh(kPixels), 6);
    Scene scene = make_scene(kPixels);
    std::vector<int> levels;
    for (const float away : {6.0f, 9.0f, 20.0f, 80.0f, 900.0f}) {
        const glm::vec3 eye{0.2f * away, 0.1f * away, away};
        scene.viewpoint = seen_from(eye);
        const Tlas& tlas = advance(scene, 0.0);
        levels.push_back(level_of(tlas, 0));
        const Instance& shown = tlas.instances[0];
        double worst_pixels = 0.0;
        for (size_t v = 0; v < fine.mesh.positions.size(); v += 11) {
            const glm::vec3& p = fine.mesh.positions[v];
            double nearest = 1e300;
            for (const glm::uvec3& c : shown.mesh->corners) {
                nearest = std::min(nearest, distance(glm::dvec3(p), glm::dvec3(shown.positions[c.x]),
                                                     glm::dvec3(shown.positions[c.y]), glm::dvec3(shown.positions[c.z])));
            }
            const double pixels_at_1m = 0.5 * kHeight / std::tan(0.5 * kYfov);
            worst_pixels = std::max(worst_pixels, nearest * pixels_at_1m / glm::length(glm::dvec3(p) - glm::dvec3(eye)));
        }
        EXPECT_LE(worst_pixels, kPixels) << away << " m away, level " << levels.back();
        // One level is a factor of four, and the estimate is on the safe side.
        if (levels.back() > 1) {
            EXPECT_GT(worst_pixels, kPixels / 16) << away << " m away, level " << levels.back();
        }
    }
    EXPECT_TRUE(std::is_sorted(levels.rbegin(), levels.rend()));
    EXPECT_GE(levels.front(), 4);
    EXPECT_EQ(levels.back(), 1);
    EXPECT_TRUE(scene.warnings().empty());
}

TEST(SubdivisionLevel, WithoutAViewpointOrPixelsTheLevelIsAsGiven) {
    Scene scene = make_scene(0.5f);
    EXPECT_EQ(level_of(advance(scene, 0.0), 0), 3);
    scene.viewpoint = seen_from({0, 0, 900});
    EXPECT_EQ(level_of(advance(scene, 0.0), 0), 1);
    scene.viewpoint.reset();
    EXPECT_EQ(level_of(advance(scene, 0.0), 0), 3);
    Scene fixed = make_scene(0.0f);
    fixed.viewpoint = seen_from({0, 0, 900});
    EXPECT_EQ(level_of(advance(fixed, 0.0), 0), 3);
}

TEST(SubdivisionLevel, AChangeOfLevelRebuildsOnce) {
    Scene scene = make_scene(0.5f);
    scene.viewpoint = seen_from({0, 0, 5});
    std::vector<int> levels;
    uint32_t changes = 0;
    for (int frame = 0; frame < 200; ++frame) {
        FrameStats stats;
        const Tlas& tlas = advance(scene, 0.05 * frame, &stats);
        levels.push_back(level_of(tlas, 1));
        const bool is_change = frame == 0 || levels[frame] != levels[frame - 1];
        changes += frame > 0 && is_change;
        EXPECT_EQ(stats.subdivided, frame == 0 ? 1 + (levels[0] != level_of(tlas, 0)) : uint32_t(is_change)) << frame;
        if (frame > 0) {
            EXPECT_EQ(stats.rebuilt, uint32_t(is_change)) << frame;
        }
    }
    EXPECT_TRUE(std::is_sorted(levels.rbegin(), levels.rend())) << "it moves away";
    EXPECT_EQ(levels.back(), 1);
    EXPECT_GE(changes, 3u);
}

// Where two levels are equally good, a trembling camera must not make a node go back and forth.
TEST(SubdivisionLevel, HysteresisKeepsALevelAgainstTrembling) {
    Scene scene = make_scene(0.5f);
    const auto level_from = [&](float away, float hysteresis) {
        scene.viewpoint = seen_from({0, 0, away}, hysteresis);
        return level_of(advance(scene, 0.0), 0);
    };
    float near = 3.0f, far = 300.0f;  // Where level 3 becomes level 2.
    while (far - near > 1e-4f * near) {
        const float middle = 0.5f * (near + far);
        (level_from(middle, 0.0f) >= 3 ? near : far) = middle;
    }
    int changes[2] = {};
    for (const bool has_hysteresis : {false, true}) {
        int last = level_from(near * 0.9f, has_hysteresis ? 0.25f : 0.0f);
        for (int frame = 0; frame < 20; ++frame) {
            const int level = level_from(near * (frame % 2 == 0 ? 1.02f : 0.98f), has_hysteresis ? 0.25f : 0.0f);
            changes[has_hysteresis] += level != last;
            last = level;
        }
    }
    EXPECT_EQ(changes[0], 20);
    EXPECT_EQ(changes[1], 0);
    EXPECT_EQ(level_from(near * 1.5f, 0.25f), 2) << "and yet it goes coarser";
    EXPECT_EQ(level_from(near * 0.98f, 0.25f), 3) << "finer at once";
}

TEST(SubdivisionLevel, AllTogetherHaveNoMoreTrianglesThanAllowed) {
    const auto levels_with = [](uint64_t max_triangles, size_t* warning_count) {
        Scene scene = make_scene(0.5f);
        scene.viewpoint = seen_from({0, 0, 6}, 0.0f);
        scene.viewpoint->max_triangles = max_triangles;
        const Tlas& tlas = advance(scene, 0.3);  // The second is 36 m away by now.
        if (warning_count) *warning_count = scene.warnings().size();
        return std::array{level_of(tlas, 0), level_of(tlas, 1)};
    };
    const auto triangles = [](int level) { return uint64_t{12} << (2 * level); };
    size_t warning_count = 0;
    const auto [near, far] = levels_with(uint64_t{1} << 30, &warning_count);
    EXPECT_EQ(warning_count, 0u);
    ASSERT_GE(near, far + 2);
    ASSERT_GE(far, 2);
    EXPECT_EQ(levels_with(triangles(near) + triangles(far), &warning_count), (std::array{near, far}));
    EXPECT_EQ(warning_count, 0u);
    EXPECT_EQ(levels_with(triangles(near) + triangles(far) - 1, &warning_count), (std::array{near - 1, far}));
    EXPECT_EQ(warning_count, 1u);
    EXPECT_EQ(levels_with(2 * triangles(far), nullptr), (std::array{far, far}));
    EXPECT_EQ(levels_with(2 * triangles(far) - 1, nullptr), (std::array{far - 1, far})) << "the first of two that are alike";
    EXPECT_EQ(levels_with(0, nullptr), (std::array{1, 1})) << "the coarsest there is";
}

// Neither what a frame's levels are cut down to nor what they would have been depends on frames before.
TEST(SubdivisionLevel, JumpingGivesTheLevelsOfPlaying) {
    const auto make = [] {
        Scene scene = make_scene(0.5f);
        scene.viewpoint = seen_from({0, 0, 6}, 0.0f);
        scene.viewpoint->max_triangles = 12 * 300;
        return scene;
    };
    Scene played = make();
    for (int frame = 0; frame < 60; ++frame) {
        const double time_s = frame < 30 ? 0.1 * frame : 0.1 * (60 - frame);
        const Tlas& tlas = advance(played, time_s);
        Scene jumped = make();
        const Tlas& other = advance(jumped, time_s);
        for (const uint32_t node : {0u, 1u}) EXPECT_EQ(level_of(tlas, node), level_of(other, node)) << "frame " << frame;
    }
}

TEST(SubdivisionLevel, FollowsACameraNodeInTheSameFrame) {
    Scene scene = make_scene(0.5f);
    Node camera;
    camera.local.translation = {0, 0, 3};
    const NodeId id = scene.add(camera);
    scene.viewpoint = seen_from({0, 0, 0});
    scene.viewpoint->node = id;
    const int near = level_of(advance(scene, 0.0), 0);
    scene[id].local.translation = {0, 0, 900};
    const int far = level_of(advance(scene, 0.0), 0);
    EXPECT_GE(near, 4);
    EXPECT_EQ(far, 1);
    scene.viewpoint->node = NodeId{77};
    EXPECT_THROW(advance(scene, 0.0), SceneError);
}

TEST(SubdivisionLevel, FinerThanAllowedIsAWarning) {
    Scene scene = make_scene(0.001f);
    scene.meshes[0].surface->max_level = 2;
    scene.viewpoint = seen_from({0, 0, 4});
    EXPECT_EQ(level_of(advance(scene, 0.0), 0), 2);
    ASSERT_EQ(scene.warnings().size(), 2u) << "one a node";
    EXPECT_NE(scene.warnings().begin()->first.find("finest level"), std::string::npos);
    Mesh mesh = cube_mesh(0.5f);
    mesh.surface->options.limit_positions = false;
    scene.meshes[0] = mesh;
    EXPECT_NE(check(scene).find("limit_positions"), std::string::npos);
}

}  // namespace
}  // namespace zoe::test
