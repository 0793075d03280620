#include "engine/render/light.h"

#include <cmath>

#include <gtest/gtest.h>
#include <glm/gtc/constants.hpp>

#include "tests/render/scenes.h"

namespace zoe::test {
namespace {

constexpr float kPi = glm::pi<float>();
constexpr float kAlbedo = 0.6f;

/// A floor at y = 0, and a camera right above the origin that sees [-2, 2]^2 of it.
struct FloorScene {
    Scene scene;
    View view;

    FloorScene() {
        add_node(scene, make_floor(100.0f, 0.0f, add_diffuse(scene, glm::vec3(kAlbedo))));
        view = look_at({0, 2, 0}, {0, 0, 0}, 90.0f, 1.0f);
    }
    /// Point that the centre of a pixel of a square picture shows.
    glm::vec3 point(int x, int y, int size) const {
        const Ray ray = camera_ray(view, static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f, size, size);
        return ray.origin - ray.direction * (ray.origin.y / ray.direction.y);
    }
};

/// Along -Y, as a light that hangs from a ceiling.
Trs hanging(const glm::vec3& position) {
    return {position, glm::angleAxis(glm::radians(-90.0f), glm::vec3(1, 0, 0)), glm::vec3(1)};
}

/// Renders with only the scene's lights, and compares each pixel with albedo / pi times an irradiance.
template <typename Irradiance>
void expect_floor(FloorScene& floor, Irradiance irradiance) {
    constexpr int kSize = 8;
    RenderConfig config = dark();
    config.max_bounces = 0;
    const Film film = picture(floor.scene, floor.view, config, kSize, kSize);
    for (int y = 0; y < kSize; ++y) {
        for (int x = 0; x < kSize; ++x) {
            const float expected = kAlbedo / kPi * irradiance(floor.point(x, y, kSize));
            EXPECT_NEAR(film.pixel(x, y).r, expected, 2e-4f * expected) << "pixel " << x << ", " << y;
        }
    }
}

TEST(Light, APointLightFallsOffWithTheSquareOfTheDistanceAndTheCosine) {
    FloorScene floor;
    const glm::vec3 place(0.5f, 3.0f, -0.25f);
    add_light(floor.scene, {.kind = LightKind::kPoint, .intensity = 50.0f}, {place});
    expect_floor(floor, [&](const glm::vec3& p) {
        const float d = glm::distance(p, place);
        return 50.0f / (d * d) * place.y / d;
    });
}

TEST(Light, ARangeEndsThePointLight) {
    FloorScene floor;
    const glm::vec3 place(0.0f, 1.5f, 0.0f);
    add_light(floor.scene, {.kind = LightKind::kPoint, .intensity = 8.0f, .range = 2.0f}, {place});
    expect_floor(floor, [&](const glm::vec3& p) {
        const float d = glm::distance(p, place);
        return 8.0f * std::max(0.0f, 1.0f - std::pow(d / 2.0f, 4.0f)) / (d * d) * place.y / d;
    });
}

TEST(Light, ADirectionalLightIsTheSameEverywhere) {
    FloorScene floor;
    const Trs slanted{{7, 7, 7}, glm::angleAxis(glm::radians(-30.0f), glm::vec3(1, 0, 0)), glm::vec3(2)};
    add_light(floor.scene, {.kind = LightKind::kDirectional, .intensity = 3.0f}, slanted);
    expect_floor(floor, [](const glm::vec3&) { return 3.0f * 0.5f; });
}

TEST(Light, ASpotIsFullInsideTheInnerConeAndFadesToTheOuter) {
    FloorScene floor;
    const glm::vec3 place(0.0f, 2.5f, 0.0f);
    const float inner = 0.3f, outer = 0.6f;
    add_light(floor.scene, {.kind = LightKind::kSpot, .intensity = 20.0f, .inner_cone = inner, .outer_cone = outer},
              hanging(place));
    int lit = 0, faded = 0, unlit = 0;
    expect_floor(floor, [&](const glm::vec3& p) {
        const float d = glm::distance(p, place), cosine = place.y / d;
        float share = (cosine - std::cos(outer)) / (std::cos(inner) - std::cos(outer));
        share = std::min(std::max(share, 0.0f), 1.0f);
        ++(share == 0.0f ? unlit : share == 1.0f ? lit : faded);
        return 20.0f * share * share / (d * d) * cosine;
    });
    EXPECT_TRUE(lit > 0 && faded > 0 && unlit > 0) << lit << ' ' << faded << ' ' << unlit;
}

TEST(Light, ManyLightsAddUp) {
    FloorScene floor;
    const glm::vec3 places[] = {{1, 2, 0}, {-1, 1, 0.5f}, {0, 3, -1}, {0.2f, 0.7f, 0.9f}};
    for (const glm::vec3& place : places) add_light(floor.scene, {.kind = LightKind::kPoint, .intensity = 5.0f}, {place});
    RenderConfig config = dark();
    config.max_bounces = 0;
    constexpr int kSize = 4, kSamples = 4096;
    const Film film = picture(floor.scene, floor.view, config, kSize, kSize, kSamples);
    for (int y = 0; y < kSize; ++y) {
        for (int x = 0; x < kSize; ++x) {
            float expected = 0.0f;
            for (const glm::vec3& place : places) {
                const float d = glm::distance(floor.point(x, y, kSize), place);
                expected += kAlbedo / kPi * 5.0f / (d * d) * place.y / d;
            }
            EXPECT_NEAR(film.pixel(x, y).r, expected, 2e-3f * expected);
        }
    }
}

TEST(Light, ColouredLightsKeepTheirColoursWhenOneIsPicked) {
    FloorScene floor;
    add_light(floor.scene, {.kind = LightKind::kPoint, .color = {1, 0, 0}, .intensity = 5.0f}, {{0, 2, 0}});
    add_light(floor.scene, {.kind = LightKind::kPoint, .color = {0, 0.1f, 0}, .intensity = 5.0f}, {{0, 2, 0}});
    RenderConfig config = dark();
    config.max_bounces = 0;
    const glm::vec4 pixel = picture(floor.scene, floor.view, config, 1, 1, 4096).pixel(0, 0);
    EXPECT_NEAR(pixel.r, kAlbedo / kPi * 5.0f / 4.0f, 2e-3f * pixel.r);
    EXPECT_NEAR(pixel.g, 0.1f * pixel.r, 2e-3f * pixel.r);
    EXPECT_EQ(pixel.b, 0.0f);
}

TEST(Light, TheSunBringsItsIrradianceTimesTheCosine) {
    FloorScene floor;
    RenderConfig config;
    config.sky_strength = 0.0f;
    config.sun_strength = 2.0f;
    config.max_bounces = 0;
    const glm::vec3 mean = mean_radiance(picture(floor.scene, floor.view, config, 16, 16, 16));
    const glm::vec3 expected = kAlbedo / kPi * 2.0f * default_sun().irradiance() * default_sun().toward().y;
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(mean[c], expected[c], 1e-3f * expected[c]);
}

TEST(Light, TheSunIsSeenByTheCameraAndBringsTheSameAsItsDiscWould) {
    Scene scene;
    RenderConfig config;
    config.sky_strength = 0.0f;
    // The disc fills 1/20 of the angle of view.
    const float fov_degrees = glm::degrees(20.0f * 2.0f * default_sun().radius());
    const View view = look_at({0, 0, 0}, 10.0f * default_sun().toward(), fov_degrees, 1.0f);
    const Film film = picture(scene, view, config, 128, 128, 16);
    // Irradiance of the seen disc: radiance times the solid angle of each pixel (small angles; all near the axis).
    const float pixels = static_cast<float>(film.width * film.height);
    const float solid_angle = 4.0f * view.half_width * view.half_height / pixels;
    EXPECT_NEAR(mean_radiance(film).g * pixels * solid_angle, default_sun().irradiance().g,
                0.03f * default_sun().irradiance().g);
    EXPECT_EQ(film.pixel(0, 0).g, 0.0f);
    EXPECT_EQ(film.pixel(64, 64).a, 0.0f);
}

TEST(Light, WhatStandsBetweenShades) {
    FloorScene floor;
    add_light(floor.scene, {.kind = LightKind::kPoint, .intensity = 5.0f}, {{0, 1, 0}});
    add_node(floor.scene, make_floor(0.5f, 0.5f, add_diffuse(floor.scene, glm::vec3(0.5f))));
    RenderConfig config = dark();
    config.max_bounces = 0;
    floor.view = look_at({4, 0.25f, 0}, {0, 0, 0}, 1.0f, 1.0f);  // below the roof
    EXPECT_EQ(picture(floor.scene, floor.view, config, 1, 1).pixel(0, 0).r, 0.0f);
    EXPECT_EQ(picture(floor.scene, floor.view, config, 1, 1).pixel(0, 0).a, 1.0f);
    floor.view = look_at({4, 0.25f, 0}, {2, 0, 0}, 1.0f, 1.0f);
    EXPECT_GT(picture(floor.scene, floor.view, config, 1, 1).pixel(0, 0).r, 0.0f);
}

TEST(Light, HiddenNodesShineNothing) {
    FloorScene floor;
    const NodeId lamp = add_light(floor.scene, {.kind = LightKind::kPoint, .intensity = 5.0f}, {{0, 1, 0}});
    floor.scene[lamp].is_shown = false;
    EXPECT_EQ(picture(floor.scene, floor.view, dark(), 1, 1).pixel(0, 0).r, 0.0f);
}

}  // namespace
}  // namespace zoe::test
