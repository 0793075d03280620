#include <cmath>

#include <gtest/gtest.h>

#include "engine/math/rng.h"
#include "engine/render/environment.h"
#include "engine/scene/image.h"
#include "tests/render/scenes.h"

namespace zoe::test {
namespace {

/// Every kind of light that two ways find, on surfaces of every kind.
struct LitScene {
    Scene scene;
    View view = look_at({0, 2, 5}, {0, 0.3f, 0}, 45.0f, 4.0f / 3.0f);
    Environment sky = Environment(spotted(), Sun(glm::normalize(glm::vec3(1, 2, 1)), glm::vec3(0.6f), 0.4f));

    LitScene() {
        Material floor = make_diffuse();
        floor.base_color = {0.6f, 0.5f, 0.4f, 1};
        floor.is_double_sided = true;
        add_node(scene, make_floor(4.0f, -1.0f, scene.add(floor)));
        Material metal = floor;
        metal.metallic = 1.0f;
        metal.roughness = 0.6f;
        add_node(scene, make_sphere(2, scene.add(metal), false), {{-0.9f, 0, 0}});
        Material cloth = floor;
        cloth.specular = cloth.coat = 0.5f;
        cloth.coat_roughness = 0.5f;
        cloth.sheen_color = {0.2f, 0.3f, 0.4f};
        cloth.sheen_roughness = 0.6f;
        add_node(scene, make_box(scene.add(cloth)), {{1.2f, -0.5f, 0.3f}, {1, 0, 0, 0}, glm::vec3(0.5f)});
        Material lamp = floor;
        lamp.emission = {1.5f, 1.2f, 0.6f};
        add_node(scene, make_floor(1.0f, 2.5f, scene.add(lamp)));
        Material pane = floor;
        pane.base_color.a = 0.5f;
        pane.alpha_mode = AlphaMode::kBlend;
        add_node(scene, make_floor(0.8f, 1.5f, scene.add(pane)), {{-1, 0, 0}});
        Material frosted = floor;
        frosted.base_color = {0.9f, 0.8f, 0.9f, 1};
        frosted.specular = 1.0f;
        frosted.transmission = 0.8f;
        frosted.roughness = 0.5f;
        add_node(scene, make_box(scene.add(frosted)), {{0.4f, -0.6f, 1.4f}, {1, 0, 0, 0}, glm::vec3(0.35f)});
        add_light(scene, {.kind = LightKind::kPoint, .intensity = 2.0f}, {{0, 1.2f, 1}});
    }

    static FloatImage spotted() {
        FloatImage picture{.width = 8, .height = 4, .channels = {"R", "G", "B"}, .values = std::vector<float>(96, 0.1f)};
        for (const size_t i : {3u, 12u, 20u}) picture.values[3 * i] = picture.values[3 * i + 1] = 1.5f;
        return picture;
    }

    glm::vec3 mean(LightSearch search, bool is_random) {
        RenderConfig config;
        config.environment = &sky;
        config.search = search;
        constexpr int kSamples = 256;
        const Tlas& tlas = advance(scene, 0.0);
        Film film(32, 24);
        film.sample_count = 1;
        if (!is_random) {
            render(scene, tlas, view, config, kSamples, &film, nullptr);
        } else {
            Rng rng(81);
            for (int i = 0; i < kSamples; ++i) {
                film.sample_count = static_cast<int>(rng.below(1u << 30)) + 1;
                render(scene, tlas, view, config, 1, &film, nullptr);
            }
        }
        film.sample_count = kSamples;
        return mean_radiance(film);
    }
};

TEST(Convergence, EveryCombinationOfSamplersHasTheSameMean) {
    LitScene lit;
    const glm::vec3 reference = lit.mean(LightSearch::kBoth, false);
    ASSERT_GT(reference.b, 0.05f);
    for (const LightSearch search : {LightSearch::kBoth, LightSearch::kLights, LightSearch::kBounces}) {
        for (const bool is_random : {false, true}) {
            const glm::vec3 mean = lit.mean(search, is_random);
            for (int c = 0; c < 3; ++c) {
                EXPECT_NEAR(mean[c], reference[c], 0.005f * reference[c])
                    << "search " << static_cast<int>(search) << (is_random ? ", random" : ", spread") << ", colour " << c;
            }
        }
    }
}

TEST(Convergence, FromWithinABodyOrASurfaceEveryNumberIsOne) {
    LitScene lit;
    RenderConfig config;
    config.environment = &lit.sky;
    // Inside the ball, in the lamp's plane, on the box's corner, and right on the floor.
    for (const glm::vec3& eye : {glm::vec3(-0.9f, 0, 0), {0.3f, 2.5f, 0.2f}, {1.7f, 0, 0.8f}, {0.5f, -1.0f, 1.5f}}) {
        const View view = look_at(eye, {0.1f, 0.2f, -3.0f}, 80.0f, 1.0f);
        const Film film = picture(lit.scene, view, config, 24, 24, 8);
        for (const glm::vec4& pixel : film.sum) {
            EXPECT_TRUE(std::isfinite(pixel.r + pixel.g + pixel.b) && pixel.r >= 0.0f && pixel.g >= 0.0f && pixel.b >= 0.0f)
                << "eye at " << eye.x << ", " << eye.y << ", " << eye.z;
        }
    }
}

}  // namespace
}  // namespace zoe::test
