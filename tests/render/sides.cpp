#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "engine/render/surface.h"
#include "tests/render/scenes.h"

namespace zoe::test {
namespace {

const View kFromBelow = look_at({0.1f, -2, 0.2f}, {0, 0, 0}, 5.0f, 1.0f);

Surface seen(Scene& scene, const glm::vec3& from, const glm::vec3& along) {
    const Tlas& tlas = advance(scene, 0.0);
    const Ray ray{.origin = from, .direction = along};
    const Hit hit = closest_hit(tlas, ray);
    EXPECT_TRUE(hit);
    return surface_at(scene, tlas, ray, hit);
}

TEST(Sides, TheBackOfASingleSidedSurfaceIsNotSeenButThatOfADoubleSidedOneIs) {
    for (bool is_double_sided : {false, true}) {
        for (Shade shade : {Shade::kPath, Shade::kAlbedo}) {
            Scene scene;
            add_node(scene, make_floor(1.0f, 0.0f, add_diffuse(scene, glm::vec3(0.5f), is_double_sided)));
            RenderConfig config = furnace(1);
            config.shade = shade;
            const Film film = picture(scene, kFromBelow, config, 4, 4, 2);
            const float beyond = shade == Shade::kPath ? 1.0f : 0.0f;
            for (int i = 0; i < 4; ++i) {
                EXPECT_NEAR(film.pixel(i, i).r, is_double_sided ? 0.5f : beyond, 1e-5f);
                EXPECT_EQ(film.pixel(i, i).a, is_double_sided ? 1.0f : 0.0f);
                EXPECT_EQ(film.node[static_cast<size_t>(5 * i)], 0u);
            }
        }
    }
}

/// A ball of frosted glass, a thin sheet, looks as smooth as its normals: of few triangles as of many.
TEST(Sides, FrostedBallsOfFewTrianglesLookAsThoseOfMany) {
    const auto ball = [](int levels, uint32_t first_number) {
        Scene scene;
        Material frosted = make_diffuse();
        frosted.specular = 1.0f;
        frosted.roughness = 0.6f;
        frosted.transmission = 0.9f;
        add_node(scene, make_sphere(levels, scene.add(frosted), true));
        RenderConfig config;
        config.first_number = first_number;
        return picture(scene, look_at({0, 0.5f, 5}, {0, 0, 0}, 20.0f, 1.0f), config, 24, 24, 256);
    };
    const Film many = ball(5, 0);
    const auto difference = [&](const Film& film) {
        double squares = 0.0;
        for (size_t k = 0; k < film.sum.size(); ++k) {
            const auto whole = static_cast<float>(film.sample_count);
            if (film.sum[k].a < whole || many.sum[k].a < whole) continue;  // the outline
            const double apart = static_cast<double>(film.sum[k].g - many.sum[k].g);
            squares += apart * apart;
        }
        return std::sqrt(squares);
    };
    const double noise = difference(ball(5, 1 << 12));
    EXPECT_LT(difference(ball(2, 1 << 12)), 1.15 * noise);
    EXPECT_LT(difference(ball(3, 1 << 12)), 1.15 * noise);
}

TEST(Sides, TheMaterialThatGltfGivesWhereNoneIsNamedIsSingleSided) {
    Scene scene;
    Mesh bare = make_floor(1.0f, 0.0f, kNone<MaterialId>);
    add_node(scene, bare);
    EXPECT_EQ(picture(scene, kFromBelow, furnace(1), 1, 1).pixel(0, 0).a, 0.0f);
    bare.materials.clear();
    Scene other;
    add_node(other, bare);
    EXPECT_EQ(picture(other, kFromBelow, furnace(1), 1, 1).pixel(0, 0).a, 0.0f);
}

TEST(Sides, WhatIsBehindASurfaceIsSeenOrLightsByTheSideThatARayMeets) {
    Scene scene;
    add_node(scene, make_floor(1.0f, 0.0f, add_diffuse(scene, glm::vec3(0.5f))));
    const Surface front = seen(scene, {0.3f, 2, 0.2f}, {0, -1, 0}), back = seen(scene, {0.3f, -2, 0.2f}, {0, 1, 0});
    EXPECT_EQ(front.opacity, 1.0f);
    EXPECT_EQ(front.light_opacity, 0.0f);
    EXPECT_EQ(back.opacity, 0.0f);
    EXPECT_EQ(back.light_opacity, 1.0f);
    scene.materials[0].is_double_sided = true;
    EXPECT_EQ(seen(scene, {0.3f, 2, 0.2f}, {0, -1, 0}).light_opacity, 1.0f);
    EXPECT_EQ(seen(scene, {0.3f, -2, 0.2f}, {0, 1, 0}).opacity, 1.0f);
}

TEST(Sides, AMirroredNodeKeepsItsFront) {
    for (Motion motion : {Motion::kStatic, Motion::kRigid, Motion::kArbitrary}) {
        for (int mirrors = 0; mirrors < 8; ++mirrors) {
            for (float size : {1e-15f, 1.0f, 1e3f}) {
                Scene scene;
                const glm::vec3 signs(mirrors & 1 ? -1 : 1, mirrors & 2 ? -1 : 1, mirrors & 4 ? -1 : 1);
                Node parent;
                parent.local.scale = size * signs;
                const NodeId id = scene.add(parent);
                const NodeId child = add_node(scene, make_floor(1.0f, 0.0f, add_diffuse(scene, glm::vec3(0.5f))));
                scene[child].parent = id;
                scene[child].motion = motion;
                const Surface surface = seen(scene, size * glm::vec3(0.3f, 2, 0.2f), {0, -1, 0});
                EXPECT_EQ(surface.opacity, std::max(signs.y, 0.0f)) << "mirrors " << mirrors << ", size " << size;
            }
        }
    }
}

/// A light grey floor in the light under a black plane with its front above, below, or on both sides.
enum class Roof { kNone, kFacesUp, kFacesDown, kDoubleSided };

float brightness_under(Roof roof, bool has_lamp, const RenderConfig& config, int sample_count) {
    Scene scene;
    add_node(scene, make_floor(3.0f, 0.0f, add_diffuse(scene, glm::vec3(0.8f))));
    if (has_lamp) add_light(scene, {.kind = LightKind::kPoint, .intensity = 4.0f}, {{0, 2, 0}});
    const MaterialId black = add_diffuse(scene, glm::vec3(0.0f), roof == Roof::kDoubleSided);
    Mesh plane = make_floor(1000.0f, 1.0f, black);
    if (roof == Roof::kFacesDown) plane = turned_inside_out(plane);
    if (roof != Roof::kNone) add_node(scene, plane);
    return mean_radiance(picture(scene, look_at({1, 0.5f, 1}, {0, 0, 0}, 5.0f, 1.0f), config, 4, 4, sample_count)).r;
}

TEST(Sides, LightPassesASingleSidedSurfaceFromBehindAndIsStoppedAtItsFront) {
    RenderConfig sun = dark(), lamp = dark();
    sun.sun_strength = 1.0f;
    const float in_sun = brightness_under(Roof::kNone, false, sun, 1), lit = brightness_under(Roof::kNone, true, lamp, 1);
    EXPECT_GT(in_sun, 0.1f);
    EXPECT_GT(lit, 0.1f);
    EXPECT_NEAR(brightness_under(Roof::kFacesDown, false, sun, 1), in_sun, 1e-6f);
    EXPECT_NEAR(brightness_under(Roof::kFacesDown, true, lamp, 1), lit, 1e-6f);
    for (Roof roof : {Roof::kFacesUp, Roof::kDoubleSided}) {
        EXPECT_EQ(brightness_under(roof, false, sun, 1), 0.0f);
        EXPECT_EQ(brightness_under(roof, true, lamp, 1), 0.0f);
    }
}

TEST(Sides, SkyLightDoesAsOtherLightDoes) {
    EXPECT_NEAR(brightness_under(Roof::kNone, false, furnace(2), 4), 0.8f, 1e-5f);
    EXPECT_NEAR(brightness_under(Roof::kFacesDown, false, furnace(2), 4), 0.8f, 1e-5f);
    // What comes in under the edge of the plane: a thousandth.
    EXPECT_LT(brightness_under(Roof::kDoubleSided, false, furnace(2), 16), 0.02f);
    EXPECT_LT(brightness_under(Roof::kFacesUp, false, furnace(2), 16), 0.02f);
}

TEST(Sides, ClosedSurfacesThatFaceOutwardsLookTheSameSingleAndDoubleSided) {
    const auto render_with = [](bool is_double_sided) {
        Scene scene;
        const MaterialId grey = add_diffuse(scene, {0.7f, 0.6f, 0.5f}, is_double_sided);
        const MaterialId green = add_diffuse(scene, {0.2f, 0.8f, 0.4f}, is_double_sided);
        add_node(scene, make_box(grey), {{0, -1.3f, 0}, {1, 0, 0, 0}, {4, 0.2f, 4}});
        add_node(scene, make_sphere(3, green, true));
        const glm::quat turn = glm::angleAxis(0.6f, glm::normalize(glm::vec3(1, 2, -1)));
        add_node(scene, make_box(grey), {{1.4f, -0.2f, 0.8f}, turn, {0.5f, -0.7f, 0.4f}});  // mirrored
        add_light(scene, {.kind = LightKind::kPoint, .intensity = 6.0f}, {{-2, 2, 1}});
        return picture(scene, look_at({1, 1.5f, 5}, {0.3f, -0.3f, 0}, 45.0f, 1.5f), {}, 90, 60, 8);
    };
    const Film single = render_with(false), both = render_with(true);
    int different = 0;
    for (size_t i = 0; i < both.sum.size(); ++i) different += single.sum[i] == both.sum[i] ? 0 : 1;
    EXPECT_EQ(different, 0);
}

/// A sphere over a floor, with or without a black hull a little larger that faces inwards: a drawn outline.
Film outlined(const glm::vec3& floor_color, bool has_hull) {
    Scene scene;
    add_node(scene, make_sphere(3, add_diffuse(scene, glm::vec3(0.8f)), true));
    add_node(scene, make_floor(6.0f, -1.2f, add_diffuse(scene, floor_color, true)));
    const Mesh hull = turned_inside_out(make_sphere(3, add_diffuse(scene, glm::vec3(0.0f)), true));
    if (has_hull) add_node(scene, hull, {{0, 0, 0}, {1, 0, 0, 0}, glm::vec3(1.05f)});
    RenderConfig config;
    config.is_jittered = false;
    return picture(scene, look_at({0, 1, 4}, {0, 0, 0}, 45.0f, 1.0f), config, 48, 48, 32);
}

TEST(Sides, AnOutlineHullTakesTheIndirectLightOfItsObjectAndNothingElse) {
    // Without a hull and over a black floor, the sphere has the light of sun and sky, and none from other surfaces. That is
    // what it must have inside the hull, whatever the floor: same directions, so up to rounding of where rays start.
    const Film bare = outlined(glm::vec3(0.0f), false), hulled = outlined(glm::vec3(0.6f), true);
    int sphere = 0, outline = 0;
    for (size_t i = 0; i < bare.sum.size(); ++i) {
        if (bare.node[i] == 0) {
            ++sphere;
            // A shadow ray that just misses the floor's edge may meet it after rounding: one sample of 32 at most.
            for (int c = 0; c < 3; ++c) EXPECT_NEAR(hulled.sum[i][c] / 32.0f, bare.sum[i][c] / 32.0f, 1.0f / 32.0f);
        } else if (hulled.node[i] == 2) {
            ++outline;
            EXPECT_EQ(glm::vec3(hulled.sum[i]), glm::vec3(0.0f));
            EXPECT_EQ(hulled.sum[i].a, 32.0f);
        }
    }
    EXPECT_GT(sphere, 500);
    EXPECT_GT(outline, 50);
    EXPECT_NEAR(mean_radiance(hulled).r, mean_radiance(outlined(glm::vec3(0.6f), false)).r, 0.2f);
}

}  // namespace
}  // namespace zoe::test
