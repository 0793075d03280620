// Vertices that are NaN or infinite: left out, counted, and no trouble to what is beside them.

#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/math/random_inputs.h"
#include "tests/stability/scenes.h"

namespace zoe::test {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

TEST(Scenes, VerticesThatAreNotFiniteWarnAndAreNeverHit) {
    Scene scene;
    Mesh broken = ball(24);
    const size_t triangle_count = broken.corners.size();
    std::vector<bool> is_broken(broken.positions.size(), false);
    for (size_t k = 5; k < broken.positions.size(); k += 9) {
        broken.positions[k][k % 3] = k % 2 ? kNan : kInf;
        is_broken[k] = true;
    }
    const MeshId mesh = scene.add(broken);
    add_node(scene, mesh, Affine{});
    add_node(scene, mesh, placed({3, 0, 0}, {1, 2, -1}));
    const Tlas& tlas = advance(scene, 0.0);
    EXPECT_TRUE(tlas.bounds().is_finite());
    EXPECT_FALSE(scene.warnings().empty());
    Rng rng(212);
    int hits = 0;
    for (int k = 0; k < 5000; ++k) {
        const Ray ray{random_direction(rng) * 6.0f, random_direction(rng)};
        const Hit hit = closest_hit(tlas, ray);
        ASSERT_TRUE(is_sane(hit, ray));
        if (!hit) continue;
        ++hits;
        ASSERT_LT(hit.primitive, triangle_count);
        const glm::uvec3 c = broken.corners[hit.primitive];
        ASSERT_FALSE(is_broken[c.x] || is_broken[c.y] || is_broken[c.z]);
    }
    EXPECT_GT(hits, 50);
}

/// `count` triangles side by side, of which the first `broken_count` have a corner that is not finite.
Mesh with_broken(uint32_t count, uint32_t broken_count) {
    Mesh mesh;
    for (uint32_t k = 0; k < count; ++k) {
        const auto x = static_cast<float>(k);
        for (const glm::vec3& p : {glm::vec3(x, 0, 0), glm::vec3(x + 1, 0, 0), glm::vec3(x, 1, 0)})
            mesh.positions.push_back(p);
        if (k < broken_count) mesh.positions.back()[int(k % 3)] = k % 2 ? kNan : -kInf;
        mesh.corners.push_back({3 * k, 3 * k + 1, 3 * k + 2});
    }
    return mesh;
}

std::string warnings_text(const Scene& scene) {
    std::string text;
    for (const auto& [line, count] : scene.warnings()) text += line + " x" + std::to_string(count) + "\n";
    return text;
}

TEST(Scenes, AWarningCountsTheTrianglesThatAreNotFinite) {
    for (const uint32_t broken_count : {1u, 1000u}) {
        Scene scene;
        const MeshId mesh = scene.add(with_broken(1500, broken_count));
        const NodeId node = add_node(scene, mesh, Affine{});
        add_node(scene, mesh, placed({0, 3, 0}));  // The same tree.
        scene[node].name = "field";
        for (int frame = 0; frame < 3; ++frame) advance(scene, frame);
        scene.touch();
        const Hit hit = closest_hit(advance(scene, 3.0), {{1200.25f, 0.25f, 5}, {0, 0, -1}});
        EXPECT_EQ(hit.primitive, 1200u);
        const std::string triangles = broken_count == 1 ? "1 triangle" : "1000 triangles";
        EXPECT_EQ(warnings_text(scene), "node 0 'field': " + triangles + " with NaN or infinite corners: never hit x1\n");
    }
}

TEST(Scenes, AMeshThatIsWrittenEachFrameIsWarnedOfOnceAndAgainWhereTwiceAsMuchIsBroken) {
    Scene scene;
    const MeshId mesh = scene.add(with_broken(8, 0));
    add_node(scene, mesh, Affine{});
    for (uint32_t broken_count = 0; broken_count < 1000; ++broken_count) {
        const Mesh written = with_broken(1000, broken_count);
        scene.write_mesh(mesh, written.positions, {}, written.corners);
        advance(scene, broken_count);
    }
    EXPECT_EQ(scene.warnings().size(), 10u) << warnings_text(scene);  // 1, 2, 4, ... 512
    for (const auto& [line, count] : scene.warnings()) EXPECT_EQ(count, 1u) << line;
}

TEST(Scenes, AMeshOfNothingButNanIsNotShown) {
    Scene scene;
    Mesh mesh = ball(8);
    for (glm::vec3& p : mesh.positions) p = glm::vec3(kNan);
    add_node(scene, scene.add(mesh), Affine{});
    const NodeId shown = add_node(scene, scene.add(ball(8)), placed({0, 0, -5}));
    for (int frame = 0; frame < 2; ++frame) {
        const Hit hit = closest_hit(advance(scene, frame), {{0, 0, 5}, {0, 0, -1}});
        EXPECT_EQ(hit.node, shown);
    }
    EXPECT_FALSE(scene.warnings().empty());
}

}  // namespace
}  // namespace zoe::test
