#include <algorithm>
#include <bit>
#include <cmath>

#include <gtest/gtest.h>

#include "engine/bvh/build_agglomerative.h"
#include "engine/bvh/build_binned.h"
#include "engine/bvh/build_median.h"
#include "engine/bvh/build_sweep.h"
#include "engine/math/parallel.h"
#include "tests/bvh/inputs.h"
#include "tests/math/random_inputs.h"
#include "tests/support/same_bits.h"

namespace zoe::test {
namespace {

bool is_same_tree(const Bvh& a, const Bvh& b) {
    return a.primitives == b.primitives && has_same_bits(a.nodes, b.nodes);
}

TEST(Builders, AreValidOnEveryNastyInput) {
    for (const TestMesh& mesh : nasty_meshes()) {
        const std::vector<Aabb> boxes = mesh.boxes();
        for (const NamedBuilder& builder : all_builders()) {
            if (!accepts(builder, boxes)) continue;
            SCOPED_TRACE(builder.name + " on " + mesh.name);
            const Bvh bvh = builder.build(boxes);
            EXPECT_EQ(validate(bvh, boxes), "");
            EXPECT_LT(bvh.nodes.size(), 2 * std::max<size_t>(boxes.size(), 1));
            EXPECT_FALSE(std::isnan(sah_cost(bvh)));
        }
    }
}

TEST(Builders, NothingMakesAnEmptyTreeAndOneBoxASingleLeaf) {
    const Aabb box{{1, 2, 3}, {4, 5, 6}};
    for (const NamedBuilder& builder : all_builders()) {
        SCOPED_TRACE(builder.name);
        const Bvh empty = builder.build({});
        EXPECT_TRUE(empty.nodes.empty());
        EXPECT_TRUE(empty.primitives.empty());
        EXPECT_TRUE(empty.bounds().is_empty());
        EXPECT_EQ(depth(empty), 0);
        const Bvh one = builder.build(std::span(&box, 1));
        ASSERT_EQ(one.nodes.size(), 1u);
        EXPECT_TRUE(one.nodes[0].is_leaf());
        EXPECT_EQ(one.bounds().lo, box.lo);
        EXPECT_EQ(one.bounds().hi, box.hi);
        EXPECT_EQ(depth(one), 1);
    }
}

TEST(Builders, BoxesThatAreNotFiniteStayInTheTreeAndOutOfItsBounds) {
    const float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
    std::vector<Aabb> boxes;
    Rng rng(61);
    for (int k = 0; k < 500; ++k) {
        Aabb box;
        box.extend(random_point(rng, 1.0f));
        box.extend(random_point(rng, 1.0f));
        if (k % 4 == 1) box = Aabb{};
        if (k % 4 == 2) box = {glm::vec3(-inf), glm::vec3(inf)};
        if (k % 4 == 3) box.lo[int(rng.below(3))] = nan;
        boxes.push_back(box);
    }
    for (const NamedBuilder& builder : all_builders()) {
        if (builder.needs_finite_boxes) continue;
        SCOPED_TRACE(builder.name);
        const Bvh bvh = builder.build(boxes);
        EXPECT_EQ(validate(bvh, boxes), "");
        EXPECT_TRUE((Aabb{glm::vec3(-1), glm::vec3(1)}.contains(bvh.bounds())));
        EXPECT_EQ(bvh.primitives.size(), boxes.size());
    }
}

TEST(Builders, DepthStaysNearTheLogarithmWhereNothingForcesMore) {
    for (const TestMesh& mesh : nasty_meshes()) {
        // Scales force one, and where all areas are 0 any split is as good as another.
        if (mesh.name == "each twice as far as the one before" || mesh.name == "on a line") continue;
        const std::vector<Aabb> boxes = mesh.boxes();
        for (const NamedBuilder& builder : all_builders()) {
            if (builder.may_be_deep || !accepts(builder, boxes)) continue;
            const int log = std::bit_width(boxes.size());
            EXPECT_LE(depth(builder.build(boxes)), 3 * log + 12) << builder.name << " on " << mesh.name;
        }
    }
}

TEST(Builders, LeavesAreNoLargerThanAllowed) {
    const TestMesh soup = random_soup(3000, 3.0f, 62);
    const std::vector<Aabb> boxes = soup.boxes();
    std::vector<Aabb> coincident(5000, boxes[0]);
    for (const std::vector<Aabb>& input : {boxes, coincident}) {
        for (const int size : {1, 2, 8}) {
            const Bvh swept = build_sweep(input, {.max_leaf_size = size});
            const Bvh binned = build_binned(input, {.max_leaf_size = size});
            const Bvh halved = build_median(input, size);
            for (const Bvh* bvh : {&swept, &binned, &halved}) {
                for (const BvhNode& node : bvh->nodes) ASSERT_LE(node.count, uint32_t(size));
            }
        }
        for (const BvhNode& node : build_agglomerative(input).nodes) ASSERT_LE(node.count, 1u);
    }
}

TEST(Builders, LeavesFillBlocksWhereTrianglesAreTestedInBlocks) {
    const std::vector<Aabb> boxes = random_soup(5000, 0.5f, 67).boxes();
    const auto mean_leaf = [&](const Bvh& bvh) {
        EXPECT_EQ(validate(bvh, boxes), "");
        const auto leaf_count =
            std::count_if(bvh.nodes.begin(), bvh.nodes.end(), [](const BvhNode& n) { return n.is_leaf(); });
        return double(boxes.size()) / double(leaf_count);
    };
    EXPECT_GT(mean_leaf(build_sweep(boxes, {.block_size = 4})), 1.3 * mean_leaf(build_sweep(boxes)));
    EXPECT_GT(mean_leaf(build_binned(boxes, {.block_size = 4})), 1.3 * mean_leaf(build_binned(boxes)));
}

TEST(Builders, GiveTheSameTreeOnAnyNumberOfThreads) {
    const TestMesh soup = random_soup(60000, 0.2f, 63);
    const std::vector<Aabb> boxes = soup.boxes();
    for (const NamedBuilder& builder : all_builders()) {
        set_thread_count(1);
        const Bvh reference = builder.build(boxes);
        for (const int threads : {2, 4}) {
            set_thread_count(threads);
            EXPECT_TRUE(is_same_tree(builder.build(boxes), reference)) << builder.name << ", " << threads << " threads";
        }
    }
    set_thread_count(0);
}

TEST(Builders, StorageOfAnotherTreeChangesNothing) {
    const std::vector<Aabb> boxes = random_soup(1000, 1.0f, 64).boxes(), others = random_soup(1700, 1.0f, 65).boxes();
    EXPECT_TRUE(is_same_tree(build_sweep(boxes, {}, build_sweep(others)), build_sweep(boxes)));
    EXPECT_TRUE(is_same_tree(build_binned(boxes, {}, build_binned(others)), build_binned(boxes)));
    EXPECT_TRUE(is_same_tree(build_agglomerative(boxes, build_sweep(others)), build_agglomerative(boxes)));
    EXPECT_TRUE(is_same_tree(build_median(boxes, 4, build_sweep(others)), build_median(boxes)));
    EXPECT_TRUE(build_binned({}, {}, build_binned(others)).nodes.empty());
    EXPECT_TRUE(build_median({}, 4, build_binned(others)).primitives.empty());
}

TEST(Builders, BeatAMedianSplitBySurfaceArea) {
    // Small triangles in clusters and a few large ones: where the choice of the split matters.
    TestMesh mesh = random_soup(2000, 0.05f, 66);
    Rng rng(66);
    for (glm::vec3& p : mesh.positions) p *= 0.5f;
    for (int k = 0; k < 40; ++k) mesh.add(random_point(rng, 10), random_point(rng, 10), random_point(rng, 10));
    const std::vector<Aabb> boxes = mesh.boxes();
    const double one_leaf = double(boxes.size());
    const double sweep = sah_cost(build_sweep(boxes)), binned = sah_cost(build_binned(boxes));
    EXPECT_LT(sweep, 0.2 * one_leaf);
    EXPECT_LT(binned, 0.2 * one_leaf);
    EXPECT_LE(sweep, 1.05 * binned) << "every position tried can hardly be worse than 16 bins";
    EXPECT_LE(sah_cost(build_agglomerative(boxes)), 2.0 * sweep);
}

TEST(Builders, SaveThreeTenthsOfTheWorkOfANaiveTreeAtLeast) {
    // A room: a few large triangles, and clusters of small ones of very different density.
    TestMesh mesh = random_soup(0, 1.0f, 68);
    Rng rng(68);
    for (int cluster = 0; cluster < 20; ++cluster) {
        const glm::vec3 place = random_point(rng, 9.0f);
        const float size = log_uniform(rng, 0.05, 1.0);
        for (int k = 0; k < 400; ++k) {
            const glm::vec3 a = place + random_point(rng, size);
            mesh.add(a, a + random_point(rng, 0.1f * size), a + random_point(rng, 0.1f * size));
        }
    }
    for (int k = 0; k < 30; ++k) mesh.add(random_point(rng, 10.0f), random_point(rng, 10.0f), random_point(rng, 10.0f));
    const std::vector<Aabb> boxes = mesh.boxes();
    const Bvh naive = build_median(boxes);
    ASSERT_EQ(validate(naive, boxes), "");
    const auto work = [&](const Bvh& bvh) {
        const Blas blas = blas_from(bvh, mesh);
        TraverseCounts counts;
        Rng ray_rng(69);
        for (int k = 0; k < 5000; ++k) {
            BlasHit hit;
            const RayFrame ray(Ray{random_point(ray_rng, 10.0f), random_direction(ray_rng)});
            closest_hit(blas, ray, 0.0f, 0.0f, &hit, &counts);
        }
        return double(counts.nodes) + counts.triangles;
    };
    const double naive_work = work(naive);
    EXPECT_LT(work(build_sweep(boxes)), 0.7 * naive_work);
    EXPECT_LT(work(build_binned(boxes)), 0.7 * naive_work);
}

TEST(SahCost, IsTheHandComputedOne) {
    Bvh bvh;
    // The root is a unit cube (half area 3); its leaves are two halves of it (half area 2), of two and three primitives.
    bvh.nodes = {{{0, 0, 0}, 1, {1, 1, 1}, 0}, {{0, 0, 0}, 0, {0.5f, 1, 1}, 2}, {{0.5f, 0, 0}, 2, {1, 1, 1}, 3}};
    bvh.primitives = {0, 1, 2, 3, 4};
    EXPECT_DOUBLE_EQ(sah_cost(bvh), (3.0 * 1 + 2.0 * 2 + 2.0 * 3) / 3.0);
    EXPECT_EQ(depth(bvh), 2);
}

}  // namespace
}  // namespace zoe::test
