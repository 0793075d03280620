#include "engine/bvh/build_sbvh.h"

#include <cmath>

#include <gtest/gtest.h>

#include "engine/bvh/build_sweep.h"
#include "engine/math/parallel.h"
#include "tests/bvh/inputs.h"
#include "tests/math/random_inputs.h"
#include "tests/support/same_bits.h"

namespace zoe::test {
namespace {

struct NamedConfig {
    std::string name;
    SbvhConfig config;
};

std::vector<NamedConfig> configs() {
    return {
        {"usual", {}},
        {"no copies", {.max_reference_growth = 1.0f}},
        {"many copies",
         {.max_reference_growth = 4.0f, .min_overlap = 0.0f, .bin_count = 64, .max_leaf_size = 1, .node_cost = 0.0f}},
        {"blocks of four", {.max_reference_growth = 2.0f, .min_overlap = 0.0f, .block_size = 4}},
        {"two bins", {.max_reference_growth = 1.5f, .min_overlap = 0.0f, .bin_count = 2}},
    };
}

StaticBvh build(const TestMesh& mesh, const SbvhConfig& config = {}) {
    return build_sbvh(mesh.positions, mesh.corners, config);
}

bool is_same_tree(const Bvh& a, const Bvh& b) {
    return a.primitives == b.primitives && has_same_bits(a.nodes, b.nodes);
}

TEST(Sbvh, IsValidAndInItsBudgetOnEveryNastyInput) {
    for (const TestMesh& mesh : nasty_meshes()) {
        for (const NamedConfig& named : configs()) {
            SCOPED_TRACE(named.name + " on " + mesh.name);
            const StaticBvh bvh = build(mesh, named.config);
            EXPECT_EQ(validate(bvh, mesh.positions, mesh.corners), "");
            EXPECT_LE(bvh.tree.primitives.size(), double(named.config.max_reference_growth) * mesh.corners.size());
            EXPECT_FALSE(std::isnan(sah_cost(bvh.tree)));
            for (const BvhNode& node : bvh.tree.nodes) {
                ASSERT_LE(node.count, uint32_t(named.config.max_leaf_size));
                ASSERT_FALSE(std::isnan(node.lo.x + node.lo.y + node.lo.z));
            }
        }
    }
}

TEST(Sbvh, HitsEqualBruteForceToTheLastBitOnEveryNastyInput) {
    for (const TestMesh& mesh : nasty_meshes()) {
        const std::vector<Ray> rays = rays_at(mesh, mesh.corners.size() > 5000 ? 60 : 600, 81);
        for (const NamedConfig& named : configs()) {
            SCOPED_TRACE(named.name + " on " + mesh.name);
            const Blas blas = blas_from(build(mesh, named.config), mesh);
            for (const Ray& ray : rays) {
                const BlasHit expected = brute_force(mesh, ray), found = closest_hit(blas, ray);
                ASSERT_TRUE(is_same(found, expected)) << to_string(found) << ", expected " << to_string(expected);
                ASSERT_EQ(any_hit(blas, ray), expected.primitive != 0xffffffffu);
            }
        }
    }
}

TEST(Sbvh, IsTheSameTreeOnAnyNumberOfThreads) {
    TestMesh mesh = random_soup(80000, 0.5f, 82);
    Rng rng(82);
    for (int k = 0; k < 300; ++k) mesh.add(random_point(rng, 10.0f), random_point(rng, 10.0f), random_point(rng, 10.0f));
    set_thread_count(1);
    const StaticBvh reference = build(mesh);
    EXPECT_GT(reference.tree.primitives.size(), mesh.corners.size());
    for (const int threads : {2, 4}) {
        set_thread_count(threads);
        EXPECT_TRUE(is_same_tree(build(mesh).tree, reference.tree)) << threads << " threads";
    }
    set_thread_count(0);
}

TEST(Sbvh, NothingMakesAnEmptyTreeAndOneTriangleASingleLeaf) {
    TestMesh mesh{"one", {}, {}};
    EXPECT_TRUE(build(mesh).tree.nodes.empty());
    EXPECT_EQ(validate(build(mesh), mesh.positions, mesh.corners), "");
    mesh.add({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    const StaticBvh one = build(mesh);
    ASSERT_EQ(one.tree.nodes.size(), 1u);
    EXPECT_EQ(one.tree.bounds().hi, glm::vec3(1, 1, 0)) << "a triangle that is not cut is not padded";
}

TEST(Sbvh, WithoutABudgetItIsTheSweep) {
    const TestMesh mesh = large_among_small(83);
    const StaticBvh bvh = build(mesh, {.max_reference_growth = 1.0f});
    EXPECT_EQ(bvh.tree.primitives.size(), mesh.corners.size());
    EXPECT_EQ(validate(bvh.tree, mesh.boxes()), "") << "as a tree of primitives";
    EXPECT_NEAR(sah_cost(bvh.tree) / sah_cost(build_sweep(mesh.boxes())), 1.0, 0.01);
}

TEST(Sbvh, CutsWhatLiesAcrossAndTracesFaster) {
    const TestMesh mesh = large_among_small(84);
    const Bvh sweep = build_sweep(mesh.boxes());
    const StaticBvh bvh = build(mesh, {.max_reference_growth = 2.0f});
    EXPECT_GT(bvh.tree.primitives.size(), mesh.corners.size() * 1.05);
    EXPECT_LT(sah_cost(bvh.tree), 0.8 * sah_cost(sweep));
    TraverseCounts swept, cut;
    const Blas swept_blas = blas_from(sweep, mesh), cut_blas = blas_from(bvh, mesh);
    Rng rng(84);
    for (int k = 0; k < 5000; ++k) {
        const RayFrame ray(Ray{random_point(rng, 10.0f), random_direction(rng)});
        BlasHit a, b;
        closest_hit(swept_blas, ray, 0.0f, 0.0f, &a, &swept);
        closest_hit(cut_blas, ray, 0.0f, 0.0f, &b, &cut);
    }
    EXPECT_LT(cut.nodes + cut.triangles, 0.8 * (swept.nodes + swept.triangles));
}

TEST(Sbvh, TheBudgetHoldsOnLongDiagonalSlivers) {
    TestMesh slivers{"hair", {}, {}};
    Rng rng(85);
    for (int k = 0; k < 4000; ++k) {
        const glm::vec3 a = random_point(rng, 1.0f);
        slivers.add(a, a + glm::vec3(10, 10, 10) + random_point(rng, 0.5f), a + random_point(rng, 1e-3f));
    }
    size_t last = slivers.corners.size();
    for (const float growth : {1.1f, 1.5f, 3.0f}) {
        const StaticBvh bvh = build(slivers, {.max_reference_growth = growth});
        EXPECT_EQ(validate(bvh, slivers.positions, slivers.corners), "");
        EXPECT_LE(bvh.tree.primitives.size(), double(growth) * slivers.corners.size());
        EXPECT_GT(bvh.tree.primitives.size(), last) << "more budget, more copies";
        last = bvh.tree.primitives.size();
    }
}

TEST(StaticValidate, SeesWhatIsBroken) {
    const TestMesh mesh = large_among_small(86);
    const StaticBvh good = build(mesh, {.max_reference_growth = 2.0f});
    const auto verdict = [&](const StaticBvh& bvh) { return validate(bvh, mesh.positions, mesh.corners); };
    ASSERT_EQ(verdict(good), "");
    StaticBvh bvh = good;
    bvh.tree.primitives[7] = uint32_t(mesh.corners.size());
    EXPECT_NE(verdict(bvh).find("out of range"), std::string::npos) << verdict(bvh);
    bvh = good;
    --bvh.primitive_count;
    EXPECT_NE(verdict(bvh).find("built over"), std::string::npos) << verdict(bvh);
    bvh = good;
    for (uint32_t& primitive : bvh.tree.primitives) primitive = primitive == 5 ? 6 : primitive;
    EXPECT_NE(verdict(bvh), "") << "no leaf has primitive 5";
    bvh = good;
    for (BvhNode& node : bvh.tree.nodes) {
        if (node.is_leaf()) node.hi = 0.5f * (node.lo + node.hi);
    }
    EXPECT_NE(verdict(bvh).find("sticks out"), std::string::npos) << verdict(bvh);
    bvh = good;
    bvh.tree.nodes.pop_back();
    EXPECT_NE(verdict(bvh), "");
}

}  // namespace
}  // namespace zoe::test
