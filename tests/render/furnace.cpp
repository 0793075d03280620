#include <cmath>

#include <gtest/gtest.h>

#include "engine/math/rng.h"
#include "tests/render/scenes.h"

namespace zoe::test {
namespace {

/// Every pixel is 1: with an albedo of 1 every path brings exactly the sky's radiance, whichever way it goes.
void expect_all_one(const Film& film) {
    for (int y = 0; y < film.height; ++y) {
        for (int x = 0; x < film.width; ++x) {
            for (int c = 0; c < 3; ++c) EXPECT_NEAR(film.pixel(x, y)[c], 1.0f, 1e-5f) << "pixel " << x << ", " << y;
        }
    }
}

TEST(Furnace, AWhiteConvexObjectVanishes) {
    for (bool is_double_sided : {false, true}) {
        Scene scene;
        add_node(scene, make_sphere(2, add_diffuse(scene, glm::vec3(1.0f), is_double_sided), false));
        const Film film = picture(scene, look_at({0, 0, 3}, {0, 0, 0}, 40.0f, 1.0f), furnace(1), 32, 32, 16);
        expect_all_one(film);
        EXPECT_EQ(film.pixel(16, 16).a, 1.0f);
        EXPECT_EQ(film.pixel(0, 0).a, 0.0f);
    }
}

TEST(Furnace, ShadingNormalsLoseNoLight) {
    const uint64_t seed = 11;
    SCOPED_TRACE(seed);
    Rng rng(seed);
    Scene scene;
    Mesh smooth = make_sphere(1, add_diffuse(scene, glm::vec3(1.0f)), true);
    Mesh wild = smooth;
    for (glm::vec3& normal : wild.normals) normal = {rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1)};
    wild.normals[3] = glm::vec3(0.0f);
    const View view = look_at({0, 0, 3}, {0, 0, 0}, 40.0f, 1.0f);
    add_node(scene, std::move(smooth));
    expect_all_one(picture(scene, view, furnace(1), 32, 32, 16));
    Scene other;
    add_diffuse(other, glm::vec3(1.0f));
    add_node(other, std::move(wild));
    expect_all_one(picture(other, view, furnace(1), 32, 32, 16));
}

TEST(Furnace, AWhiteOpenBoxVanishesWhenPathsMayBeLongEnough) {
    Scene scene;
    add_node(scene, make_box(add_diffuse(scene, glm::vec3(1.0f), true), true), {{0, 0, 0}, {1, 0, 0, 0}, {2, 1, 3}});
    expect_all_one(picture(scene, look_at({0, 2.5f, 2}, {0, -1, 0}, 60.0f, 1.0f), furnace(2000), 16, 16, 16));
}

TEST(Furnace, AGreyConvexObjectShowsItsAlbedo) {
    Scene scene;
    add_node(scene, make_sphere(2, add_diffuse(scene, {0.25f, 0.5f, 0.75f}), true));
    const Film film = picture(scene, look_at({0, 0, 3}, {0, 0, 0}, 10.0f, 1.0f), furnace(4), 8, 8, 4);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(film.pixel(4, 4)[c], 0.25f * static_cast<float>(c + 1), 1e-5f);
}

TEST(Furnace, AConvexObjectInABlackHullThatFacesInwardsVanishesAndTheHullDoesNot) {
    Scene scene;
    add_node(scene, make_sphere(2, add_diffuse(scene, glm::vec3(1.0f)), true));
    const View view = look_at({0, 0, 3}, {0, 0, 0}, 45.0f, 1.0f);
    RenderConfig config = furnace(3);
    config.is_jittered = false;
    const Film bare = picture(scene, view, config, 32, 32, 8);
    const Mesh hull = turned_inside_out(make_sphere(2, add_diffuse(scene, glm::vec3(0.0f)), false));
    add_node(scene, hull, {{0, 0, 0}, {1, 0, 0, 0}, glm::vec3(1.1f)});
    scene.touch();
    const Film film = picture(scene, view, config, 32, 32, 8);
    int black = 0;
    for (int y = 0; y < 32; ++y) {
        for (int x = 0; x < 32; ++x) {
            if (bare.pixel(x, y).a == 1.0f || film.pixel(x, y).a == 0.0f) {
                EXPECT_NEAR(film.pixel(x, y).r, 1.0f, 1e-5f) << "pixel " << x << ", " << y;
            } else {
                EXPECT_EQ(film.pixel(x, y).r, 0.0f) << "pixel " << x << ", " << y;
                ++black;
            }
        }
    }
    EXPECT_GT(black, 20);
}

TEST(Furnace, WhatPassesBlendedSurfacesIsCountedOnce) {
    Scene scene;
    Material pane = make_diffuse();
    pane.base_color = {1, 1, 1, 0.4f};
    pane.alpha_mode = AlphaMode::kBlend;
    pane.is_double_sided = true;
    const MaterialId material = scene.add(pane);
    for (float y : {0.0f, 0.25f, 0.5f}) add_node(scene, make_floor(1.0f, y, material));
    const Film film = picture(scene, look_at({0, 3, 1}, {0, 0, 0}, 30.0f, 1.0f), furnace(200), 16, 16, 256);
    EXPECT_NEAR(mean_radiance(film).r, 1.0f, 0.005f);
}

TEST(Furnace, InsideAGlowingSphereTheBouncesSumUpToTheGeometricSeries) {
    // Russian roulette ends most of these paths early; the mean must not notice.
    Scene scene;
    Material material = make_diffuse();
    const float albedo = 0.6f;
    material.base_color = glm::vec4(albedo, 0.5f * albedo, 0.0f, 1.0f);
    material.emission = glm::vec3(1.0f);
    material.is_double_sided = true;
    add_node(scene, make_sphere(2, scene.add(material), true));
    RenderConfig config = dark();
    config.is_jittered = true;
    config.max_bounces = 60;
    const glm::vec3 mean = mean_radiance(picture(scene, look_at({0, 0, 0.5f}, {0, 0, 0}, 90.0f, 1.0f), config, 64, 64, 32));
    EXPECT_NEAR(mean.r, 1.0f / (1.0f - albedo), 0.01f);
    EXPECT_NEAR(mean.g, 1.0f / (1.0f - 0.5f * albedo), 0.01f);
    EXPECT_EQ(mean.b, 1.0f);

    config.max_bounces = 1;
    const glm::vec3 once = mean_radiance(picture(scene, look_at({0, 0, 0.5f}, {0, 0, 0}, 90.0f, 1.0f), config, 32, 32, 64));
    EXPECT_NEAR(once.r, 1.0f + albedo, 0.01f);
}

}  // namespace
}  // namespace zoe::test
