// The shadow terminator: where light grazes a coarse mesh with smooth normals.

#include <cmath>
#include <functional>
#include <optional>
#include <vector>

#include <gtest/gtest.h>
#include <glm/gtc/constants.hpp>
#include <glm/gtc/quaternion.hpp>

#include "engine/render/bsdf.h"
#include "engine/render/light.h"
#include "engine/render/surface.h"
#include "tests/render/scenes.h"

namespace zoe::test {
namespace {

constexpr int kSize = 96;
constexpr float kAlbedo = 0.6f;

/// Irradiance of a surface that faces a light, and the direction towards it.
struct Incoming {
    float irradiance;
    glm::vec3 toward;
};

struct Seen {
    Surface surface;
    glm::vec3 to_viewer;
};

struct Ball {
    Scene scene;
    View view;

    Ball(int levels, const glm::vec3& eye) : view(look_at(6.0f * eye, glm::vec3(0.0f), 20.0f, 1.0f)) {
        add_node(scene, make_sphere(levels, add_diffuse(scene, glm::vec3(kAlbedo)), true));
    }
    std::vector<float> render(const RenderConfig& config) {
        const Film film = picture(scene, view, config, kSize, kSize, 4);
        std::vector<float> values;
        for (int i = 0; i < kSize * kSize; ++i) values.push_back(film.pixel(i % kSize, i / kSize).r);
        return values;
    }
    /// What the centre of each pixel shows, where that is the ball.
    std::vector<std::optional<Seen>> seen() {
        const Tlas& tlas = advance(scene, 0.0);
        std::vector<std::optional<Seen>> found(kSize * kSize);
        for (int i = 0; i < kSize * kSize; ++i) {
            const float x = static_cast<float>(i % kSize) + 0.5f, y = static_cast<float>(i / kSize) + 0.5f;
            const Ray ray = camera_ray(view, x, y, kSize, kSize);
            const Hit hit = closest_hit(tlas, ray);
            if (hit) found[static_cast<size_t>(i)] = {surface_at(scene, tlas, ray, hit), -ray.direction};
        }
        return found;
    }
};

/// The edge that a coarse ball's facets draw, where they turn away from the light: across it, compares the steps from pixel
/// to pixel with those of a fine ball. As rendered, and as if facets that face the light got all of it.
/// levels     of the coarse ball: 4 to the power of that times 8 triangles.
/// toward     about the direction of the light.
template <typename Light>
void expect_smooth(int levels, const RenderConfig& config, const glm::vec3& toward,
                   const std::function<void(Scene&)>& add_lights, Light&& incoming) {
    const glm::vec3 eye = glm::normalize(glm::cross(toward, glm::vec3(0.3f, 1.0f, 0.2f)));
    SCOPED_TRACE(levels);
    Ball coarse(levels, eye), fine(6, eye);
    for (Ball* ball : {&coarse, &fine}) add_lights(ball->scene);
    const std::vector<float> rendered = coarse.render(config), expected = fine.render(config);
    const std::vector<std::optional<Seen>> seen = coarse.seen();
    std::vector<float> hard(seen.size(), 0.0f);
    std::vector<bool> is_seen(seen.size(), false), is_lit(seen.size(), false);
    for (size_t i = 0; i < seen.size(); ++i) {
        if (!seen[i]) continue;
        const Surface& surface = seen[i]->surface;
        const Incoming light = incoming(surface.position);
        is_seen[i] = glm::dot(surface.ns, eye) > 0.4f;
        is_lit[i] = glm::dot(surface.ng, light.toward) > 0.0f;
        const Bsdf bsdf(surface, seen[i]->to_viewer);
        if (is_lit[i]) hard[i] = light.irradiance * bsdf.evaluate_sharp(light.toward).r;
    }
    double rendered_error = 0.0, hard_error = 0.0;
    int count = 0;
    for (size_t i = 0; i < seen.size(); ++i) {
        for (const size_t j : {i + 1, i + kSize}) {
            if (j >= seen.size() || !is_seen[i] || !is_seen[j] || is_lit[i] == is_lit[j]) continue;
            const float step = expected[j] - expected[i];
            rendered_error += std::pow(rendered[j] - rendered[i] - step, 2.0);
            hard_error += std::pow(hard[j] - hard[i] - step, 2.0);
            ++count;
        }
    }
    EXPECT_GT(count, 100);
    EXPECT_LT(rendered_error, 0.01 * hard_error);
}

TEST(Terminator, IsSmoothUnderAPointLight) {
    RenderConfig config = dark();
    config.max_bounces = 0;
    const glm::vec3 place(8.0f, 3.0f, 1.0f);
    const auto add_lights = [&](Scene& scene) {
        add_light(scene, {.kind = LightKind::kPoint, .intensity = 50.0f}, {place});
    };
    const auto incoming = [&](const glm::vec3& p) {
        const float d = glm::distance(p, place);
        return Incoming{50.0f / (d * d), (place - p) / d};
    };
    for (const int levels : {2, 3, 4}) expect_smooth(levels, config, glm::normalize(place), add_lights, incoming);
}

TEST(Terminator, IsSmoothUnderTheSun) {
    RenderConfig config = dark();
    config.max_bounces = 0;
    config.sun_strength = 1.0f;
    const Sun sun = default_sun();
    const auto incoming = [&](const glm::vec3&) { return Incoming{sun.irradiance().r, sun.toward()}; };
    for (const int levels : {2, 3, 4})
        expect_smooth(
            levels, config, sun.toward(), [](Scene&) {}, incoming);
}

/// How many pixels of a film are not black.
int count_lit(const Film& film) {
    int count = 0;
    for (const glm::vec4& pixel : film.sum) count += glm::vec3(pixel) == glm::vec3(0.0f) ? 0 : 1;
    return count;
}

/// The ball that a coarse one stands for reaches through the wall, past which the light grazes.
TEST(Terminator, IsNoWayIntoAClosedRoom) {
    for (const float size : {1e-3f, 1.0f, 1e6f}) {
        Scene scene;
        const MaterialId white = add_diffuse(scene, glm::vec3(0.8f), true);
        add_node(scene, make_box(white), {{}, {1, 0, 0, 0}, glm::vec3(size)});
        const glm::quat edge_to_wall = glm::angleAxis(glm::pi<float>() / 8.0f, glm::vec3(0, 0, 1));
        add_node(scene, make_sphere(1, white, true),
                 {size * glm::vec3(0.545f, 0.0f, 0.0f), edge_to_wall, glm::vec3(0.49f * size)});
        add_light(scene, {.kind = LightKind::kPoint, .intensity = 1e3f * size * size}, {size * glm::vec3(1.1f, 5.0f, 0.3f)});
        const View view = look_at(size * glm::vec3(0.99f, 0.0f, 0.9f), size * glm::vec3(0.97f, 0.0f, 0.0f), 60.0f, 1.0f);
        EXPECT_EQ(count_lit(picture(scene, view, dark(), kSize, kSize, 8)), 0) << size;
    }
}

/// Light that is near below a corner is above the horizon of places beside it.
TEST(Terminator, LetsNoLightOutOfASingleSidedBall) {
    for (const float radius : {0.9f, 0.97f, 0.99f}) {
        Ball ball(1, glm::normalize(glm::vec3(1.0f, 0.3f, 0.2f)));
        add_light(ball.scene, {.kind = LightKind::kPoint, .intensity = 50.0f}, {radius * glm::vec3(1, 0, 0)});
        RenderConfig config = dark();
        config.max_bounces = 0;
        EXPECT_EQ(count_lit(picture(ball.scene, ball.view, config, kSize, kSize, 4)), 0) << radius;
    }
}

}  // namespace
}  // namespace zoe::test
