// End-point overlap within a budget of visits.

#include <atomic>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "engine/bvh/build_sweep.h"
#include "engine/bvh/epo.h"
#include "engine/math/parallel.h"
#include "tests/bvh/inputs.h"

namespace zoe::test {
namespace {

/// A binary tree, and its triangles in the order of the leaves.
struct Tree {
    Bvh bvh;
    std::vector<Triangle> triangles;
};

Tree built(const TestMesh& mesh) {
    Tree tree{build_sweep(mesh.boxes()), {}};
    for (const uint32_t primitive : tree.bvh.primitives) tree.triangles.push_back(mesh.triangle(primitive));
    return tree;
}

/// Copies of one triangle, each in a leaf with up to seven others: every leaf holds all of every triangle.
Tree copies_of_one(int count) {
    TestMesh mesh{"copies", {}, {}};
    mesh.add({0, 0, 0}, {1, 0, 0.5f}, {0, 1, 0.25f});
    mesh.corners.assign(static_cast<size_t>(count), mesh.corners[0]);
    return built(mesh);
}

TEST(EpoSample, VisitsNoMoreThanToldWhereEverythingOverlaps) {
    constexpr uint64_t kMost = 40'000'000;
    const Tree tree = copies_of_one(100'000);
    const uint64_t node_count = tree.bvh.nodes.size();
    ASSERT_GT(node_count, 20'000u);
    const Epo sampled = epo(tree.bvh, tree.triangles, {.max_visits = kMost});
    EXPECT_TRUE(sampled.is_sampled);
    EXPECT_LE(sampled.visits, kMost + node_count);
    EXPECT_GE(sampled.visits, kMost / 2);
    // All leaves but its own, and all inner nodes but those above it.
    const double all = 100'000.0 + static_cast<double>(node_count / 2);
    EXPECT_LT(sampled.cost, all);
    EXPECT_GT(sampled.cost, all - 100.0);
}

TEST(EpoSample, IsExactWithinTheBudgetToTheLastBit) {
    const Tree tree = built(random_soup(3000, 0.4f, 572));
    const double exact = epo_cost(tree.bvh, tree.triangles);
    const Epo all = epo(tree.bvh, tree.triangles, {});
    EXPECT_FALSE(all.is_sampled);
    EXPECT_EQ(all.cost, exact);
    for (const uint64_t seed : {1, 2, 3}) {
        const Epo within = epo(tree.bvh, tree.triangles, {.max_visits = 2 * all.visits, .seed = seed});
        EXPECT_FALSE(within.is_sampled);
        EXPECT_EQ(within.visits, all.visits);
        EXPECT_EQ(within.cost, exact);
    }
}

TEST(EpoSample, OfASampleIsNearTheExactOne) {
    const Tree tree = built(random_soup(20000, 0.4f, 573));
    const double exact = epo_cost(tree.bvh, tree.triangles);
    const uint64_t visits = epo(tree.bvh, tree.triangles, {}).visits;
    double mean = 0.0;
    constexpr int kSeeds = 20;
    for (uint64_t seed = 600; seed < 600 + kSeeds; ++seed) {
        const Epo sampled = epo(tree.bvh, tree.triangles, {.max_visits = visits / 10, .seed = seed});
        EXPECT_TRUE(sampled.is_sampled);
        EXPECT_LE(sampled.visits, visits / 8);
        EXPECT_NEAR(sampled.cost, exact, 0.15 * exact) << "seed " << seed;
        mean += sampled.cost / kSeeds;
    }
    EXPECT_NEAR(mean, exact, 0.05 * exact);
}

TEST(EpoSample, IsLeftWhereItIsCancelled) {
    const Tree tree = copies_of_one(20'000);
    const std::atomic<bool> is_cancelled{true};
    const Epo nothing = epo(tree.bvh, tree.triangles, {.cancel = &is_cancelled});
    EXPECT_TRUE(nothing.is_sampled);
    EXPECT_EQ(nothing.visits, 0u);
}

TEST(EpoSample, IsTheSameOnAnyNumberOfThreads) {
    const Tree tree = built(random_soup(5000, 0.3f, 574));
    set_thread_count(1);
    const Epo expected = epo(tree.bvh, tree.triangles, {.max_visits = 20'000});
    EXPECT_TRUE(expected.is_sampled);
    for (const int threads : {2, 3, 8}) {
        set_thread_count(threads);
        const Epo again = epo(tree.bvh, tree.triangles, {.max_visits = 20'000});
        EXPECT_EQ(again.cost, expected.cost) << threads;
        EXPECT_EQ(again.visits, expected.visits) << threads;
    }
    set_thread_count(0);
}

}  // namespace
}  // namespace zoe::test
