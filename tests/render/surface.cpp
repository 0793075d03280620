#include "engine/render/surface.h"

#include <cmath>
#include <optional>
#include <vector>

#include <gtest/gtest.h>
#include <glm/gtc/quaternion.hpp>

#include "engine/render/tangent_frame.h"
#include "engine/render/texture.h"
#include "engine/scene/image_levels.h"
#include "tests/math/random_inputs.h"
#include "tests/render/scenes.h"

namespace zoe::test {
namespace {

/// The surface that a ray down from (x, 5, z) meets.
Surface look_down(Scene& scene, float x, float z) {
    const Tlas& tlas = advance(scene, 0.0);
    const Ray ray{.origin = {x, 5, z}, .direction = {0, -1, 0}};
    const Hit hit = closest_hit(tlas, ray);
    EXPECT_TRUE(hit);
    return surface_at(scene, tlas, ray, hit);
}

TEST(Surface, ThePointIsTheHitAndNormalsFaceTheRayFromBothSides) {
    Scene scene;
    add_node(scene, make_floor(1.0f, 0.0f, add_diffuse(scene, glm::vec3(1.0f))), {{0, 2, 0}, {1, 0, 0, 0}, {3, 4, 5}});
    const Surface above = look_down(scene, 0.5f, -0.25f);
    EXPECT_LT(glm::distance(above.position, glm::vec3(0.5f, 2.0f, -0.25f)), 1e-5f);
    EXPECT_LT(glm::distance(above.ng, glm::vec3(0, 1, 0)), 1e-6f);
    const Ray up{.origin = {0.5f, -5, 0.5f}, .direction = {0, 2, 0}};
    const Tlas& tlas = advance(scene, 0.0);
    EXPECT_LT(glm::distance(surface_at(scene, tlas, up, closest_hit(tlas, up)).ng, glm::vec3(0, -1, 0)), 1e-6f);
}

TEST(Surface, ShadingNormalsFollowStretchAndMirror) {
    for (float mirror : {1.0f, -1.0f}) {
        Scene scene;
        Mesh mesh = make_floor(1.0f, 0.0f, add_diffuse(scene, glm::vec3(1.0f)));
        mesh.normals.assign(4, glm::normalize(glm::vec3(1, 1, 0)));
        add_node(scene, std::move(mesh), {{0, 0, 0}, {1, 0, 0, 0}, {mirror * 2.0f, 1, 1}});
        // A plane of which (1, 1, 0) is the normal has (1 / (2 m), 1, 0) after a stretch by 2 m.
        const Surface surface = look_down(scene, 0.25f, 0.25f);
        EXPECT_LT(glm::distance(surface.ns, glm::normalize(glm::vec3(0.5f * mirror, 1, 0))), 1e-5f);
    }
}

/// A ray that hits a mesh, and a light that is above the interpolated normal's horizon and below the triangle's.
struct TurnedAway {
    Ray ray;
    Hit hit;
    Surface surface;
    glm::vec3 to_light;
};

/// eye        from where the mesh's middle and its surroundings are looked at.
std::vector<TurnedAway> turned_away(const Scene& scene, const Tlas& tlas, const glm::vec3& eye, float size, Rng& rng) {
    std::vector<TurnedAway> found;
    for (int round = 0; round < 20000 && found.size() < 300; ++round) {
        const glm::vec3 target = 0.6f * size * random_direction(rng);
        const Ray ray{.origin = eye, .direction = target - eye};
        const Hit hit = closest_hit(tlas, ray);
        if (!hit) continue;
        const Surface surface = surface_at(scene, tlas, ray, hit);
        const glm::vec3 away = glm::normalize(surface.smooth - surface.ng);
        const glm::vec3 side = glm::normalize(glm::cross(surface.ng, away));
        const glm::vec3 to_light = glm::normalize(away - glm::dot(away, surface.ng) * surface.ng +
                                                  rng.uniform(-0.5f, 0.5f) * side - rng.uniform(0.0f, 0.1f) * surface.ng);
        if (glm::dot(surface.ng, to_light) < 0.0f && glm::dot(surface.smooth, to_light) > 0.01f)
            found.push_back({ray, hit, surface, to_light});
    }
    return found;
}

TEST(Surface, RaysToLightsLeaveTheCurvedSurfaceOfTrianglesThatAreTurnedAway) {
    const uint64_t seed = 21;
    SCOPED_TRACE(seed);
    for (const float size : {1e-3f, 1.0f, 1e6f}) {
        for (const float mirror : {1.0f, -1.0f}) {
            Rng rng(seed);
            Scene scene;
            const glm::quat turn = glm::normalize(glm::quat(0.3f, 0.5f, -0.2f, 0.7f));
            add_node(scene, make_sphere(3, add_diffuse(scene, glm::vec3(1.0f)), true),
                     {size * glm::vec3(0.1f, -0.2f, 0.3f), turn, size * glm::vec3(mirror, 1.0f, 1.0f)});
            const glm::vec3 center = size * glm::vec3(0.1f, -0.2f, 0.3f);
            const Tlas& tlas = advance(scene, 0.0);
            const auto outside = turned_away(scene, tlas, center + 4.0f * size * glm::vec3(0.6f, 0.0f, 0.8f), size, rng);
            ASSERT_GT(outside.size(), 100u);
            for (const auto& [ray, hit, surface, to_light] : outside) {
                const std::optional<glm::vec3> origin = leave_smoothly(tlas, hit, surface, to_light);
                ASSERT_TRUE(origin);
                const float under = 1.0f - glm::distance(surface.position, center) / size;
                const float above = glm::distance(*origin, center) / size - 1.0f;
                EXPECT_GT(above, -0.05f * under - 1e-5f);
                EXPECT_LT(above, 1.2f * under + 1e-5f);
                EXPECT_FALSE(any_hit(tlas, {.origin = *origin, .direction = to_light}));
            }
            // From within it is hollow: what is turned away lies in the shadow of what is not.
            const auto inside = turned_away(scene, tlas, center, size, rng);
            ASSERT_GT(inside.size(), 100u);
            for (const auto& [ray, hit, surface, to_light] : inside)
                EXPECT_FALSE(leave_smoothly(tlas, hit, surface, to_light));
        }
    }
}

/// Alike, as those of a leaf, or apart, as those of a leaf that has them from its crown, or of a box.
TEST(Surface, NormalsThatLeanOneWayOrFarStandForNoCurve) {
    for (const bool is_apart : {false, true}) {
        Scene scene;
        Mesh mesh = make_floor(1.0f, 0.0f, add_diffuse(scene, glm::vec3(1.0f)));
        mesh.normals.assign(4, glm::normalize(glm::vec3(1, 1.5f, 0)));
        if (is_apart) mesh.normals = {{-1, 1, -1}, {1, 1, -1}, {1, 1, 1}, {-1, 1, 1}};
        add_node(scene, std::move(mesh));
        const Ray down{.origin = {0.25f, 5, 0.25f}, .direction = {0, -1, 0}};
        const Tlas& tlas = advance(scene, 0.0);
        const Hit hit = closest_hit(tlas, down);
        const Surface surface = surface_at(scene, tlas, down, hit);
        const glm::vec3 grazing = glm::normalize(glm::vec3(1.0f, -0.1f, 0.0f));
        ASSERT_TRUE(is_turned_away(surface, grazing));
        EXPECT_FALSE(leave_smoothly(tlas, hit, surface, grazing));
        EXPECT_EQ(leave_smoothly(tlas, hit, surface, glm::vec3(0, 1, 0)), leave(surface, glm::vec3(0, 1, 0)));
    }
}

TEST(Surface, ZeroNormalsAskForTheGeometricOne) {
    Scene scene;
    Mesh mesh = make_floor(1.0f, 0.0f, add_diffuse(scene, glm::vec3(1.0f)));
    mesh.normals.assign(4, glm::vec3(0.0f));
    add_node(scene, std::move(mesh));
    const Surface surface = look_down(scene, 0.25f, 0.5f);
    EXPECT_EQ(surface.ns, surface.ng);
}

TEST(Surface, TheColourIsFactorTimesTextureTimesVertexColour) {
    Scene scene;
    Image image;
    image.width = image.height = 1;
    image.pixels = {255, 188, 0, 128};
    scene.images.push_back(image);
    Material material;
    material.base_color = {0.5f, 0.5f, 0.5f, 0.8f};
    material.base_color_texture.image = ImageId{0};
    material.alpha_mode = AlphaMode::kBlend;
    Mesh mesh = make_floor(1.0f, 0.0f, scene.add(material));
    mesh.colors.assign(4, {0.25f, 1.0f, 1.0f, 0.5f});
    add_node(scene, std::move(mesh));
    const Surface surface = look_down(scene, 0.1f, 0.2f);
    EXPECT_NEAR(surface.base_color.r, 0.125f, 1e-6f);
    EXPECT_NEAR(surface.base_color.g, 0.5f * 0.5029f, 1e-3f);
    EXPECT_EQ(surface.base_color.b, 0.0f);
    EXPECT_NEAR(surface.opacity, 0.8f * 128.0f / 255.0f * 0.5f, 1e-6f);
}

TEST(Surface, EachRangeOfTrianglesHasItsMaterialAndNoneIsWhite) {
    Scene scene;
    Mesh mesh = make_floor(1.0f, 0.0f, kNone<MaterialId>);
    mesh.materials = {{0, 1, add_diffuse(scene, {1, 0, 0})}, {1, 2, kNone<MaterialId>}};
    add_node(scene, std::move(mesh));
    // Triangle 0 has the corners (-1, -1), (1, -1), (1, 1) in x, z.
    EXPECT_EQ(look_down(scene, 0.5f, -0.5f).base_color, glm::vec3(1, 0, 0));
    EXPECT_EQ(look_down(scene, -0.5f, 0.5f).base_color, glm::vec3(1, 1, 1));
}

TEST(Surface, TextureCoordinatesTurnTheRightWayRound) {
    Scene scene;
    Image image;
    image.width = image.height = 2;
    image.pixels = {255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 255, 255, 255, 255};  // red green / blue white
    scene.images.push_back(image);
    Material material;
    material.base_color_texture.image = ImageId{0};
    material.base_color_texture.is_nearest = true;
    add_node(scene, make_floor(1.0f, 0.0f, scene.add(material)));
    EXPECT_EQ(look_down(scene, -0.5f, -0.6f).base_color, glm::vec3(1, 0, 0));
    EXPECT_EQ(look_down(scene, 0.5f, -0.6f).base_color, glm::vec3(0, 1, 0));
    EXPECT_EQ(look_down(scene, -0.5f, 0.6f).base_color, glm::vec3(0, 0, 1));
    EXPECT_EQ(look_down(scene, 0.5f, 0.6f).base_color, glm::vec3(1, 1, 1));
    // A set of coordinates that is missing: all of the surface has the texel at (0, 0).
    scene.materials[0].base_color_texture.uv_set = 2;
    EXPECT_EQ(look_down(scene, 0.5f, 0.6f).base_color, glm::vec3(1, 0, 0));
    // One of its own: turned by half.
    for (const glm::vec2& uv : scene.meshes[0].uvs[0]) scene.meshes[0].uvs[2].push_back(1.0f - uv);
    EXPECT_EQ(look_down(scene, -0.5f, -0.6f).base_color, glm::vec3(1, 1, 1));
    EXPECT_EQ(look_down(scene, 0.5f, -0.6f).base_color, glm::vec3(0, 0, 1));
}

/// Adds an image of one colour.
ImageId add_image(Scene& scene, const std::vector<uint8_t>& rgba) {
    Image image;
    image.width = image.height = 1;
    image.pixels = rgba;
    scene.images.push_back(image);
    return ImageId(scene.images.size() - 1);
}

TEST(Surface, NumbersOfTexturesAreNotDecodedAndEachComesFromItsChannel) {
    Scene scene;
    const ImageId image = add_image(scene, {51, 102, 153, 204});  // 0.2, 0.4, 0.6, 0.8
    Material material;
    material.metallic = 0.5f;
    material.roughness = 0.5f;
    material.coat = material.coat_roughness = material.transmission = material.specular = material.sheen_roughness = 1.0f;
    material.sheen_color = glm::vec3(1.0f);
    for (TextureRef* ref : {&material.metallic_roughness_texture, &material.coat_texture, &material.coat_roughness_texture,
                            &material.transmission_texture, &material.specular_texture, &material.sheen_roughness_texture,
                            &material.sheen_color_texture, &material.specular_color_texture}) {
        ref->image = image;
    }
    add_node(scene, make_floor(1.0f, 0.0f, scene.add(material)));
    const Surface surface = look_down(scene, 0.1f, 0.2f);
    EXPECT_NEAR(surface.metallic, 0.3f, 1e-6f);
    EXPECT_NEAR(surface.roughness, 0.2f, 1e-6f);
    EXPECT_NEAR(surface.coat, 0.2f, 1e-6f);
    EXPECT_NEAR(surface.coat_roughness, 0.4f, 1e-6f);
    EXPECT_NEAR(surface.transmission, 0.2f, 1e-6f);
    EXPECT_NEAR(surface.specular, 0.8f, 1e-6f);
    EXPECT_NEAR(surface.sheen_roughness, 0.8f, 1e-6f);
    EXPECT_NEAR(surface.sheen_color.r, linear_from_srgb_byte(51), 1e-6f);
    EXPECT_NEAR(surface.specular_color.g, linear_from_srgb_byte(102), 1e-6f);
}

TEST(Surface, ABodysLossesAreThoseOfItsColourAtItsDistance) {
    Scene scene;
    Material material;
    material.transmission = 1.0f;
    material.thickness = 0.1f;
    material.attenuation_color = {0.5f, 0.25f, 1.0f};
    material.attenuation_distance = 2.0f;
    material.ior = 2.0f;
    add_node(scene, make_floor(1.0f, 0.0f, scene.add(material)));
    const Surface surface = look_down(scene, 0.1f, 0.2f);
    EXPECT_TRUE(surface.is_body());
    EXPECT_NEAR(std::exp(-2.0f * surface.absorption.r), 0.5f, 1e-6f);
    EXPECT_NEAR(std::exp(-4.0f * surface.absorption.g), 0.0625f, 1e-6f);
    EXPECT_EQ(surface.absorption.b, 0.0f);
    EXPECT_NEAR(surface.f0, 1.0f / 9.0f, 1e-6f);
    EXPECT_EQ(surface.opacity, 1.0f);
}

/// A floor whose normal texture leans by the same vector everywhere: x along u, which is +X; y against v, which is -Z.
Scene leaning_floor(const Trs& place, bool has_normals) {
    Scene scene;
    Material material;
    material.normal_texture.image = add_image(scene, {230, 77, 204, 255});  // 0.8, -0.4, 0.6, nearly
    material.is_double_sided = true;
    Mesh mesh = make_floor(1.0f, 0.0f, scene.add(material));
    if (has_normals) mesh.normals.assign(4, glm::vec3(0, 1, 0));
    if (has_normals) mesh.tangents.assign(4, glm::vec4(1, 0, 0, 1));
    add_node(scene, std::move(mesh), place);
    return scene;
}

TEST(Surface, NormalTexturesBendNormalsAlongTheTextureAndFollowTheNode) {
    const glm::vec3 texel = glm::normalize(2.0f * glm::vec3(230, 77, 204) / 255.0f - 1.0f);
    for (bool has_normals : {true, false}) {
        Scene flat = leaning_floor({}, has_normals);
        EXPECT_LT(glm::distance(look_down(flat, 0.1f, 0.2f).ns, glm::vec3(texel.x, texel.z, -texel.y)), 1e-5f)
            << has_normals;
        // A quarter turn about +Y takes +X to -Z and -Z to -X.
        Scene turned =
            leaning_floor({{0, 0, 0}, glm::angleAxis(glm::half_pi<float>(), glm::vec3(0, 1, 0)), glm::vec3(2)}, has_normals);
        EXPECT_LT(glm::distance(look_down(turned, 0.1f, 0.2f).ns, glm::vec3(-texel.y, texel.z, -texel.x)), 1e-5f)
            << has_normals;
        // Mirrored along X: what leaned to +X leans to -X, and the front stays above.
        Scene mirrored = leaning_floor({{0, 0, 0}, {1, 0, 0, 0}, {-1, 1, 1}}, has_normals);
        EXPECT_LT(glm::distance(look_down(mirrored, 0.1f, 0.2f).ns, glm::vec3(-texel.x, texel.z, -texel.y)), 1e-5f)
            << has_normals;
        // From the back it is the same bump, seen from inside.
        const Tlas& tlas = advance(flat, 0.0);
        const Ray up{.origin = {0.1f, -5, 0.2f}, .direction = {0, 1, 0}};
        const Surface below = surface_at(flat, tlas, up, closest_hit(tlas, up));
        EXPECT_TRUE(below.is_inside);
        EXPECT_LT(glm::distance(below.ns, -glm::vec3(texel.x, texel.z, -texel.y)), 1e-5f) << has_normals;
    }
}

TEST(Surface, TangentsFollowTheDeformation) {
    // The floor stands on edge in this frame, as a skin would have it; its rest pose, normals and tangents are the floor's.
    Scene scene = leaning_floor({}, true);
    const Tlas& tlas = advance(scene, 0.0);
    Instance instance = tlas.instances[0];
    const glm::quat turn = glm::angleAxis(0.9f, glm::normalize(glm::vec3(1, 2, 3)));
    std::vector<glm::vec3> moved;
    for (const glm::vec3& p : scene.meshes[0].positions) moved.push_back(3.0f * (turn * p));
    instance.positions = moved;
    const TangentFrame frame = tangent_frame(instance, 0, glm::vec3(1.0f / 3.0f), 0, turn * glm::vec3(0, 1, 0));
    EXPECT_LT(glm::distance(frame.x, turn * glm::vec3(1, 0, 0)), 1e-5f);
    EXPECT_LT(glm::distance(frame.y, turn * glm::vec3(0, 0, -1)), 1e-5f);
}

TEST(Surface, WhatIsFarAwayShowsCoarserTexels) {
    Scene scene;
    Image image;
    image.width = image.height = 64;
    for (int i = 0; i < 64 * 64; ++i) {
        const uint8_t value = (i + i / 64) % 2 == 0 ? 255 : 0;
        image.pixels.insert(image.pixels.end(), {value, value, value, 255});
    }
    make_levels(&image);
    scene.images.push_back(image);
    Material material;
    material.base_color_texture.image = ImageId{0};
    material.base_color_texture.is_nearest = material.base_color_texture.is_nearest_minified = true;
    add_node(scene, make_floor(1.0f, 0.0f, scene.add(material)));
    const Tlas& tlas = advance(scene, 0.0);
    const Ray ray{.origin = {0.01f, 5, 0.01f}, .direction = {0, -1, 0}};
    const Hit hit = closest_hit(tlas, ray);
    const float texel = 2.0f / 64.0f;
    const auto red = [&](const RayCone& cone) { return surface_at(scene, tlas, ray, hit, cone).base_color.r; };
    EXPECT_EQ(red({}), 1.0f);
    EXPECT_EQ(red({0.9f * texel, 0.0f}), 1.0f);
    EXPECT_NEAR(red({2.0f * texel, 0.0f}), 0.5f, 0.005f);
    EXPECT_NEAR(red({0.0f, 2.0f * texel / 5.0f}), 0.5f, 0.005f);
    EXPECT_NEAR(red({std::sqrt(2.0f) * texel, 0.0f}), 0.75f, 0.005f) << "half way between two levels";
    scene.materials[0].base_color_texture.levels = LevelFilter::kFinest;
    EXPECT_EQ(red({2.0f * texel, 0.0f}), 1.0f);
    scene.materials[0].base_color_texture.levels = LevelFilter::kBlended;
    scene.materials[0].alpha_mode = AlphaMode::kMask;
    EXPECT_EQ(red({2.0f * texel, 0.0f}), 1.0f) << "masks stay sharp";
}

}  // namespace
}  // namespace zoe::test
