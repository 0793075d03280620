#include <algorithm>
#include <cstring>
#include <iterator>
#include <limits>
#include <utility>

#include <gtest/gtest.h>

#include "engine/bvh/blas.h"
#include "engine/math/parallel.h"
#include "tests/bvh/inputs.h"
#include "tests/math/random_inputs.h"
#include "tests/support/allocation_count.h"
#include "tests/support/same_bits.h"

namespace zoe::test {
namespace {

bool is_same_to_the_bit(const WideBvh& a, const WideBvh& b) {
    return has_same_bits(a.nodes, b.nodes);
}

uint64_t count_leaves(const WideBvh& tree) {
    uint64_t count = 0;
    for (const WideNode& node : tree.nodes) {
        count += std::ranges::count_if(node.child, [](uint32_t child) { return child != kEmptyChild && is_leaf(child); });
    }
    return count;
}

/// What the nodes have summed is what their boxes give, each to the bit what a child after the other gives.
void expect_sums(const WideBvh& tree) {
    for (const WideNode& node : tree.nodes) {
        double sum = 0.0;
        for (int slot = 0; slot < kWidth; ++slot) {
            const uint32_t child = node.child[slot];
            if (child == kEmptyChild) continue;
            const double area = node.box(slot).half_area();
            sum += is_leaf(child) ? area * (double(CollapseConfig{}.block_cost) * block_count(child))
                                  : area + tree.nodes[child].area_cost;
        }
        ASSERT_EQ(node.area_cost, sum);
    }
    const double expected = sah_cost(tree, CollapseConfig{}.block_cost);
    EXPECT_NEAR(tree.summed_cost(), expected, 1e-12 * expected);
}

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
            const RefitCounts counts = refit_blas(mesh.positions, mesh.corners, &refitted);
            EXPECT_TRUE(is_same_to_the_bit(built.tree, refitted.tree)) << builder.name << " on " << mesh.name;
            EXPECT_EQ(counts.changed, 0u);
            EXPECT_EQ(counts.fitted, count_leaves(built.tree));
            expect_sums(built.tree);
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
            expect_sums(blas.tree);
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

/// A vertex of a triangle of its own, now outside and now back in its leaf: the boxes around it change, and no others.
TEST(Refit, OnlyBoxesThatChangedGoUp) {
    const TestMesh mesh = random_soup(20000, 0.5f, 99);
    Blas blas;
    build_blas(mesh.positions, mesh.corners, BlasBuilder::kSweep, &blas);
    const uint64_t leaf_count = count_leaves(blas.tree), depth = blas.tree.level_ends.size();
    const auto expect_few = [&](const TestMesh& moved, uint64_t most) {
        const RefitCounts counts = refit_blas(moved.positions, moved.corners, &blas);
        EXPECT_LE(counts.changed, most);
        EXPECT_LE(counts.fitted, leaf_count + counts.changed);
        expect_sums(blas.tree);
        EXPECT_EQ(validate(blas, moved.positions, moved.corners), "");
        return counts.changed;
    };
    TestMesh moved = mesh;
    moved.positions[300] = glm::vec3(100.0f);
    const uint64_t there = expect_few(moved, depth);
    EXPECT_GE(there, 1u);
    EXPECT_EQ(expect_few(mesh, depth), there) << "and back";
    // All corners of a triangle at its middle: what it still bounded is given up, mostly in its leaf alone.
    uint64_t changed = 0;
    for (uint32_t triangle = 0; triangle < 100; ++triangle) {
        moved = mesh;
        const glm::vec3 middle =
            (mesh.positions[3 * triangle] + mesh.positions[3 * triangle + 1] + mesh.positions[3 * triangle + 2]) / 3.0f;
        for (uint32_t k = 0; k < 3; ++k) moved.positions[3 * triangle + k] = middle;
        changed += expect_few(moved, depth);
        expect_few(mesh, depth);
    }
    EXPECT_GT(changed, 50u);
    EXPECT_LT(changed, 100 * depth / 2);
}

TEST(Refit, ThreadsDoNotMatterAndNothingIsAllocated) {
    const uint64_t seed = 100;
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Rng rng(seed);
    TestMesh mesh = random_soup(30000, 0.5f, 101);
    Blas blas;
    build_blas(mesh.positions, mesh.corners, BlasBuilder::kBinned, &blas);
    for (glm::vec3& p : mesh.positions) p += random_point(rng, 0.3f);
    Blas many = blas;
    set_thread_count(4);
    const RefitCounts with_four = refit_blas(mesh.positions, mesh.corners, &many);
    set_thread_count(1);
    const size_t before = allocation_count();
    const RefitCounts with_one = refit_blas(mesh.positions, mesh.corners, &blas);
    EXPECT_EQ(allocation_count(), before);
    set_thread_count(0);
    EXPECT_TRUE(is_same_to_the_bit(blas.tree, many.tree));
    EXPECT_EQ(with_four.fitted, with_one.fitted);
    EXPECT_EQ(with_four.changed, with_one.changed);
    EXPECT_EQ(blas.tree.summed_cost(), many.tree.summed_cost());
    EXPECT_TRUE(has_same_bits(blas.blocks, many.blocks));
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

/// What `fill_blocks` was given.
std::vector<uint32_t> slots_of(const Blas& blas) {
    std::vector<uint32_t> slots;
    for (const TriangleBlock& block : blas.blocks) slots.insert(slots.end(), block.primitive, std::end(block.primitive));
    return slots;
}

/// What a block has to hold of its triangles, a corner at a time.
void expect_blocks(const Blas& blas, const TestMesh& mesh) {
    const float nowhere = std::numeric_limits<float>::quiet_NaN();
    uint32_t not_finite_count = 0;
    for (const TriangleBlock& block : blas.blocks) {
        TriangleBlock expected = block;
        for (uint32_t slot = 0; slot < TriangleBlock::kSize; ++slot) {
            const uint32_t primitive = block.primitive[slot];
            const bool is_empty = primitive == kEmptyChild;
            const Triangle triangle = is_empty ? Triangle{} : mesh.triangle(primitive);
            const glm::vec3* corners[] = {&triangle.a, &triangle.b, &triangle.c};
            const bool is_somewhere = !is_empty && is_finite(triangle.a) && is_finite(triangle.b) && is_finite(triangle.c);
            not_finite_count += !is_empty && !is_somewhere;
            for (int k = 0; k < 9; ++k) expected.corners[k][slot] = is_somewhere ? (*corners[k / 3])[k % 3] : nowhere;
        }
        ASSERT_EQ(std::memcmp(&block, &expected, sizeof block), 0);
    }
    EXPECT_EQ(blas.not_finite_count, not_finite_count);
}

/// Zeros of either sign, sums that overflow, infinities and NaN, in blocks that are full and in others.
TEST(Refit, BlocksHoldTheVerticesToTheBit) {
    const uint64_t seed = 102;
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Rng rng(seed);
    const float infinity = std::numeric_limits<float>::infinity(), most = std::numeric_limits<float>::max();
    const std::vector<float> gentle = {0.0f, -0.0f, 1e-45f, -1e-40f}, finite = {0.0f, -0.0f, most, -most, 0.9f * most},
                             all = {-0.0f, most, -most, infinity, -infinity, std::nanf(""), -std::nanf("7")};
    const TestMesh mesh = random_soup(701, 0.5f, 103);
    Blas blas;
    build_blas(mesh.positions, mesh.corners, BlasBuilder::kSweep, &blas);
    ASSERT_TRUE(std::ranges::any_of(blas.blocks, [](const TriangleBlock& b) { return b.primitive[3] == kEmptyChild; }));
    for (const std::vector<float>& values : {gentle, finite, all}) {
        for (const uint32_t one_in : {1u, 3u, 40u}) {
            TestMesh moved = mesh;
            for (glm::vec3& p : moved.positions) {
                for (int axis = 0; axis < 3; ++axis) {
                    if (rng.below(one_in) == 0) p[axis] = values[rng.below(static_cast<uint32_t>(values.size()))];
                }
            }
            // Empty slots must not take anything over from the first triangle either.
            for (const bool is_first_broken : {false, true}) {
                if (is_first_broken) moved.positions[moved.corners[0].y].z = std::nanf("3");
                refit_blas(moved.positions, moved.corners, &blas);
                expect_blocks(blas, moved);
                EXPECT_EQ(validate(blas, moved.positions, moved.corners), "");
                Blas anew = blas;
                fill_blocks(slots_of(blas), moved.positions, moved.corners, &anew);
                EXPECT_TRUE(has_same_bits(blas.blocks, anew.blocks));
                EXPECT_EQ(blas.not_finite_count, anew.not_finite_count);
            }
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
