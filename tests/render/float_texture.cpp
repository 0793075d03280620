// Textures of halves, as EXR and HDR pictures become, beside textures of bytes.

#include <gtest/gtest.h>
#include <glm/common.hpp>

#include "engine/math/rng.h"
#include "engine/render/glow.h"
#include "engine/render/surface.h"
#include "engine/render/texture.h"
#include "engine/scene/half.h"
#include "engine/scene/image_levels.h"
#include "tests/render/scenes.h"

namespace zoe::test {
namespace {

Image make_halves(int width, int height, const std::vector<float>& numbers) {
    Image image{.is_half = true, .width = width, .height = height};
    for (const float number : numbers) {
        const uint16_t half = half_from_float(number);
        image.pixels.insert(image.pixels.end(), {static_cast<uint8_t>(half & 255), static_cast<uint8_t>(half >> 8)});
    }
    make_levels(&image);
    return image;
}

/// One picture of random colours and one of random numbers, which mean the same as bytes and as halves.
std::vector<Image> random_images(bool is_half, uint64_t seed) {
    std::vector<Image> images;
    for (const bool is_color : {true, false}) {
        Rng rng(seed);
        Image image{.is_color = is_color, .width = 16, .height = 16};
        std::vector<float> numbers;
        for (size_t i = 0; i < 16 * 16 * 4; ++i) {
            const auto byte = static_cast<uint8_t>(rng.below(256));
            image.pixels.push_back(byte);
            numbers.push_back(is_color && i % 4 < 3 ? linear_from_srgb_byte(byte) : byte / 255.0f);
        }
        make_levels(&image);
        images.push_back(is_half ? make_halves(16, 16, numbers) : image);
    }
    return images;
}

/// A floor that shows colours and numbers in every way.
Scene textured_floor(std::vector<Image> images) {
    Scene scene;
    scene.images = std::move(images);
    Material material;
    material.alpha_mode = AlphaMode::kBlend;
    material.emission = glm::vec3(1.0f);
    material.coat = material.transmission = 1.0f;
    material.sheen_color = glm::vec3(1.0f);
    material.sheen_roughness = material.coat_roughness = 1.0f;
    const auto textures = textures_of(material);
    for (size_t i = 0; i < textures.size(); ++i) textures[i]->image = ImageId{i < kColorTextureCount ? 0u : 1u};
    add_node(scene, make_floor(1.0f, 0.0f, scene.add(material)));
    return scene;
}

TEST(FloatTexture, TheSamePictureAsBytesAndAsHalvesIsTheSameSurface) {
    const uint64_t seed = 81;
    SCOPED_TRACE(seed);
    Scene bytes = textured_floor(random_images(false, seed)), halves = textured_floor(random_images(true, seed));
    const Tlas &tlas_of_bytes = advance(bytes, 0.0), &tlas_of_halves = advance(halves, 0.0);
    Rng rng(seed);
    for (int round = 0; round < 300; ++round) {
        const Ray ray{.origin = {rng.uniform(-0.9f, 0.9f), 1, rng.uniform(-0.9f, 0.9f)}, .direction = {0, -1, 0}};
        // Halves round by 2^-12 of themselves; bytes by half a step, which in light is up to 0.0045, at every level.
        const bool is_sharp = round % 2 == 0;
        const RayCone cone{is_sharp ? 0.0f : 0.5f * rng.uniform(), 0.0f};
        const float tolerance = is_sharp ? 2e-3f : 0.012f;
        const Surface a = surface_at(bytes, tlas_of_bytes, ray, closest_hit(tlas_of_bytes, ray), cone);
        const Surface b = surface_at(halves, tlas_of_halves, ray, closest_hit(tlas_of_halves, ray), cone);
        const auto expect_near = [&](const glm::vec3& x, const glm::vec3& y, const char* what) {
            for (int c = 0; c < 3; ++c) EXPECT_NEAR(x[c], y[c], tolerance) << what << " of round " << round;
        };
        expect_near(a.base_color, b.base_color, "base colour");
        expect_near(a.emission, b.emission, "emission");
        expect_near(a.specular_color, b.specular_color, "specular colour");
        expect_near(a.sheen_color, b.sheen_color, "sheen colour");
        expect_near(glm::vec3(a.metallic, a.roughness, a.opacity), glm::vec3(b.metallic, b.roughness, b.opacity), "numbers");
        expect_near(glm::vec3(a.coat, a.coat_roughness, a.transmission), glm::vec3(b.coat, b.coat_roughness, b.transmission),
                    "more numbers");
        if (is_sharp) expect_near(a.ns, b.ns, "normal");
    }
}

TEST(FloatTexture, AllButLightIsAtMostOne) {
    const std::vector<Image> images{make_halves(1, 1, {5.0f, 0.25f, 2.0f, 3.0f})};
    TextureRef texture;
    texture.image = ImageId{0};
    EXPECT_EQ(sample_texture(images, texture, {0.5f, 0.5f}, 0.0f, Texels::kLight), glm::vec4(5, 0.25f, 2, 3));
    for (const Texels texels : {Texels::kColors, Texels::kNumbers}) {
        EXPECT_EQ(sample_texture(images, texture, {0.5f, 0.5f}, 0.0f, texels), glm::vec4(1, 0.25f, 1, 1));
    }
}

/// What a floor in the dark gets from a lamp above it, that is seen itself where `is_lamp_seen`.
glm::vec3 lit_by(const Material& lamp, const std::vector<Image>& images, bool is_lamp_seen) {
    Scene scene;
    scene.images = images;
    add_node(scene, make_floor(5.0f, 0.0f, add_diffuse(scene, glm::vec3(0.5f))));
    add_node(scene, make_floor(0.5f, 2.0f, scene.add(lamp)));
    RenderConfig config = dark();
    config.max_bounces = 1;
    const View view = look_at({1.5f, 1, 0}, {0, is_lamp_seen ? 2.0f : 0.0f, 0}, 2.0f, 1.0f);
    return mean_radiance(picture(scene, view, config, 16, 16, 16));
}

TEST(FloatTexture, AnEmissionOfFiveIsALightOfFive) {
    Material plain = make_diffuse();
    plain.base_color = {0, 0, 0, 1};
    plain.is_double_sided = true;
    plain.emission = glm::vec3(5.0f);
    Material textured = plain;
    textured.emission = glm::vec3(1.0f);
    textured.emission_texture.image = ImageId{0};
    std::vector<float> numbers;
    for (int i = 0; i < 16; ++i) numbers.insert(numbers.end(), {5, 5, 5, 1});
    for (const int side : {4, 1}) {
        numbers.resize(static_cast<size_t>(4 * side * side));
        const std::vector<Image> images{make_halves(side, side, numbers)};
        EXPECT_EQ(lit_by(textured, images, true), glm::vec3(5.0f));
        EXPECT_EQ(lit_by(textured, images, false), lit_by(plain, {}, false));
        Scene scene;
        scene.images = images;
        const MaterialId lamp = scene.add(textured), other = scene.add(plain);
        add_node(scene, make_floor(1.0f, 0.0f, lamp));
        add_node(scene, make_floor(1.0f, 1.0f, other));
        Glow glow;
        glow.gather(scene, advance(scene, 0.0));
        EXPECT_EQ(glow.density(lamp), glow.density(other)) << "lamps are picked by their power";
    }
}

}  // namespace
}  // namespace zoe::test
