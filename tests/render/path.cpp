#include "engine/render/path.h"

#include <cmath>

#include <gtest/gtest.h>

#include "engine/math/parallel.h"
#include "engine/render/inspect.h"
#include "tests/render/scenes.h"

namespace zoe::test {
namespace {

/// Down onto [-1, 1]^2 at y = 0, all of which fills the picture.
View from_above() {
    View view = look_at({0, 10, 0}, {0, 0, 0}, 90.0f, 1.0f);
    view.is_perspective = false;
    view.half_width = view.half_height = 1.0f;
    return view;
}

/// A bit of everything that draws random numbers.
Scene busy_scene() {
    Scene scene;
    add_node(scene, make_floor(3.0f, -1.0f, add_diffuse(scene, {0.7f, 0.6f, 0.5f})));
    add_node(scene, make_sphere(2, add_diffuse(scene, {0.2f, 0.8f, 0.4f}), true));
    Material glass = make_diffuse();
    glass.base_color = {0.5f, 0.5f, 1.0f, 0.4f};
    glass.alpha_mode = AlphaMode::kBlend;
    add_node(scene, make_box(scene.add(glass)), {{1.2f, 0, 0.8f}, {1, 0, 0, 0}, glm::vec3(0.6f)});
    add_light(scene, {.kind = LightKind::kPoint, .intensity = 4.0f}, {{0, 2, 1}});
    add_light(scene, {.kind = LightKind::kPoint, .color = {1, 0.3f, 0.1f}, .intensity = 3.0f}, {{-2, 1, 1}});
    return scene;
}

const View kBusyView = look_at({0, 1.5f, 5}, {0, 0, 0}, 45.0f, 1.5f);

void expect_same(const Film& a, const Film& b) {
    EXPECT_EQ(a.sample_count, b.sample_count);
    EXPECT_TRUE(a.sum == b.sum);
    EXPECT_TRUE(a.depth == b.depth);
    EXPECT_TRUE(a.node == b.node);
    EXPECT_TRUE(a.primitive == b.primitive);
}

TEST(Path, OneAndTwoThreadsGiveTheSameBits) {
    Scene scene = busy_scene();
    FrameStats one, two;
    set_thread_count(1);
    const Film serial = picture(scene, kBusyView, {}, 75, 50, 4, &one);
    set_thread_count(2);
    const Film parallel = picture(scene, kBusyView, {}, 75, 50, 4, &two);
    set_thread_count(0);
    expect_same(serial, parallel);
    EXPECT_EQ(one.hits_hash, two.hits_hash);
    EXPECT_EQ(one.rays, two.rays);
    EXPECT_EQ(one.hits, two.hits);
}

TEST(Path, PassesMayBeSplitAnywhere) {
    Scene scene = busy_scene();
    const Tlas& tlas = advance(scene, 0.0);
    FrameStats whole_stats, split_stats;
    Film whole(75, 50), split(75, 50);
    EXPECT_TRUE(render(scene, tlas, kBusyView, {}, 4, &whole, &whole_stats));
    for (int count : {1, 1, 2}) EXPECT_TRUE(render(scene, tlas, kBusyView, {}, count, &split, &split_stats));
    expect_same(whole, split);
    EXPECT_EQ(whole_stats.hits_hash, split_stats.hits_hash);
    EXPECT_EQ(whole_stats.rays, split_stats.rays);
}

TEST(Path, CancellingLeavesTheFilmAlone) {
    Scene scene = busy_scene();
    const Tlas& tlas = advance(scene, 0.0);
    Film film(75, 50);
    render(scene, tlas, kBusyView, {}, 1, &film, nullptr);
    const Film before = film;
    std::atomic<bool> cancel = true;
    RenderConfig config;
    config.cancel = &cancel;
    FrameStats stats;
    EXPECT_FALSE(render(scene, tlas, kBusyView, config, 3, &film, &stats));
    expect_same(film, before);
    EXPECT_EQ(stats.rays, 0u);
}

TEST(Path, StatsCountEveryRayByItsKind) {
    Scene scene;
    add_node(scene, make_floor(100.0f, 0.0f, add_diffuse(scene, glm::vec3(0.5f))));
    RenderConfig config;
    config.max_bounces = 3;
    FrameStats stats;
    picture(scene, from_above(), config, 16, 16, 2, &stats);
    EXPECT_EQ(stats.primary.rays, 512u);
    EXPECT_EQ(stats.shadow.rays, 512u);   // one towards the sun from each hit
    EXPECT_EQ(stats.diffuse.rays, 512u);  // one bounce, that ends in the sky
    EXPECT_EQ(stats.rays, 1536u);
    EXPECT_EQ(stats.hits, 512u);
    EXPECT_NE(stats.hits_hash, 0u);
    EXPECT_GT(stats.trace_ms, 0.0);
    EXPECT_GT(stats.primary.ms + stats.diffuse.ms + stats.shadow.ms, 0.0);
    EXPECT_EQ(stats.frame_ms(), stats.trace_ms);
}

TEST(Path, EmissionIsSeenDirectlyAndLightsItsSurroundings) {
    Scene scene;
    Material lamp = make_diffuse();
    lamp.base_color = {0, 0, 0, 1};
    lamp.emission = {3, 2, 1};
    lamp.is_double_sided = true;
    add_node(scene, make_floor(1.0f, 0.0f, scene.add(lamp)));
    const glm::vec4 pixel = picture(scene, from_above(), dark(), 2, 2).pixel(0, 0);
    EXPECT_EQ(glm::vec3(pixel), glm::vec3(3, 2, 1));

    // A lamp 1 m x 1 m over a floor, 1 m up: the middle of the floor gets the form factor of four quarter squares.
    Scene room;
    add_node(room, make_floor(50.0f, 0.0f, add_diffuse(room, glm::vec3(1.0f))));
    add_node(room, make_floor(0.5f, 1.0f, room.add(lamp)));
    const float a = 0.5f, r = std::sqrt(1.0f + a * a);
    const float form_factor = 4.0f / (2.0f * 3.14159265f) * 2.0f * a / r * std::atan(a / r);
    RenderConfig config = dark();
    config.is_jittered = false;
    const View below = look_at({0.9f, 0.3f, 0}, {0, 0, 0}, 0.1f, 1.0f);
    EXPECT_NEAR(mean_radiance(picture(room, below, config, 32, 32, 64)).r, 3.0f * form_factor, 0.01f);
}

TEST(Path, UnlitShowsItsBaseColourWhateverTheLight) {
    Scene scene;
    Material material = make_diffuse();
    material.base_color = {0.2f, 0.4f, 0.8f, 1};
    material.is_unlit = true;
    add_node(scene, make_floor(1.0f, 0.0f, scene.add(material)));
    for (float strength : {0.0f, 5.0f}) {
        RenderConfig config = dark();
        config.sun_strength = config.sky_strength = strength;
        EXPECT_EQ(glm::vec3(picture(scene, from_above(), config, 1, 1).pixel(0, 0)), glm::vec3(0.2f, 0.4f, 0.8f));
    }
}

/// A floor that glows green under a white sheet with 2 x 2 texels: the top left one lets pass.
Scene sheet_scene(AlphaMode mode, int alpha_of_hole) {
    Scene scene;
    Material glow = make_diffuse();
    glow.base_color = {0, 0, 0, 1};
    glow.emission = {0, 1, 0};
    add_node(scene, make_floor(2.0f, -1.0f, scene.add(glow)));
    Image image;
    image.width = image.height = 2;
    image.pixels.assign(16, 255);
    image.pixels[3] = static_cast<uint8_t>(alpha_of_hole);
    scene.images.push_back(image);
    Material sheet = make_diffuse();
    sheet.base_color_texture.image = ImageId{0};
    sheet.base_color_texture.is_nearest = true;
    sheet.alpha_mode = mode;
    sheet.is_unlit = true;
    add_node(scene, make_floor(1.0f, 0.0f, scene.add(sheet)));
    return scene;
}

TEST(Path, AnAlphaMaskHasHoles) {
    Scene scene = sheet_scene(AlphaMode::kMask, 100);
    const Film film = picture(scene, from_above(), dark(), 2, 2);
    EXPECT_EQ(glm::vec3(film.pixel(0, 0)), glm::vec3(0, 1, 0));
    EXPECT_EQ(glm::vec3(film.pixel(1, 0)), glm::vec3(1, 1, 1));
    EXPECT_EQ(glm::vec3(film.pixel(0, 1)), glm::vec3(1, 1, 1));
    for (size_t i = 0; i < 4; ++i) {  // The layers are of geometry: holes don't matter.
        EXPECT_EQ(film.node[i], 1u);
        EXPECT_NEAR(film.depth[i], 10.0f, 1e-4f);
    }
    scene.materials[1].alpha_cutoff = 0.3f;  // 100 / 255 is above that: no hole
    EXPECT_EQ(glm::vec3(picture(scene, from_above(), dark(), 2, 2).pixel(0, 0)), glm::vec3(1, 1, 1));
    scene.materials[1].alpha_mode = AlphaMode::kOpaque;
    scene.materials[1].alpha_cutoff = 0.9f;
    EXPECT_EQ(glm::vec3(picture(scene, from_above(), dark(), 2, 2).pixel(0, 0)), glm::vec3(1, 1, 1));
}

TEST(Path, BlendingShowsEachLayerByItsShare) {
    Scene scene = sheet_scene(AlphaMode::kBlend, 102);  // 0.4
    const Film film = picture(scene, from_above(), dark(), 2, 2, 1024);
    EXPECT_NEAR(film.pixel(0, 0).r, 0.4f, 0.002f);
    EXPECT_EQ(film.pixel(0, 0).g, 1.0f);
    EXPECT_EQ(film.pixel(1, 0).r, 1.0f);
}

TEST(Path, ShadowsOfBlendedSurfacesLetTheRestPass) {
    Scene scene;
    add_node(scene, make_floor(5.0f, 0.0f, add_diffuse(scene, glm::vec3(0.5f))));
    Material pane = make_diffuse();
    pane.alpha_mode = AlphaMode::kBlend;
    const Trs down{{0, 5, 0}, glm::angleAxis(glm::radians(-90.0f), glm::vec3(1, 0, 0)), glm::vec3(1)};
    add_light(scene, {.kind = LightKind::kDirectional, .intensity = 2.0f}, down);
    scene.add(pane);
    add_node(scene, make_floor(1.0f, 1.0f, MaterialId{1}));
    add_node(scene, make_floor(1.0f, 2.0f, MaterialId{1}));
    // The camera looks below the panes; light comes through both.
    const View view = look_at({3, 0.5f, 0}, {0.05f, 0, 0.03f}, 1.0f, 1.0f);
    RenderConfig config = dark();
    config.max_bounces = 0;
    for (float alpha : {0.0f, 0.25f, 1.0f}) {
        scene.materials[1].base_color.a = alpha;
        const float expected = 0.5f / 3.14159265f * 2.0f * (1.0f - alpha) * (1.0f - alpha);
        EXPECT_NEAR(picture(scene, view, config, 1, 1).pixel(0, 0).r, expected, 1e-5f);
    }
}

TEST(Path, LayersHoldDepthAlongTheAxisAndIds) {
    Scene scene;
    add_node(scene, make_floor(1.0f, 0.0f, add_diffuse(scene, glm::vec3(0.5f))));
    const View view = look_at({0, 2, 0}, {0, 0, 0}, 120.0f, 1.0f);
    const Film film = picture(scene, view, dark(), 9, 9, 3);
    int hits = 0;
    for (size_t i = 0; i < film.depth.size(); ++i) {
        if (film.node[i] == 0) {
            ++hits;
            EXPECT_NEAR(film.depth[i], 2.0f, 1e-5f);
            EXPECT_LT(film.primitive[i], 2u);
            EXPECT_EQ(film.sum[i].a, 3.0f);  // not jittered: coverage has no edges
        } else {
            EXPECT_EQ(film.depth[i], std::numeric_limits<float>::infinity());
            EXPECT_EQ(film.node[i], 0xffffffffu);
            EXPECT_EQ(film.primitive[i], 0xffffffffu);
            EXPECT_EQ(film.sum[i].a, 0.0f);
        }
    }
    EXPECT_TRUE(hits > 0 && hits < 81) << hits;
}

TEST(Path, LayersHoldTheClosestHitsOfPixelCentresInEveryShade) {
    Scene scene = busy_scene();
    const Tlas& tlas = advance(scene, 0.0);
    for (Shade shade : {Shade::kPath, Shade::kNormal, Shade::kCost}) {
        for (bool is_jittered : {false, true}) {
            RenderConfig config;
            config.shade = shade;
            config.is_jittered = is_jittered;
            const Film film = picture(scene, kBusyView, config, 30, 20, 2);
            for (int y = 0; y < 20; ++y) {
                for (int x = 0; x < 30; ++x) {
                    const Ray ray =
                        camera_ray(kBusyView, static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f, 30, 20);
                    const Hit hit = closest_hit(tlas, ray);
                    const size_t i = static_cast<size_t>(y * 30 + x);
                    EXPECT_EQ(film.node[i], index(hit.node));
                    EXPECT_EQ(film.primitive[i], hit.primitive);
                    if (hit) {
                        EXPECT_NEAR(film.depth[i], depth(kBusyView, ray.origin + hit.t * ray.direction), 1e-5f);
                    } else {
                        EXPECT_EQ(film.depth[i], std::numeric_limits<float>::infinity());
                    }
                }
            }
        }
    }
}

TEST(Path, OtherShadesShowColourNormalMotionAndCost) {
    Scene scene;
    add_node(scene, make_floor(1.0f, 0.0f, add_diffuse(scene, {0.1f, 0.2f, 0.3f})));
    RenderConfig config = dark();
    config.shade = Shade::kAlbedo;
    EXPECT_EQ(glm::vec3(picture(scene, from_above(), config, 1, 1).pixel(0, 0)), glm::vec3(0.1f, 0.2f, 0.3f));
    config.shade = Shade::kNormal;
    EXPECT_LT(glm::distance(glm::vec3(picture(scene, from_above(), config, 1, 1).pixel(0, 0)), glm::vec3(0.5f, 1, 0.5f)),
              1e-5f);
    config.shade = Shade::kMotion;
    const glm::vec3 motion = picture(scene, from_above(), config, 1, 1).pixel(0, 0);
    EXPECT_LT(glm::distance(motion, motion_color(Motion::kStatic)), 1e-5f);
    config.shade = Shade::kCost;
    const Film film = picture(scene, from_above(), config, 1, 1);
    TraverseCounts counts;
    closest_hit(advance(scene, 0.0), camera_ray(from_above(), 0.5f, 0.5f, 1, 1), &counts);
    EXPECT_GT(counts.nodes + counts.triangles, 0u);
    EXPECT_EQ(glm::vec3(film.pixel(0, 0)), cost_color(counts.nodes + counts.triangles));
    EXPECT_EQ(film.node[0], 0u);
}

TEST(Path, ShadesAreFoundByName) {
    EXPECT_EQ(shade_from_name("path"), Shade::kPath);
    EXPECT_EQ(shade_from_name("cost"), Shade::kCost);
    EXPECT_FALSE(shade_from_name("Path"));
    EXPECT_FALSE(shade_from_name(""));
}

TEST(Path, MoreCostIsNeverDarkerAndMotionClassesDifferInBrightness) {
    const auto brightness = [](const glm::vec3& c) { return glm::dot(c, glm::vec3(0.2126f, 0.7152f, 0.0722f)); };
    for (uint32_t tests = 1; tests <= 4 * kCostScale; ++tests) {
        EXPECT_GE(brightness(cost_color(tests)), brightness(cost_color(tests - 1))) << tests;
    }
    EXPECT_EQ(cost_color(kCostScale), cost_color(4 * kCostScale));
    for (int a = 0; a < kMotionCount; ++a) {
        for (int b = 0; b < a; ++b) {
            EXPECT_GT(glm::distance(motion_color(Motion(a)), motion_color(Motion(b))), 0.15f);
        }
    }
}

TEST(Path, AnEmptySceneIsAllSky) {
    Scene scene;
    const Film film = picture(scene, look_at({0, 0, 0}, {0, 0, -1}, 90.0f, 1.0f), {}, 4, 4, 2);
    for (const glm::vec4& pixel : film.sum) {
        EXPECT_GT(pixel.b, 0.0f);
        EXPECT_EQ(pixel.a, 0.0f);
    }
    EXPECT_GT(film.pixel(1, 0).b - film.pixel(1, 0).r, film.pixel(1, 3).b - film.pixel(1, 3).r);  // blue above
}

}  // namespace
}  // namespace zoe::test
