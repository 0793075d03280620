#include "engine/render/surface.h"

#include <cmath>

#include <gtest/gtest.h>

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
    // The second set of coordinates is missing: all of the surface has the texel at (0, 0).
    scene.materials[0].base_color_texture.uv_set = 1;
    EXPECT_EQ(look_down(scene, 0.5f, 0.6f).base_color, glm::vec3(1, 0, 0));
}

}  // namespace
}  // namespace zoe::test
