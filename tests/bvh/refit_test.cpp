#include "engine/bvh/refit.h"

#include <cstring>
#include <utility>

#include <gtest/gtest.h>

#include "tests/bvh/inputs.h"
#include "tests/math/random_inputs.h"

namespace zoe::test {
namespace {

bool is_same_nodes(const Bvh& a, const Bvh& b) {
    return a.nodes.size() == b.nodes.size() && a.primitives == b.primitives &&
           (a.nodes.empty() || std::memcmp(a.nodes.data(), b.nodes.data(), a.nodes.size() * sizeof(BvhNode)) == 0);
}

TEST(Refit, WithoutMotionChangesNoBit) {
    for (const TestMesh& mesh : nasty_meshes()) {
        const std::vector<Aabb> boxes = mesh.boxes();
        for (const NamedBuilder& builder : all_builders()) {
            if (!accepts(builder, boxes)) continue;
            const Bvh built = builder.build(boxes);
            Bvh refitted = built;
            refit(refitted, boxes);
            EXPECT_TRUE(is_same_nodes(built, refitted)) << builder.name << " on " << mesh.name;
        }
    }
}

TEST(Refit, AfterMotionEveryBoxIsTightAgain) {
    const uint64_t seed = 91;
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Rng rng(seed);
    TestMesh mesh = random_soup(2000, 0.5f, 92);
    for (const NamedBuilder& builder : all_builders()) {
        Bvh bvh = builder.build(mesh.boxes());
        const Bvh before = bvh;
        TestMesh moved = mesh;
        for (int step = 0; step < 3; ++step) {
            for (glm::vec3& p : moved.positions) p += random_point(rng, 1.0f);
            const std::vector<Aabb> boxes = moved.boxes();
            refit(bvh, boxes);
            ASSERT_EQ(validate(bvh, boxes), "") << builder.name;
            for (const BvhNode& node : bvh.nodes) {
                Aabb tight;
                if (node.is_leaf()) {
                    for (uint32_t k = node.first; k < node.first + node.count; ++k) tight.extend(boxes[bvh.primitives[k]]);
                } else {
                    tight = merge(bvh.nodes[node.first].bounds(), bvh.nodes[node.first + 1].bounds());
                }
                ASSERT_EQ(node.lo, tight.lo);
                ASSERT_EQ(node.hi, tight.hi);
            }
        }
        ASSERT_EQ(bvh.primitives, before.primitives) << "the topology stays";
        for (size_t k = 0; k < bvh.nodes.size(); ++k) {
            ASSERT_EQ(bvh.nodes[k].first, before.nodes[k].first);
            ASSERT_EQ(bvh.nodes[k].count, before.nodes[k].count);
        }
    }
}

TEST(Refit, MovingThereAndBackGivesTheFirstTreeAgain) {
    const TestMesh mesh = random_soup(1500, 0.5f, 93);
    TestMesh moved = mesh;
    for (glm::vec3& p : moved.positions) p = glm::vec3(p.z, -p.x, 3.0f * p.y);
    Blas blas;
    build_blas(mesh.positions, mesh.corners, BlasBuilder::kSweep, &blas);
    const Bvh before = blas.bvh;
    refit_blas(moved.positions, moved.corners, &blas);
    refit_blas(mesh.positions, mesh.corners, &blas);
    EXPECT_TRUE(is_same_nodes(blas.bvh, before));
}

/// What refitting is worst at: the tree's neighbours have nothing to do with each other any more.
TEST(Refit, ScrambledMeshesKeepTheRightHits) {
    const uint64_t seed = 94;
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Rng rng(seed);
    const TestMesh mesh = random_soup(1500, 0.5f, 95);
    std::vector<TestMesh> scrambled(4, mesh);
    scrambled[0].name = "explosion";
    for (glm::vec3& p : scrambled[0].positions) p = glm::vec3(-20.0f) + p * 4.0f + random_point(rng, 0.1f);
    scrambled[1].name = "twist of 360 degrees";
    for (glm::vec3& p : scrambled[1].positions) {
        const float angle = 0.628f * (p.y + 10.0f);
        p = {p.x * std::cos(angle) - p.z * std::sin(angle), p.y, p.x * std::sin(angle) + p.z * std::cos(angle)};
    }
    scrambled[2].name = "permuted triangles";
    for (uint32_t k = 1500; k > 1; --k) std::swap(scrambled[2].corners[k - 1], scrambled[2].corners[rng.below(k)]);
    scrambled[3].name = "permuted vertices";
    for (uint32_t k = 4500; k > 1; --k) std::swap(scrambled[3].positions[k - 1], scrambled[3].positions[rng.below(k)]);
    for (const TestMesh& after : scrambled) {
        const std::vector<Ray> rays = rays_at(after, 400, 96);
        for (const BlasBuilder builder : {BlasBuilder::kSweep, BlasBuilder::kBinned}) {
            Blas blas;
            build_blas(mesh.positions, mesh.corners, builder, &blas);
            refit_blas(after.positions, after.corners, &blas);
            ASSERT_EQ(validate(blas.bvh, after.boxes()), "") << after.name;
            int hits = 0;
            for (size_t k = 0; k < rays.size(); ++k) {
                const BlasHit hit = closest_hit(blas, rays[k]), expected = brute_force(after, rays[k]);
                ASSERT_TRUE(is_same(hit, expected))
                    << after.name << ", ray " << k << ": " << to_string(hit) << ", expected " << to_string(expected);
                ASSERT_EQ(any_hit(blas, rays[k]), expected.primitive != 0xffffffffu);
                hits += expected.primitive != 0xffffffffu;
            }
            EXPECT_GT(hits, 100) << after.name;
        }
    }
}

TEST(Refit, TrianglesMayCollapseBreakAndComeBack) {
    const TestMesh mesh = random_soup(500, 0.5f, 97);
    Blas blas;
    build_blas(mesh.positions, mesh.corners, BlasBuilder::kSweep, &blas);
    TestMesh broken = mesh;
    for (size_t k = 0; k < broken.positions.size(); ++k) {
        if (k % 7 == 0) broken.positions[k].y = std::numeric_limits<float>::quiet_NaN();
    }
    const TestMesh collapsed{"collapsed", std::vector<glm::vec3>(mesh.positions.size(), glm::vec3(1, 2, 3)), mesh.corners};
    const TestMesh gone{"gone", std::vector<glm::vec3>(mesh.positions.size(), glm::vec3(std::nanf(""))), mesh.corners};
    for (const TestMesh* step : std::initializer_list<const TestMesh*>{&broken, &collapsed, &gone, &mesh}) {
        refit_blas(step->positions, step->corners, &blas);
        ASSERT_EQ(validate(blas.bvh, step->boxes()), "");
        for (const Ray& ray : rays_at(mesh, 200, 98)) {
            ASSERT_TRUE(is_same(closest_hit(blas, ray), brute_force(*step, ray)));
        }
    }
    EXPECT_EQ(blas.not_finite_count, 0u);
}

}  // namespace
}  // namespace zoe::test
