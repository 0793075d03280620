#include "engine/bvh/traverse.h"

#include <gtest/gtest.h>

#include "tests/bvh/copies.h"
#include "tests/bvh/inputs.h"
#include "tests/math/random_inputs.h"

namespace zoe::test {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();

TEST(Traverse, AChainOfAHundredThousandNodesDoesNotOverflow) {
    constexpr int kCount = 100000;
    const TestMesh mesh = stack_of_triangles(kCount);
    const std::vector<Aabb> boxes = mesh.boxes();
    const Bvh chain = chain_over(boxes);
    ASSERT_EQ(validate(chain, boxes), "");
    ASSERT_EQ(depth(chain), kCount);
    const Blas blas = blas_from(chain, mesh);
    ASSERT_EQ(validate(blas, mesh.positions, mesh.corners), "");
    ASSERT_GT(blas.tree.level_ends.size(), kCount / 64u);
    const BlasHit from_above = closest_hit(blas, {{0, 0, kCount}, {0, 0, -1}});
    EXPECT_EQ(from_above.primitive, uint32_t(kCount - 1));
    EXPECT_EQ(from_above.t, 1.0f);
    EXPECT_EQ(closest_hit(blas, {{0, 0, -1}, {0, 0, 1}}).primitive, 0u);
    EXPECT_EQ(closest_hit(blas, {{5, 0, kCount}, {0, 0, -1}}).primitive, 0xffffffffu);
    EXPECT_TRUE(any_hit(blas, {{0, 0, kCount}, {0, 0, -1}}));
    EXPECT_FALSE(any_hit(blas, {{0.9f, 0.9f, kCount}, {0, 0, -1}})) << "through every box, past every triangle";
    EXPECT_EQ(closest_hit(blas, {{0.9f, 0.9f, kCount}, {0, 0, -1}}).primitive, 0xffffffffu);
}

TEST(Traverse, AnEmptyTreeIsMissed) {
    const Blas blas;
    EXPECT_EQ(closest_hit(blas, Ray{}).primitive, 0xffffffffu);
    EXPECT_FALSE(any_hit(blas, Ray{}));
}

TEST(Traverse, RaysThatAreNotRaysHitNothing) {
    const TestMesh mesh = stack_of_triangles(3);
    const Blas blas = blas_from(chain_over(mesh.boxes()), mesh);
    for (const float bad : {std::nanf(""), kInf, -kInf}) {
        for (int axis = 0; axis < 3; ++axis) {
            for (const bool is_origin : {false, true}) {
                Ray ray{{0, 0, 5}, {0, 0, -1}};
                (is_origin ? ray.origin : ray.direction)[axis] = bad;
                EXPECT_EQ(closest_hit(blas, ray).primitive, 0xffffffffu);
                EXPECT_FALSE(any_hit(blas, ray));
            }
        }
    }
    EXPECT_FALSE(any_hit(blas, {{0, 0, 0}, {0, 0, 0}})) << "a direction of 0 from a point on a triangle";
    Ray nan_end{{0, 0, 5}, {0, 0, -1}};
    nan_end.t_max = std::nanf("");
    EXPECT_FALSE(any_hit(blas, nan_end));
    EXPECT_EQ(closest_hit(blas, nan_end).primitive, 0xffffffffu);
    nan_end.t_max = kInf;
    nan_end.t_min = std::nanf("");
    EXPECT_FALSE(any_hit(blas, nan_end));
    EXPECT_EQ(closest_hit(blas, nan_end).primitive, 0xffffffffu);
    Ray empty{{0, 0, 5}, {0, 0, -1}};
    empty.t_min = 4.0f;
    empty.t_max = 3.0f;
    EXPECT_FALSE(any_hit(blas, empty)) << "t_min above t_max";
}

TEST(Traverse, ImprovesOnAHitOnlyWhereItIsCloserOrItsPrimitiveLower) {
    TestMesh mesh{"two copies", {}, {}};
    mesh.add({-1, -1, 0}, {1, -1, 0}, {0, 1, 0});
    mesh.corners.push_back(mesh.corners[0]);
    const Blas blas = blas_from(chain_over(mesh.boxes()), mesh);
    const RayFrame frame(Ray{{0, 0, 5}, {0, 0, -1}});
    BlasHit hit{4.0f, 0.1f, 0.1f, 7};
    EXPECT_FALSE(closest_hit(blas, frame, 0.0f, 0.0f, &hit, nullptr)) << "the one at hand is closer";
    EXPECT_EQ(hit.primitive, 7u);
    hit = {5.0f, 0.1f, 0.1f, 7};
    EXPECT_TRUE(closest_hit(blas, frame, 0.0f, 0.0f, &hit, nullptr)) << "a tie, and a lower primitive";
    EXPECT_EQ(hit.primitive, 0u);
    EXPECT_FALSE(closest_hit(blas, frame, 0.0f, 0.0f, &hit, nullptr)) << "the same again is no improvement";
    hit = {6.0f, 0.1f, 0.1f, 0};
    EXPECT_TRUE(closest_hit(blas, frame, 0.0f, 0.0f, &hit, nullptr)) << "closer";
    EXPECT_EQ(hit.t, 5.0f);
}

TEST(Traverse, AnyHitTellsWhetherThereIsAClosestHit) {
    const uint64_t seed = 131;
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Rng rng(seed);
    const TestMesh soup = random_soup(3000, 1.0f, 132);
    Blas blas;
    build_blas(soup.positions, soup.corners, BlasBuilder::kSweep, &blas);
    int hits = 0;
    constexpr int kRays = 100000;
    for (int k = 0; k < kRays; ++k) {
        Ray ray{random_point(rng, 15.0f), random_direction(rng)};
        ray.t_min = rng.below(2) ? 0.0f : rng.uniform(0.0f, 10.0f);
        ray.t_max = rng.below(2) ? kInf : rng.uniform(0.0f, 20.0f);
        const bool is_hit = closest_hit(blas, ray).primitive != 0xffffffffu;
        ASSERT_EQ(any_hit(blas, ray), is_hit) << "ray " << k;
        hits += is_hit;
    }
    EXPECT_GT(hits, kRays / 10);
    EXPECT_LT(hits, kRays - kRays / 10);
}

TEST(Traverse, CountsItsWork) {
    const TestMesh soup = random_soup(3000, 1.0f, 133);
    Blas blas;
    build_blas(soup.positions, soup.corners, BlasBuilder::kSweep, &blas);
    TraverseCounts counts;
    BlasHit hit;
    closest_hit(blas, RayFrame({{0, 0, 30}, {0, 0, -1}}), 0.0f, 0.0f, &hit, &counts);
    EXPECT_GT(counts.nodes, 1u);
    EXPECT_LT(counts.nodes, blas.tree.nodes.size() / 2);
    EXPECT_GT(counts.triangles, 0u);
    const TraverseCounts once = counts;
    hit = {};
    closest_hit(blas, RayFrame({{0, 0, 30}, {0, 0, -1}}), 0.0f, 0.0f, &hit, &counts);
    EXPECT_EQ(counts.nodes, 2 * once.nodes) << "added to, not overwritten";
    EXPECT_EQ(counts.triangles, 2 * once.triangles);
}

// Rays by the hundred million are counted into one sum.
TEST(Traverse, CountsGoBeyondThirtyTwoBits) {
    const Copies copies(random_soup(3000, 1.0f, 134), {Affine{}});
    const std::vector<Ray> rays(100, Ray{{0, 0, 30}, {0, 0, -1}});
    constexpr uint64_t kBefore = 0xfffffff0u;
    for (const size_t together : {size_t{1}, rays.size()}) {
        TraverseCounts fresh, counts{.nodes = kBefore, .triangles = kBefore};
        std::vector<RawHit> hits(together);
        for (TraverseCounts* sum : {&fresh, &counts}) {
            for (size_t k = 0; k < rays.size(); k += together)
                closest_hits(copies.levels(), std::span(rays).subspan(k, together), hits.data(), sum);
        }
        EXPECT_GT(fresh.nodes, 16u);
        EXPECT_GT(fresh.triangles, 16u);
        EXPECT_EQ(counts.nodes, kBefore + fresh.nodes) << together;
        EXPECT_EQ(counts.triangles, kBefore + fresh.triangles) << together;
    }
}

}  // namespace
}  // namespace zoe::test
