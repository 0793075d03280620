#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/ext/vector_double3.hpp>
#include <glm/geometric.hpp>

#include <gtest/gtest.h>

#include "tests/math/random_inputs.h"
#include "tests/stability/scenes.h"

namespace zoe::test {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();

/// Largest number that a float's rounding of points and rays is relative to.
double magnitude(const Tlas& tlas, const Ray& ray) {
    double m = 0.0;
    for (int k = 0; k < 3; ++k) {
        m = std::max({m, std::abs(double{ray.origin[k]}), std::abs(double{tlas.bounds().lo[k]}),
                      std::abs(double{tlas.bounds().hi[k]})});
    }
    return m;
}

/// Rays at the inside of random triangles of one instance, from a few sizes away, agree with exact hits.
/// Returns    how many were compared.
int expect_exact_hits(const Tlas& tlas, Rng& rng, int ray_count, double allowed) {
    int compared = 0;
    for (int k = 0; k < ray_count; ++k) {
        const Instance& instance = tlas.instances[rng.below(uint32_t(tlas.instances.size()))];
        const glm::uvec3 c = instance.mesh->corners[rng.below(uint32_t(instance.mesh->corners.size()))];
        const float u = rng.uniform(0.1f, 0.4f), v = rng.uniform(0.1f, 0.4f);
        const glm::vec3 local =
            instance.positions[c.x] * (1 - u - v) + instance.positions[c.y] * u + instance.positions[c.z] * v;
        const glm::vec3 target = instance.world_from_local.point(local);
        const float size = glm::length(instance.bounds_world.extent());
        Ray ray;
        ray.origin = target + random_direction(rng) * (size * rng.uniform(1.5f, 4.0f));
        ray.direction = (target - ray.origin) * log_uniform(rng, 0.1, 10.0);
        const Hit hit = closest_hit(tlas, ray);
        EXPECT_TRUE(is_sane(hit, ray)) << "ray " << k;
        EXPECT_EQ(any_hit(tlas, ray), bool(hit)) << "ray " << k;
        const ExactHit exact = exact_hit(tlas, ray);
        // Where two surfaces are nearly equally far, or an edge is near, rounding may choose either.
        if (!(exact.edge > 0.02) || exact.second_t - exact.t < 1e-3 * exact.t) continue;
        ++compared;
        EXPECT_TRUE(hit) << "ray " << k;
        if (!hit) continue;
        EXPECT_EQ(index(hit.node), exact.node) << "ray " << k;
        const double length = glm::length(glm::dvec3(ray.direction));
        // A point that rounding moves across the ray moves along it by that over the cosine.
        const double bound = allowed * (magnitude(tlas, ray) + exact.t * length) / exact.cosine;
        EXPECT_LE(std::abs(hit.t - exact.t) * length, bound) << "ray " << k;
        if (testing::Test::HasFailure()) return compared;
    }
    return compared;
}

TEST(Transforms, HitsAreExactAtScalesFromAMillionthToAMillion) {
    const uint64_t seed = 201;
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Rng rng(seed);
    for (double scale = 1e-6; scale < 2e6; scale *= 10.0) {
        SCOPED_TRACE(scale);
        Scene scene;
        const MeshId mesh = scene.add(ball(24));
        add_node(scene, mesh, {glm::mat3_cast(random_rotation(rng)) * float(scale), random_point(rng, float(scale))});
        EXPECT_GT(expect_exact_hits(advance(scene, 0.0), rng, 300, 2e-6), 100);
    }
}

TEST(Transforms, ShearMirrorAndNonUniformScaleAreExact) {
    const uint64_t seed = 202;
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Rng rng(seed);
    for (int round = 0; round < 30; ++round) {
        SCOPED_TRACE(round);
        Scene scene;
        const MeshId mesh = scene.add(ball(24));
        add_node(scene, mesh, random_affine(rng, 0.2, 5.0, 3.0f));
        EXPECT_GT(expect_exact_hits(advance(scene, 0.0), rng, 200, 2e-6), 50);
    }
}

TEST(Transforms, NestedScalesThatCancelAreExact) {
    Rng rng(203);
    Scene scene;
    const MeshId mesh = scene.add(ball(24));
    NodeId parent = kNone<NodeId>;
    for (int k = 0; k < 12; ++k) {
        const float scale = k % 2 ? 1e-6f : 1e6f;
        parent = add_node(scene, kNone<MeshId>, placed(glm::vec3(0.0f), glm::vec3(scale)), parent);
    }
    add_node(scene, mesh, placed({1, 2, 3}), parent);
    EXPECT_GT(expect_exact_hits(advance(scene, 0.0), rng, 300, 2e-6), 100);
}

TEST(Transforms, FarFromTheOriginTheErrorStaysRelativeToTheDistance) {
    const uint64_t seed = 204;
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Rng rng(seed);
    for (const float distance : {1e2f, 1e3f, 1e4f, 1e5f}) {
        SCOPED_TRACE(distance);
        Scene scene;
        const MeshId mesh = scene.add(ball(16));
        add_node(scene, mesh, {glm::mat3_cast(random_rotation(rng)), distance * random_direction(rng)});
        const Tlas& tlas = advance(scene, 0.0);
        for (int k = 0; k < 300; ++k) {
            // At the ball's middle: no rounding of the target misses it.
            Ray ray;
            const glm::vec3 centre = scene.nodes[0].matrix->translation;
            ray.origin = centre + random_direction(rng) * 5.0f;
            ray.direction = glm::normalize(centre - ray.origin);
            const Hit hit = closest_hit(tlas, ray);
            ASSERT_TRUE(hit);
            // The facets of the ball lie between 0.9 and 1 from its middle.
            ASSERT_GE(hit.t, 4.0f - 4e-6f * distance);
            ASSERT_LE(hit.t, 4.1f + 4e-6f * distance);
        }
    }
}

TEST(Transforms, DirectionIsNotNormalisedSoTIsInTheWorldsUnit) {
    Scene scene;
    const MeshId mesh = scene.add(facing_triangle());
    add_node(scene, mesh, placed({0, 0, -3}, glm::vec3(1000.0f)));
    const Tlas& tlas = advance(scene, 0.0);
    EXPECT_FLOAT_EQ(closest_hit(tlas, {{0, 0, 0}, {0, 0, -1}}).t, 3.0f);
    EXPECT_FLOAT_EQ(closest_hit(tlas, {{0, 0, 0}, {0, 0, -2}}).t, 1.5f);
    EXPECT_FLOAT_EQ(closest_hit(tlas, {{0, 0, 0}, {0, 0, -1e-6f}}).t, 3e6f);
    EXPECT_FLOAT_EQ(closest_hit(tlas, {{0, 0, 0}, {0, 0, -1e6f}}).t, 3e-6f);
}

/// trace(M * mesh) = M * trace(M^-1 ray, mesh): the instance against the same mesh with M baked into its vertices.
TEST(Transforms, TracingAnInstanceIsTracingTheBakedMesh) {
    const uint64_t seed = 205;
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Rng rng(seed);
    int compared = 0, disagreed = 0;
    for (int round = 0; round < 40; ++round) {
        const Affine m = random_affine(rng, 0.3, 3.0, 2.0f);
        Scene instanced, baked;
        const MeshId mesh = instanced.add(ball(24));
        add_node(instanced, mesh, m);
        Mesh moved = ball(24);
        for (glm::vec3& p : moved.positions) p = m.point(p);
        add_node(baked, baked.add(moved), Affine{});
        const Tlas& a = advance(instanced, 0.0);
        const Tlas& b = advance(baked, 0.0);
        for (int k = 0; k < 300; ++k) {
            Ray ray;
            ray.origin = m.point(random_direction(rng) * 3.0f);
            ray.direction = m.point(random_point(rng, 1.0f)) - ray.origin;
            const Hit hit_a = closest_hit(a, ray), hit_b = closest_hit(b, ray);
            ++compared;
            if (bool(hit_a) != bool(hit_b)) {
                ++disagreed;  // At the silhouette.
                continue;
            }
            if (!hit_a) continue;
            if (hit_a.primitive != hit_b.primitive) ++disagreed;  // On an edge: either side.
            // Stated bound: 1e-4 of the distance (32 ulp of numbers ten times the size, over a cosine of about 0.4).
            const float grazing = hit_a.primitive == hit_b.primitive ? 1e-4f : 1e-2f;
            ASSERT_NEAR(hit_a.t, hit_b.t, grazing * hit_b.t) << "round " << round << ", ray " << k;
        }
    }
    EXPECT_EQ(compared, 40 * 300);
    EXPECT_LE(disagreed, compared / 500);
}

TEST(Transforms, MirrorsKeepPrimitivesAndBarycentricsOfTheMesh) {
    Scene scene;
    const MeshId mesh = scene.add(facing_triangle());
    const NodeId mirrored = add_node(scene, mesh, placed({0, 0, -1}, {-1, 1, 1}));
    const Hit hit = closest_hit(advance(scene, 0.0), {{0.25f, -0.5f, 0}, {0, 0, -1}});
    ASSERT_EQ(hit.node, mirrored);
    const Mesh& m = scene[mesh];
    const glm::vec3 local = m.positions[0] * (1 - hit.u - hit.v) + m.positions[1] * hit.u + m.positions[2] * hit.v;
    EXPECT_NEAR(local.x, -0.25f, 1e-6f);
    EXPECT_NEAR(local.y, -0.5f, 1e-6f);
}

TEST(Transforms, AZeroScaleHidesTheNodeAndIsCounted) {
    Scene scene;
    const MeshId mesh = scene.add(ball(8));
    for (const glm::vec3& scale : {glm::vec3(0, 0, 0), glm::vec3(1, 0, 1), glm::vec3(0, 1, 1)}) {
        add_node(scene, mesh, placed({0, 0, 0}, scale));
    }
    const NodeId shown = add_node(scene, mesh, placed({0, 0, -5}));
    for (int frame = 0; frame < 3; ++frame) {
        const Tlas& tlas = advance(scene, frame * 0.1);
        EXPECT_EQ(tlas.instances.size(), 1u);
        EXPECT_EQ(tlas.instance_of_node[0], 0xffffffffu);
        const Hit hit = closest_hit(tlas, {{0, 0, 5}, {0, 0, -1}});
        EXPECT_EQ(hit.node, shown);
        EXPECT_NEAR(hit.t, 9.0f, 0.05f);
    }
    EXPECT_EQ(warning_count(scene, "node 0 "), 3u) << "once a frame";
    EXPECT_NE(warning_with(scene, "node 1 "), "");
    EXPECT_NE(warning_with(scene, "node 2 "), "");
}

TEST(Transforms, AScaleOfZeroInAParentHidesAllBelow) {
    Scene scene;
    const MeshId mesh = scene.add(ball(8));
    const NodeId parent = add_node(scene, kNone<MeshId>, placed({0, 0, 0}, {0, 0, 0}));
    add_node(scene, mesh, placed({0, 0, -5}), parent);
    const Tlas& tlas = advance(scene, 0.0);
    EXPECT_TRUE(tlas.instances.empty());
    EXPECT_FALSE(closest_hit(tlas, {{0, 0, 5}, {0, 0, -1}}));
    EXPECT_FALSE(any_hit(tlas, {{0, 0, 5}, {0, 0, -1}}));
}

TEST(Transforms, MatricesThatOverflowAreDroppedWithAWarning) {
    Scene scene;
    const MeshId mesh = scene.add(ball(8));
    const NodeId a = add_node(scene, kNone<MeshId>, placed({0, 0, 0}, glm::vec3(1e30f)));
    add_node(scene, mesh, placed({0, 0, 0}, glm::vec3(1e30f)), a);
    const NodeId b = add_node(scene, kNone<MeshId>, placed({0, 0, 0}, glm::vec3(1e-30f)));
    add_node(scene, mesh, placed({0, 0, 0}, glm::vec3(1e-30f)), b);
    const NodeId shown = add_node(scene, mesh, placed({0, 0, -5}));
    const Tlas& tlas = advance(scene, 0.0);
    const Ray ray{{0, 0, 5}, {0, 0, -1}};
    const Hit hit = closest_hit(tlas, ray);
    EXPECT_TRUE(is_sane(hit, ray));
    EXPECT_EQ(hit.node, shown);
    EXPECT_FALSE(scene.warnings().empty());
}

TEST(Transforms, RandomRaysAtRandomInstancesAreNeverNan) {
    const uint64_t seed = 206;
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Rng rng(seed);
    Scene scene;
    const MeshId mesh = scene.add(ball(12));
    for (int k = 0; k < 200; ++k) {
        Affine m = random_affine(rng, 1e-6, 1e6, log_uniform(rng, 1e-6, 1e6));
        if (rng.below(10) == 0) m.linear[int(rng.below(3))] = glm::vec3(0.0f);
        add_node(scene, mesh, m);
    }
    const Tlas& tlas = advance(scene, 0.0);
    int hits = 0;
    for (int k = 0; k < 20000; ++k) {
        Ray ray{random_point(rng, log_uniform(rng, 1e-6, 1e6)), random_direction(rng) * log_uniform(rng, 1e-6, 1e6)};
        if (rng.below(4) == 0) ray.direction[int(rng.below(3))] = rng.below(2) ? 0.0f : -0.0f;
        const Hit hit = closest_hit(tlas, ray);
        ASSERT_TRUE(is_sane(hit, ray)) << "ray " << k << ": t " << hit.t << " u " << hit.u << " v " << hit.v;
        ASSERT_EQ(any_hit(tlas, ray), bool(hit)) << "ray " << k;
        hits += bool(hit);
    }
    EXPECT_GT(hits, 1000);
}

TEST(Transforms, RaysThatAreNotRaysHitNothing) {
    Scene scene;
    const MeshId mesh = scene.add(ball(12));
    add_node(scene, mesh, Affine{});
    add_node(scene, mesh, placed({0, 0, -4}, glm::vec3(2.0f)));
    const Tlas& tlas = advance(scene, 0.0);
    ASSERT_TRUE(closest_hit(tlas, {{0, 0, 5}, {0, 0, -1}}));
    std::vector<Ray> rays = {{{0, 0, 5}, {0, 0, 0}}, {{0, 0, 0}, {0, 0, 0}}, {{0, 0, 5}, {-0.0f, 0.0f, -0.0f}}};
    for (int axis = 0; axis < 3; ++axis) {
        for (const float bad : {std::nanf(""), kInf, -kInf}) {
            for (const bool is_origin : {false, true}) {
                Ray ray{{0, 0, 5}, {0, 0, -1}};
                (is_origin ? ray.origin : ray.direction)[axis] = bad;
                rays.push_back(ray);
            }
        }
    }
    rays.push_back({{0, 0, 5}, {0, 0, -1}, std::nanf(""), kInf});
    rays.push_back({{0, 0, 5}, {0, 0, -1}, 0.0f, std::nanf("")});
    rays.push_back({{0, 0, 5}, {0, 0, -1}, 3.0f, 2.0f});
    std::vector<Hit> hits(rays.size());
    closest_hits(tlas, rays, hits);
    for (size_t k = 0; k < rays.size(); ++k) {
        EXPECT_EQ(hits[k], Hit{}) << "ray " << k;
        EXPECT_FALSE(any_hit(tlas, rays[k])) << "ray " << k;
    }
}

}  // namespace
}  // namespace zoe::test
