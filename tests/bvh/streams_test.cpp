// Streams: the hits of the loop over all triangles of all instances, bit for bit, wherever the rays go and however many.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/bvh/copies.h"
#include "tests/bvh/each_target.h"
#include "tests/math/random_inputs.h"

namespace zoe::test {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();

/// Between points in and around the copies.
std::vector<Ray> scattered_rays(const Copies& copies, size_t count, uint64_t seed) {
    Rng rng(seed);
    const Aabb all = copies.levels().top->bounds();
    const auto point = [&] { return all.centre() + 0.6f * all.extent() * random_point(rng, 1.0f); };
    std::vector<Ray> rays(count);
    for (Ray& ray : rays) {
        ray.origin = point();
        ray.direction = point() - ray.origin;
    }
    return rays;
}

std::vector<Affine> placed_with_identity(int count, uint64_t seed) {
    std::vector<Affine> maps = random_affines(count, 0.3, 3.0, 20.0f, seed);
    maps.push_back(Affine{});
    return maps;
}

TEST(Streams, FindWhatBruteForceDoes) {
    for (const uint64_t seed : {211, 212, 213}) {
        SCOPED_TRACE(::testing::Message() << "seed " << seed);
        const Copies copies(random_soup(200, 2.0f, seed), placed_with_identity(20, seed + 10));
        const std::vector<Ray> rays = scattered_rays(copies, 3000, seed + 20);
        const int hits = expect_batches_right(copies, rays);
        EXPECT_GT(hits, 300);
        EXPECT_LT(hits, 2700);
    }
}

TEST(Streams, HoldAnyNumberOfRays) {
    const Copies copies(random_soup(200, 2.0f, 221), placed_with_identity(5, 222));
    const std::vector<Ray> rays = scattered_rays(copies, 200, 223);
    std::vector<RawHit> expected;
    for (const Ray& ray : rays) expected.push_back(copies.brute_force(ray));
    on_each_target([&] {
        for (size_t count = 0; count <= rays.size(); ++count) {
            std::vector<RawHit> hits(count + 1, RawHit{.t = -7.0f});
            std::vector<uint8_t> is_hit(count + 1, 7);
            closest_hits(copies.levels(), std::span(rays).first(count), hits.data(), nullptr);
            any_hits(copies.levels(), std::span(rays).first(count), is_hit.data(), nullptr);
            for (size_t k = 0; k < count; ++k) {
                ASSERT_TRUE(is_same(hits[k], expected[k])) << "ray " << k << " of " << count;
                ASSERT_EQ(is_hit[k], expected[k].id != kEmptyChild) << "ray " << k << " of " << count;
            }
            ASSERT_EQ(hits[count].t, -7.0f) << "written beyond " << count;
            ASSERT_EQ(is_hit[count], 7) << "written beyond " << count;
        }
    });
}

// Bundles of sixteen and of other numbers, some of which are coherent, in any order.
TEST(Streams, TakeTurnsWithPackets) {
    const Copies copies(random_soup(200, 2.0f, 231), placed_with_identity(20, 232));
    Rng rng(233);
    const Aabb all = copies.levels().top->bounds();
    std::vector<Ray> rays;
    while (rays.size() < 4000) {
        const bool is_coherent = rng.below(2);
        const glm::vec3 eye = all.centre() + random_direction(rng) * all.extent();
        const glm::vec3 target = all.centre() + 0.4f * all.extent() * random_point(rng, 1.0f);
        const size_t count = rng.below(3) ? 16 : rng.below(80);
        for (size_t k = 0; k < count; ++k) {
            const glm::vec3 towards = is_coherent ? target + 0.1f * random_direction(rng) : random_point(rng, 20.0f);
            rays.push_back({.origin = eye, .direction = towards - eye});
        }
    }
    EXPECT_GT(expect_batches_right(copies, rays), 400);
}

// Packets here test all the triangles of a copy; what follows them goes as streams for a while, coherent or not.
TEST(Streams, FollowPacketsThatAreWiderThanTheTriangles) {
    const Copies copies(random_soup(3000, 1.0f, 241), {Affine{}});
    Rng rng(242);
    std::vector<Ray> rays;
    for (int packet = 0; packet < 100; ++packet) {
        const glm::vec3 eye = 60.0f * random_direction(rng);
        const float spread = packet % 10 == 0 ? 5.0f : 0.02f;
        for (int k = 0; k < 16; ++k) rays.push_back({.origin = eye, .direction = random_point(rng, spread) - eye});
    }
    EXPECT_GT(expect_batches_right(copies, rays), 400);
}

TEST(Streams, MayHaveEndsAndBeNoRaysAmongThem) {
    const Copies copies(random_soup(200, 2.0f, 251), placed_with_identity(12, 252));
    std::vector<Ray> rays = scattered_rays(copies, 4000, 253);
    Rng rng(254);
    const float bad[] = {std::nanf(""), kInf, -kInf, 0.0f};
    for (Ray& ray : rays) {
        if (rng.below(2)) ray.t_min = rng.uniform(0.0f, 0.6f);
        if (rng.below(2)) ray.t_max = rng.uniform(0.0f, 1.5f);
        if (rng.below(8) == 0) ray.direction[int(rng.below(3))] = bad[rng.below(4)];
        if (rng.below(16) == 0) ray.origin[int(rng.below(3))] = bad[rng.below(4)];
        if (rng.below(16) == 0) (rng.below(2) ? ray.t_min : ray.t_max) = bad[rng.below(3)];
        if (rng.below(16) == 0) ray.t_min = -1.0f;
    }
    EXPECT_GT(expect_batches_right(copies, rays), 200);
}

TEST(Streams, CopiesInOnePlaceAreToldApartByTheirIds) {
    const Affine map = random_affines(1, 0.5, 2.0, 5.0f, 261)[0];
    const Copies copies(random_soup(150, 2.0f, 262), {map, map, map, map});
    EXPECT_GT(expect_batches_right(copies, scattered_rays(copies, 1000, 263)), 50);
}

TEST(Streams, FindNothingInFrontOfACopysBoxNorBesideIt) {
    const Copies copies(random_soup(150, 2.0f, 271), random_affines(20, 0.5, 2.0, 20.0f, 272), 0.4f);
    EXPECT_GT(expect_batches_right(copies, scattered_rays(copies, 2000, 273)), 50);
}

TEST(Streams, GoDownChainsOfAnyDepth) {
    constexpr int kCount = 20000;
    const TestMesh mesh = stack_of_triangles(kCount);
    Affine turned;
    turned.linear = glm::mat3({0, 1, 0}, {0, 0, 1}, {1, 0, 0});
    turned.translation = {5, 0, 0};
    const Copies copies(mesh, blas_from(chain_over(mesh.boxes()), mesh), {Affine{}, turned});
    ASSERT_GT(copies.levels().stack_size, kCount / 64u);
    Rng rng(281);
    std::vector<Ray> rays;
    for (int k = 0; k < 100; ++k) {
        const float x = rng.uniform(-0.6f, 0.6f), y = rng.uniform(-1.0f, 0.4f);
        rays.push_back({.origin = {x, y, rng.below(2) ? kCount : kCount / 2}, .direction = {0, 0, rng.below(2) ? 1 : -1}});
        rays.push_back({.origin = {rng.below(2) ? -3.0f : 2.0f * kCount, x, y}, .direction = {rng.below(2) ? 1 : -1, 0, 0}});
    }
    EXPECT_GT(expect_batches_right(copies, rays), 50);
}

// A ray is tested with the nodes that it enters, not with those that its neighbours enter. The order is that of all of
// them, though: it sees some nodes before the triangle that would have hidden them.
TEST(Streams, VisitLessThanTwiceTheNodesOfRaysThatGoAlone) {
    const Copies copies(random_soup(3000, 1.0f, 291), placed_with_identity(10, 292));
    const std::vector<Ray> rays = scattered_rays(copies, 4096, 293);
    on_each_target([&] {
        TraverseCounts together, alone;
        std::vector<RawHit> hits(rays.size());
        closest_hits(copies.levels(), rays, hits.data(), &together);
        for (size_t k = 0; k < rays.size(); ++k) closest_hits(copies.levels(), {&rays[k], 1}, &hits[k], &alone);
        EXPECT_GE(together.nodes, alone.nodes / 2);
        EXPECT_LE(together.nodes, 2 * alone.nodes);
        EXPECT_LE(together.triangles, 2 * alone.triangles);
    });
}

}  // namespace
}  // namespace zoe::test
