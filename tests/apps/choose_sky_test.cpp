#include "apps/demo/choose_sky.h"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "tests/apps/run_program.h"
#include "tests/apps/small_scene.h"

namespace zoe::test {
namespace {

/// Without a light, or with one.
Scene scene_with(bool has_light, bool is_shown = true) {
    Scene scene;
    Node node;
    if (has_light) {
        scene.lights.push_back({});
        node.light = LightId{0};
    }
    node.is_shown = is_shown;
    scene.nodes.push_back(node);
    return scene;
}

/// Four pixels round, two down: all dark but the one ahead, up: there `light`.
void write_sky(const std::filesystem::path& file, float light, float elsewhere = 0.0f) {
    std::vector<float> values(8, elsewhere);
    values[2] = light;  // Columns go round from -Z in the middle: the third begins there.
    const std::vector<Channel> channels = {{"R", values}, {"G", values}, {"B", values}};
    write_exr(file, 4, 2, channels);
}

TEST(ChooseSky, IsThePhysicalOneWhereNothingElseGivesLight) {
    const Environment expected = make_physical_sky(sky_direction(kSunElevation, kSunAzimuth));
    for (const Scene& scene : {scene_with(false), scene_with(true, false)}) {
        const auto sky = choose_sky({}, scene);
        ASSERT_TRUE(sky);
        EXPECT_EQ(sky->sun().toward(), expected.sun().toward());
        EXPECT_EQ(sky->radiance({0, 1, 0}), expected.radiance({0, 1, 0}));
        EXPECT_GT(sky->radiance({0, 1, 0}).b, sky->radiance({0, 1, 0}).r) << "it is blue";
    }
    EXPECT_FALSE(choose_sky({}, scene_with(true))) << "a lamp lights it";
}

TEST(ChooseSky, IsWhatWasAskedForWhateverTheSceneHas) {
    for (const bool has_light : {false, true}) {
        const Scene scene = scene_with(has_light);
        EXPECT_FALSE(choose_sky({.sky = Sky::kPlain}, scene));
        const auto physical = choose_sky({.sky = Sky::kPhysical, .sun = {10.0, 90.0}}, scene);
        ASSERT_TRUE(physical);
        EXPECT_EQ(physical->sun().toward(), sky_direction(10.0, 90.0));
        const auto uniform = choose_sky({.sky = Sky::kColor, .sky_color = {0.25, 0.5, 2.0}}, scene);
        ASSERT_TRUE(uniform);
        for (const glm::vec3 direction : {glm::vec3(0, 1, 0), glm::vec3(0, -1, 0), glm::vec3(0.6f, 0, 0.8f)})
            EXPECT_EQ(uniform->radiance(direction), glm::vec3(0.25f, 0.5f, 2.0f));
    }
}

TEST(ChooseSky, APictureLightsFromWhereItIsBright) {
    const TempFolder folder;
    write_sky(folder / "sky.exr", 3.0f);
    const auto sky = choose_sky({.sky = Sky::kFile, .sky_file = folder / "sky.exr"}, scene_with(true));
    ASSERT_TRUE(sky);
    const float h = std::sqrt(0.25f);
    EXPECT_NEAR(sky->radiance({h, std::sqrt(0.5f), -h}).r, 3.0f, 1e-3f) << "a pixel's centre";
    EXPECT_NEAR(sky->radiance({-h, -std::sqrt(0.5f), h}).r, 0.0f, 1e-3f);
    EXPECT_EQ(sky->repaired_count(), 0u);
}

TEST(ChooseSky, OfAPictureWithNumbersThatAreNoLightTheyAreCounted) {
    const TempFolder folder;
    write_small_scene(folder);
    write_sky(folder / "sky.exr", std::numeric_limits<float>::quiet_NaN(), 0.5f);
    const Outcome outcome = run_demo(folder.path(), small_pictures({"--frames", "0", "--sky", "sky.exr", "--out", "a.exr"}));
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_TRUE(outcome.err.starts_with("zoetrope-demo: warning: sky.exr: 1 of its pixels have numbers that are no light"))
        << outcome.err;
    for (const char* const channel : {"R", "G", "B"}) {
        for (const float value : channel_values(read_picture(folder / "a.exr"), channel))
            EXPECT_TRUE(std::isfinite(value) && value >= 0.0f) << channel << ' ' << value;
    }
}

}  // namespace
}  // namespace zoe::test
