#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "engine/math/parallel.h"
#include "tests/math/random_inputs.h"
#include "tests/stability/scenes.h"

namespace zoe::test {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

TEST(Scenes, AnEmptySceneIsMissedByEveryRay) {
    Scene scene;
    const Tlas& tlas = advance(scene, 0.0);
    EXPECT_FALSE(closest_hit(tlas, Ray{}));
    EXPECT_FALSE(any_hit(tlas, Ray{}));
    EXPECT_TRUE(tlas.bounds().is_empty());
    Scene nodes_only;
    add_node(nodes_only, kNone<MeshId>, placed({1, 2, 3}));
    EXPECT_FALSE(closest_hit(advance(nodes_only, 1.0), Ray{}));
    Scene empty_mesh;
    add_node(empty_mesh, empty_mesh.add(Mesh{}), Affine{});
    EXPECT_FALSE(closest_hit(advance(empty_mesh, 1.0), Ray{}));
}

TEST(Scenes, ATimeThatIsNotFiniteIsRefused) {
    Scene scene;
    add_node(scene, scene.add(ball(8)), Affine{});
    for (const double time : {double{kNan}, double{kInf}, -double{kInf}}) {
        EXPECT_THROW(advance(scene, time), std::invalid_argument);
    }
    EXPECT_TRUE(closest_hit(advance(scene, 1e12), {{0, 0, 5}, {0, 0, -1}})) << "huge is fine";
    EXPECT_TRUE(closest_hit(advance(scene, -1e12), {{0, 0, 5}, {0, 0, -1}}));
}

TEST(Scenes, AChainOfAHundredThousandNodesAdvances) {
    constexpr int kCount = 100000;
    Scene scene;
    const MeshId mesh = scene.add(facing_triangle());
    NodeId parent = kNone<NodeId>;
    for (int k = 0; k < kCount; ++k) {
        Node node;
        node.parent = parent;
        node.local.translation = {0, 0, -0.25f};
        parent = scene.add(node);
    }
    const NodeId last = add_node(scene, mesh, Affine{}, parent);
    const Hit hit = closest_hit(advance(scene, 0.0), {{0, 0, 0}, {0, 0, -1}});
    EXPECT_EQ(hit.node, last);
    EXPECT_EQ(hit.t, 0.25f * kCount);
}

TEST(Scenes, AChainWithChildrenBeforeTheirParentsAdvances) {
    constexpr int kCount = 100000;
    Scene scene;
    const MeshId mesh = scene.add(facing_triangle());
    for (int k = 0; k < kCount; ++k) {
        Node node;
        node.parent = k + 1 < kCount ? NodeId(k + 1) : kNone<NodeId>;
        node.local.translation = {0, 0, -0.25f};
        if (k == 0) node.mesh = mesh;
        scene.add(node);
    }
    EXPECT_EQ(closest_hit(advance(scene, 0.0), {{0, 0, 0}, {0, 0, -1}}).t, 0.25f * kCount);
}

TEST(Scenes, ACycleAndAMissingParentAreRefused) {
    Scene cycle;
    const MeshId mesh = cycle.add(ball(8));
    add_node(cycle, mesh, Affine{}, NodeId(1));
    add_node(cycle, mesh, Affine{}, NodeId(0));
    EXPECT_THROW(advance(cycle, 0.0), SceneError);
    Scene missing;
    add_node(missing, missing.add(ball(8)), Affine{}, NodeId(7));
    EXPECT_THROW(advance(missing, 0.0), SceneError);
    Scene self;
    add_node(self, self.add(ball(8)), Affine{}, NodeId(0));
    EXPECT_THROW(advance(self, 0.0), SceneError);
}

TEST(Scenes, AHugeInstanceOverManyTinyOnesIsTracedRight) {
    Scene scene;
    const MeshId mesh = scene.add(ball(16));
    const NodeId stadium = add_node(scene, mesh, placed({0, 0, 0}, glm::vec3(1e4f)));
    std::vector<NodeId> teapots;
    for (int k = 0; k < 400; ++k) {
        teapots.push_back(add_node(scene, mesh, placed({float(k % 20), float(k / 20), 0}, glm::vec3(0.01f))));
    }
    const Tlas& tlas = advance(scene, 0.0);
    for (int k = 0; k < 400; ++k) {
        const Hit hit = closest_hit(tlas, {{float(k % 20), float(k / 20), 2}, {0, 0, -1}});
        ASSERT_EQ(hit.node, teapots[k]) << k;
        ASSERT_NEAR(hit.t, 1.99f, 1e-3f);
        const Hit beside = closest_hit(tlas, {{k % 20 + 0.5f, k / 20 + 0.5f, 2}, {0, 0, -1}});
        ASSERT_EQ(beside.node, stadium) << k;
    }
}

TEST(Scenes, CoincidentInstancesAreHitInTheOrderOfTheirNodes) {
    Scene scene;
    const MeshId mesh = scene.add(ball(16));
    for (int k = 0; k < 300; ++k) add_node(scene, mesh, placed({0, 0, -5}));
    Rng rng(211);
    const Tlas& tlas = advance(scene, 0.0);
    for (int k = 0; k < 2000; ++k) {
        const Ray ray{{0, 0, 0}, glm::vec3(0, 0, -5) + random_point(rng, 0.6f)};
        const Hit hit = closest_hit(tlas, ray);
        if (hit) {
            ASSERT_EQ(hit.node, NodeId{0});
        }
        ASSERT_EQ(any_hit(tlas, ray), bool(hit));
    }
    EXPECT_TRUE(closest_hit(tlas, {{0, 0, 0}, {0, 0, -1}}));
}

TEST(Scenes, CoincidentCopiesOfTheMeshAreHitInTheOrderOfTheirNodesToo) {
    // Different BLASes, in the space of the world and in one of their own.
    Scene scene;
    for (int k = 0; k < 20; ++k) add_node(scene, scene.add(ball(16)), k % 2 ? placed({0, 0, 0}) : Affine{});
    for (int k = 0; k < 100; ++k) {
        const Ray ray{{0, 0, 5}, glm::vec3(0.001f * float(k), 0, -1)};
        EXPECT_EQ(closest_hit(advance(scene, 0.0), ray).node, NodeId{0});
    }
}

TEST(Scenes, ANodeMatrixThatIsNotFiniteIsRefusedOrDropped) {
    Scene scene;
    const MeshId mesh = scene.add(ball(8));
    Affine bad;
    bad.translation.y = kNan;
    add_node(scene, mesh, bad);
    const NodeId shown = add_node(scene, mesh, placed({0, 0, -5}));
    try {
        EXPECT_EQ(closest_hit(advance(scene, 0.0), {{0, 0, 5}, {0, 0, -1}}).node, shown);
        EXPECT_FALSE(scene.warnings().empty());
    } catch (const SceneError& error) {
        EXPECT_NE(std::string(error.what()), "");
    }
}

TEST(Scenes, CornersOutOfRangeAreRefused) {
    Scene scene;
    Mesh mesh = ball(8);
    mesh.corners[3].y = uint32_t(mesh.positions.size());
    add_node(scene, scene.add(mesh), Affine{});
    EXPECT_THROW(advance(scene, 0.0), SceneError);
    Scene written;
    const MeshId id = written.add(ball(8));
    const std::vector<glm::vec3> positions(3, glm::vec3(0.0f));
    const std::vector<glm::uvec3> corners = {{0, 1, 3}};
    EXPECT_THROW(written.write_mesh(id, positions, {}, corners), SceneError);
}

TEST(Scenes, AWrittenMeshMayShrinkToNothingBreakAndComeBack) {
    Scene scene;
    const Mesh good = ball(12);
    const MeshId mesh = scene.add(good);
    add_node(scene, mesh, Affine{});
    const Ray ray{{0.1f, 0.2f, 5}, {0, 0, -1}};
    const Hit first = closest_hit(advance(scene, 0.0), ray);
    ASSERT_TRUE(first);
    scene.write_mesh(mesh, {}, {}, {});
    EXPECT_FALSE(closest_hit(advance(scene, 1.0), ray));
    const std::vector<glm::vec3> broken(good.positions.size(), glm::vec3(kNan));
    scene.write_mesh(mesh, broken, {}, good.corners);
    EXPECT_FALSE(closest_hit(advance(scene, 2.0), ray));
    const std::vector<glm::vec3> flat(good.positions.size(), glm::vec3(0.1f, 0.2f, 0.0f));
    scene.write_mesh(mesh, flat, {}, good.corners);
    EXPECT_FALSE(closest_hit(advance(scene, 3.0), ray)) << "all in one point";
    scene.write_mesh(mesh, good.positions, {}, good.corners);
    EXPECT_EQ(closest_hit(advance(scene, 4.0), ray), first);
    EXPECT_EQ(motion(scene, NodeId{0}), Motion::kArbitrary);
}

TEST(Scenes, GiveTheSameHitsOnAnyNumberOfThreads) {
    const uint64_t seed = 213;
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    std::vector<Hit> reference;
    for (const int threads : {1, 2, 4}) {
        set_thread_count(threads);
        Rng rng(seed);
        Scene scene;
        for (int k = 0; k < 50; ++k) {
            const MeshId mesh = scene.add(ball(8 + 2 * (k % 20)));
            add_node(scene, mesh, random_affine(rng, 0.5, 2.0, 8.0f));
        }
        const Tlas& tlas = advance(scene, 0.0);
        std::vector<Ray> rays;
        for (int k = 0; k < 5000; ++k) rays.push_back({random_point(rng, 15.0f), random_direction(rng)});
        std::vector<Hit> hits(rays.size());
        closest_hits(tlas, rays, hits);
        if (threads == 1) reference = hits;
        EXPECT_EQ(hits, reference) << threads << " threads";
    }
    set_thread_count(0);
}

TEST(Scenes, PermutingNodesPermutesTheAnswersOnly) {
    const uint64_t seed = 214;
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Rng rng(seed);
    std::vector<Affine> places;
    for (int k = 0; k < 100; ++k) places.push_back(random_affine(rng, 0.5, 2.0, 12.0f));
    Scene forward, backward;
    const MeshId a = forward.add(ball(16)), b = backward.add(ball(16));
    for (int k = 0; k < 100; ++k) {
        add_node(forward, a, places[k]);
        add_node(backward, b, places[99 - k]);
    }
    const Tlas& one = advance(forward, 0.0);
    const Tlas& two = advance(backward, 0.0);
    int hits = 0;
    for (int k = 0; k < 5000; ++k) {
        const Ray ray{random_point(rng, 20.0f), random_direction(rng)};
        const Hit hit = closest_hit(one, ray);
        Hit other = closest_hit(two, ray);
        if (other) other.node = NodeId{99 - index(other.node)};
        ASSERT_EQ(hit, other) << "ray " << k;
        hits += bool(hit);
    }
    EXPECT_GT(hits, 500);
}

}  // namespace
}  // namespace zoe::test
