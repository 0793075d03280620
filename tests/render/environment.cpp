#include "engine/render/environment.h"

#include <limits>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>

#include "engine/math/rng.h"
#include "engine/scene/image.h"
#include "tests/render/scenes.h"
#include "tests/support/temp_folder.h"

namespace zoe::test {
namespace {

FloatImage random_sky(int width, int height, Rng& rng) {
    FloatImage picture;
    picture.width = width;
    picture.height = height;
    picture.channels = {"R", "G", "B"};
    for (int i = 0; i < 3 * width * height; ++i) {
        picture.values.push_back(rng.below(8) == 0 ? 30.0f * rng.uniform() : rng.uniform());
    }
    return picture;
}

glm::vec3 random_direction(Rng& rng) {
    const float z = rng.uniform(-1.0f, 1.0f), angle = rng.uniform(0.0f, glm::two_pi<float>());
    const float r = std::sqrt(std::max(0.0f, 1.0f - z * z));
    return glm::normalize(glm::vec3(r * std::cos(angle), r * std::sin(angle), z));
}

TEST(Environment, TheMiddleIsMinusZRightIsXAndTheTopIsUp) {
    FloatImage picture;
    picture.width = 4;
    picture.height = 2;
    picture.channels = {"B", "G", "R"};
    for (int y = 0; y < 2; ++y) {
        for (int x = 0; x < 4; ++x)
            picture.values.insert(picture.values.end(), {0.0f, static_cast<float>(y), static_cast<float>(x)});
    }
    const Environment sky(picture);
    EXPECT_EQ(sky.repaired_count(), 0u);
    EXPECT_NEAR(sky.radiance({0, 0, -1}).r, 1.5f, 1e-5f);  // between columns 1 and 2
    EXPECT_NEAR(sky.radiance(glm::normalize(glm::vec3(1, 0, -1))).r, 2.0f, 1e-5f);
    EXPECT_NEAR(sky.radiance(glm::normalize(glm::vec3(-1, 0, -1))).r, 1.0f, 1e-5f);
    EXPECT_NEAR(sky.radiance({0, 0, 1}).r, 1.5f, 1e-5f);  // between columns 3 and 0, around the back
    EXPECT_EQ(sky.radiance({0, 1, 0}).g, 0.0f);
    EXPECT_EQ(sky.radiance({0, -1, 0}).g, 1.0f);
}

TEST(Environment, TheDensityIntegratesToOneAndSamplesFollowIt) {
    const uint64_t seed = 61;
    SCOPED_TRACE(seed);
    Rng rng(seed);
    for (const auto& [width, height] : {std::pair(16, 8), {7, 5}, {1, 1}, {64, 2}}) {
        const Environment sky(random_sky(width, height, rng));
        double integral = 0.0;
        glm::dvec3 expected(0.0), sampled(0.0);
        constexpr int kCount = 200000;
        for (int i = 0; i < kCount; ++i) {
            const glm::vec3 any = random_direction(rng);
            const double density = static_cast<double>(sky.density(any)) * 4.0 * glm::pi<double>() / kCount;
            integral += density;
            expected += density * glm::dvec3(any);
            const glm::vec3 direction = sky.sample({rng.uniform(), rng.uniform()});
            EXPECT_NEAR(glm::length(direction), 1.0f, 1e-5f);
            EXPECT_GT(sky.density(direction), 0.0f);
            sampled += glm::dvec3(direction) / static_cast<double>(kCount);
        }
        EXPECT_NEAR(integral, 1.0, 0.03) << width << " x " << height;
        EXPECT_LT(glm::distance(expected, sampled), 0.03) << width << " x " << height;
    }
}

TEST(Environment, NumbersThatAreNoLightAreCountedAndBlackSkiesAreDark) {
    FloatImage picture;
    picture.width = 4;
    picture.height = 1;
    picture.channels = {"Y"};
    picture.values = {std::numeric_limits<float>::quiet_NaN(), -1.0f, std::numeric_limits<float>::infinity(), 0.5f};
    const Environment sky(picture);
    EXPECT_EQ(sky.repaired_count(), 3u);
    Rng rng(62);
    for (int i = 0; i < 1000; ++i) {
        const glm::vec3 direction = sky.sample({rng.uniform(), rng.uniform()});
        EXPECT_TRUE(std::isfinite(sky.density(direction)) && std::isfinite(sky.radiance(direction).g));
    }
    picture.values.assign(4, 0.0f);
    const Environment black(picture);
    EXPECT_EQ(black.density({0, 1, 0}), 0.0f);
    EXPECT_EQ(black.radiance(black.sample({0.5f, 0.5f})), glm::vec3(0.0f));
    picture.channels = {"U", "V", "W"};
    picture.values.assign(12, 0.0f);
    EXPECT_THROW(Environment{picture}, std::runtime_error);
}

TEST(Environment, LightsAFloorAsItsHemisphereDoes) {
    const uint64_t seed = 63;
    SCOPED_TRACE(seed);
    Rng rng(seed);
    const Environment sky(random_sky(16, 8, rng));
    glm::dvec3 irradiance(0.0);
    constexpr int kCount = 400000;
    for (int i = 0; i < kCount; ++i) {
        const glm::vec3 any = random_direction(rng);
        irradiance += glm::dvec3(sky.radiance(any)) * static_cast<double>(std::max(any.y, 0.0f)) * 4.0 * glm::pi<double>() /
                      static_cast<double>(kCount);
    }
    Scene scene;
    add_node(scene, make_floor(1.0f, 0.0f, add_diffuse(scene, glm::vec3(0.5f))));
    RenderConfig config;
    config.environment = &sky;
    const glm::vec3 mean = mean_radiance(picture(scene, look_at({0, 3, 0.1f}, {0, 0, 0}, 10.0f, 1.0f), config, 16, 16, 256));
    for (int c = 0; c < 3; ++c) {
        const double expected = 0.5 * irradiance[c] / glm::pi<double>();
        EXPECT_NEAR(static_cast<double>(mean[c]), expected, 0.01 * expected);
    }
}

TEST(Environment, IsReadFromAFileOrRefusedWithItsName) {
    const TempFolder folder;
    const std::vector<float> red = {1, 2, 3, 4, 5, 6, 7, 8}, green(8, 0.5f), blue(8, 40.0f);
    const Channel channels[] = {{"R", red}, {"G", green}, {"B", blue}};
    write_exr(folder / "sky.exr", 4, 2, channels);
    const Environment sky = read_environment(folder / "sky.exr");
    EXPECT_NEAR(sky.radiance(glm::normalize(glm::vec3(1, 1, -1))).b, 40.0f, 1e-4f);
    EXPECT_NEAR(sky.radiance({0, 1, 0}).r, 2.5f, 1e-4f);
    EXPECT_EQ(sky.repaired_count(), 0u);

    // A picture for the screen is decoded: half as bright to the eye is a fifth of the light.
    write_png(folder / "sky.png", 2, 1, std::vector<uint8_t>(8, 128));
    EXPECT_NEAR(read_environment(folder / "sky.png").radiance({0, 1, 0}).g, 0.21586f, 1e-4f);

    const Channel others[] = {{"U", red}, {"V", green}, {"W", blue}};
    write_exr(folder / "no_sky.exr", 4, 2, others);
    for (const char* const name : {"no_sky.exr", "nowhere.exr"}) {
        try {
            read_environment(folder / name);
            FAIL() << name;
        } catch (const std::runtime_error& error) {
            EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << error.what();
        }
    }
}

}  // namespace
}  // namespace zoe::test
