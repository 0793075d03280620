#include <utility>

#include <gtest/gtest.h>

#include "engine/bvh/blas.h"
#include "tests/bvh/inputs.h"
#include "tests/math/random_inputs.h"

namespace zoe::test {
namespace {

/// The same topology and the same boxes; zeros of either sign are the same plane.
bool is_same_tree(const WideBvh& a, const WideBvh& b) {
    if (a.nodes.size() != b.nodes.size() || a.level_ends != b.level_ends) return false;
    for (size_t k = 0; k < a.nodes.size(); ++k) {
        for (int slot = 0; slot < kWidth; ++slot) {
            const Aabb left = a.nodes[k].box(slot), right = b.nodes[k].box(slot);
            if (a.nodes[k].child[slot] != b.nodes[k].child[slot] || left.lo != right.lo || left.hi != right.hi) return false;
        }
    }
    return true;
}

TEST(Refit, WithoutMotionChangesNothing) {
    for (const TestMesh& mesh : nasty_meshes()) {
        const std::vector<Aabb> boxes = mesh.boxes();
        for (const NamedBuilder& builder : all_builders()) {
            if (!accepts(builder, boxes)) continue;
            const Blas built = blas_from(builder.build(boxes), mesh);
            Blas refitted = built;
            refit_blas(mesh.positions, mesh.corners, &refitted);
            EXPECT_TRUE(is_same_tree(built.tree, refitted.tree)) << builder.name << " on " << mesh.name;
        }
    }
}

TEST(Refit, AfterMotionEveryBoxIsTightAgain) {
    const uint64_t seed = 91;
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Rng rng(seed);
    const TestMesh mesh = random_soup(2000, 0.5f, 92);
    for (const NamedBuilder& builder : all_builders()) {
        Blas blas = blas_from(builder.build(mesh.boxes()), mesh);
        const Blas before = blas;
        TestMesh moved = mesh;
        for (int step = 0; step < 3; ++step) {
            for (glm::vec3& p : moved.positions) p += random_point(rng, 1.0f);
            refit_blas(moved.positions, moved.corners, &blas);
            ASSERT_EQ(validate(blas, moved.positions, moved.corners), "") << builder.name;
            for (const WideNode& node : blas.tree.nodes) {
                for (int slot = 0; slot < kWidth; ++slot) {
                    const uint32_t child = node.child[slot];
                    if (child == kEmptyChild) continue;
                    Aabb tight;
                    if (is_leaf(child)) {
                        for (uint32_t k = 0; k < block_count(child); ++k) {
                            for (const uint32_t primitive : blas.blocks[first_block(child) + k].primitive) {
                                if (primitive != kEmptyChild) tight.extend(bounds(moved.triangle(primitive)));
                            }
                        }
                    } else {
                        tight = blas.tree.nodes[child].bounds();
                    }
                    ASSERT_EQ(node.box(slot).lo, tight.lo);
                    ASSERT_EQ(node.box(slot).hi, tight.hi);
                }
            }
        }
        for (size_t k = 0; k < blas.tree.nodes.size(); ++k) {
            for (int slot = 0; slot < kWidth; ++slot) {
                ASSERT_EQ(blas.tree.nodes[k].child[slot], before.tree.nodes[k].child[slot]) << "the topology stays";
            }
        }
    }
}

TEST(Refit, MovingThereAndBackGivesTheFirstTreeAgain) {
    const TestMesh mesh = random_soup(1500, 0.5f, 93);
    TestMesh moved = mesh;
    for (glm::vec3& p : moved.positions) p = glm::vec3(p.z, -p.x, 3.0f * p.y);
    Blas blas;
    build_blas(mesh.positions, mesh.corners, BlasBuilder::kSweep, &blas);
    const WideBvh before = blas.tree;
    refit_blas(moved.positions, moved.corners, &blas);
    refit_blas(mesh.positions, mesh.corners, &blas);
    EXPECT_TRUE(is_same_tree(blas.tree, before));
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
            ASSERT_EQ(validate(blas, after.positions, after.corners), "") << after.name;
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
        ASSERT_EQ(validate(blas, step->positions, step->corners), "");
        for (const Ray& ray : rays_at(mesh, 200, 98)) {
            ASSERT_TRUE(is_same(closest_hit(blas, ray), brute_force(*step, ray)));
        }
    }
    EXPECT_EQ(blas.not_finite_count, 0u);
}

}  // namespace
}  // namespace zoe::test
