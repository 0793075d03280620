#include "engine/render/glow.h"

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "engine/math/rng.h"
#include "tests/render/scenes.h"

namespace zoe::test {
namespace {

Material make_lamp(const glm::vec3& emission) {
    Material lamp = make_diffuse();
    lamp.base_color = {0, 0, 0, 1};
    lamp.emission = emission;
    lamp.is_double_sided = true;
    return lamp;
}

TEST(AliasTable, PicksInProportionToTheWeightsAndNothingOfWeightZero) {
    const uint64_t seed = 71;
    SCOPED_TRACE(seed);
    Rng rng(seed);
    AliasTable table;
    for (const size_t size : {size_t{1}, size_t{2}, size_t{7}, size_t{100}, size_t{3}}) {
        std::vector<float> weights(size);
        for (float& weight : weights) weight = rng.below(3) == 0 ? 0.0f : std::exp(rng.uniform(-6.0f, 3.0f));
        weights[size / 2] = 1.0f;
        table.build(weights);
        double total = 0.0;
        for (const float weight : weights) total += static_cast<double>(weight);
        EXPECT_DOUBLE_EQ(table.total(), total);
        // Equally spaced numbers pick each index as often as its share says, to one slot's worth.
        constexpr int kCount = 1 << 20;
        std::vector<int> counts(size, 0);
        for (int i = 0; i < kCount; ++i) ++counts[table.pick((static_cast<float>(i) + 0.5f) / kCount)];
        for (size_t i = 0; i < size; ++i) {
            EXPECT_NEAR(counts[i] / double(kCount), static_cast<double>(weights[i]) / total, 1e-4) << i << " of " << size;
            if (weights[i] == 0.0f) {
                EXPECT_EQ(counts[i], 0);
            }
        }
    }
    table.build(std::vector<float>(5, 0.0f));
    EXPECT_EQ(table.total(), 0.0);
}

TEST(Glow, TrianglesArePickedByAreaTimesBrightnessInTheWorld) {
    Scene scene;
    const MaterialId dim = scene.add(make_lamp(glm::vec3(1.0f))), bright = scene.add(make_lamp({0, 3, 1}));
    const NodeId large = add_node(scene, make_floor(1.0f, 0.0f, dim), {{0, 0, 0}, {1, 0, 0, 0}, {2, 1, 3}});  // 24 m2
    const NodeId small = add_node(scene, make_floor(1.0f, 1.0f, bright));                                     // 4 m2
    add_node(scene, make_floor(9.0f, 2.0f, add_diffuse(scene, glm::vec3(1.0f))));
    const NodeId hidden = add_node(scene, make_floor(9.0f, 3.0f, bright));
    scene[hidden].is_shown = false;
    const Tlas& tlas = advance(scene, 0.0);
    Glow glow;
    glow.gather(scene, tlas);
    EXPECT_FLOAT_EQ(glow.density(dim), 1.0f / 36.0f);
    EXPECT_FLOAT_EQ(glow.density(bright), 3.0f / 36.0f);
    EXPECT_EQ(glow.density(kNone<MaterialId>), 0.0f);
    Rng rng(72);
    int of_large = 0;
    glm::dvec2 mean(0.0);
    constexpr int kCount = 60000;
    for (int i = 0; i < kCount; ++i) {
        const Hit hit = glow.sample(rng.uniform(), {rng.uniform(), rng.uniform()});
        EXPECT_TRUE(hit.u >= 0.0f && hit.v >= 0.0f && hit.u + hit.v <= 1.0f + 1e-6f);
        EXPECT_TRUE(hit.node == large || hit.node == small);
        of_large += hit.node == large ? 1 : 0;
        mean += glm::dvec2(hit.u, hit.v) / static_cast<double>(kCount);
    }
    EXPECT_NEAR(of_large / double(kCount), 24.0 / 36.0, 0.01);
    EXPECT_NEAR(mean.x, 1.0 / 3.0, 0.01);
    EXPECT_NEAR(mean.y, 1.0 / 3.0, 0.01);
    Scene dark;
    add_node(dark, make_floor(1.0f, 0.0f, add_diffuse(dark, glm::vec3(1.0f))));
    glow.gather(dark, advance(dark, 0.0));
    EXPECT_TRUE(glow.is_dark());
}

TEST(Glow, LampsWithoutAreaOrFiniteCornersShineNothing) {
    Scene scene;
    const MaterialId lamp = scene.add(make_lamp(glm::vec3(5.0f)));
    Mesh mesh = make_floor(1.0f, 0.0f, lamp);
    mesh.positions.assign(4, glm::vec3(1.0f));
    add_node(scene, mesh);
    mesh.positions[1] = glm::vec3(std::numeric_limits<float>::quiet_NaN());
    add_node(scene, mesh);
    Glow glow;
    glow.gather(scene, advance(scene, 0.0));
    EXPECT_TRUE(glow.is_dark());
}

/// The light of a small lamp over the middle of a rough, partly shiny floor.
glm::vec3 under_lamp(float size, float brightness, int sample_count, float roughness) {
    Scene scene;
    Material floor;
    floor.base_color = {0.8f, 0.6f, 0.4f, 1};
    floor.metallic = 0.5f;
    floor.roughness = roughness;
    add_node(scene, make_floor(5.0f, 0.0f, scene.add(floor)));
    Mesh lamp = make_floor(size, 2.0f, scene.add(make_lamp(glm::vec3(brightness))));
    add_node(scene, std::move(lamp));
    RenderConfig config = dark();
    config.max_bounces = 1;
    return mean_radiance(picture(scene, look_at({1.5f, 1, 0}, {0, 0, 0}, 2.0f, 1.0f), config, 16, 16, sample_count));
}

TEST(Glow, BothWaysOfFindingALampAgree) {
    // A point light of the same intensity is what a small lamp comes to; its floor is found by shadow rays alone.
    Scene scene;
    Material floor;
    floor.base_color = {0.8f, 0.6f, 0.4f, 1};
    floor.metallic = 0.5f;
    floor.roughness = 0.6f;
    add_node(scene, make_floor(5.0f, 0.0f, scene.add(floor)));
    const float size = 0.02f, area = 4.0f * size * size, radiance = 10000.0f;
    add_light(scene, {.kind = LightKind::kPoint, .intensity = radiance * area}, {{0, 2, 0}});
    RenderConfig config = dark();
    config.max_bounces = 0;
    const glm::vec3 point = mean_radiance(picture(scene, look_at({1.5f, 1, 0}, {0, 0, 0}, 2.0f, 1.0f), config, 16, 16, 1));
    const glm::vec3 lamp = under_lamp(size, radiance, 16, 0.6f);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(lamp[c], point[c], 0.01f * point[c]);
}

// What is kept from one frame to the next is what would be made anew.
TEST(Glow, FollowsLampsThatChange) {
    Scene scene;
    const MaterialId first = scene.add(make_lamp(glm::vec3(1.0f))), second = scene.add(make_lamp(glm::vec3(2.0f)));
    const NodeId a = add_node(scene, make_floor(1.0f, 0.0f, first)), b = add_node(scene, make_floor(2.0f, 1.0f, second));
    Glow kept;
    double time_s = 0.0;
    const auto expect_fresh = [&](const char* what) {
        SCOPED_TRACE(what);
        const Tlas& tlas = advance(scene, time_s += 1.0);
        Glow fresh;
        fresh.gather(scene, tlas);
        kept.gather(scene, tlas);
        EXPECT_EQ(kept.is_dark(), fresh.is_dark());
        for (const MaterialId material : {first, second}) EXPECT_EQ(kept.density(material), fresh.density(material));
        if (fresh.is_dark()) return;
        for (int k = 0; k < 256; ++k) {
            const float u = (float(k) + 0.5f) / 256.0f;
            EXPECT_EQ(kept.sample(u, {0.3f, 0.4f}), fresh.sample(u, {0.3f, 0.4f})) << u;
        }
    };
    expect_fresh("at first");
    expect_fresh("the same");
    scene.materials[index(first)].emission = glm::vec3(4.0f);
    scene[a].local.scale = glm::vec3(0.5f);
    expect_fresh("brighter and smaller: as much light");
    scene[b].local.scale = glm::vec3(0.0f);
    expect_fresh("one is hidden");
    scene[a].local.scale = glm::vec3(0.0f);
    expect_fresh("both are hidden");
    scene[a].local.scale = scene[b].local.scale = glm::vec3(1.0f);
    expect_fresh("both are back");
    scene.materials[index(first)].emission = glm::vec3(0.0f);
    expect_fresh("one is out");
    Mesh smaller = make_floor(0.5f, 3.0f, second);
    scene.write_mesh(scene[b].mesh, smaller.positions, {}, std::span(smaller.corners).first(1));
    expect_fresh("fewer triangles");
}

TEST(Glow, ALampBehindABlendedPaneShinesThroughIt) {
    for (float alpha : {0.0f, 0.25f, 1.0f}) {
        Scene scene;
        add_node(scene, make_floor(5.0f, 0.0f, add_diffuse(scene, glm::vec3(0.5f))));
        add_node(scene, make_floor(0.5f, 2.0f, scene.add(make_lamp(glm::vec3(4.0f)))));
        Material pane = make_diffuse();
        pane.base_color = {0, 0, 0, alpha};
        pane.alpha_mode = AlphaMode::kBlend;
        pane.is_double_sided = true;
        const View view = look_at({3, 0.3f, 0}, {0, 0, 0}, 2.0f, 1.0f);
        const float bare = mean_radiance(picture(scene, view, dark(), 16, 16, 64)).r;
        add_node(scene, make_floor(4.0f, 1.0f, scene.add(pane)));
        scene.touch();
        const float veiled = mean_radiance(picture(scene, view, dark(), 16, 16, 64)).r;
        EXPECT_NEAR(veiled, bare * (1.0f - alpha), 0.02f * bare) << alpha;
    }
}

}  // namespace
}  // namespace zoe::test
