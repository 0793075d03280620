#include "engine/bvh/clip.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "engine/bvh/build_sbvh.h"
#include "tests/bvh/grazing_rays.h"
#include "tests/math/random_inputs.h"

namespace zoe::test {
namespace {

bool contains(const Aabb& box, const glm::dvec3& p, double slack) {
    for (int axis = 0; axis < 3; ++axis) {
        if (!(box.lo[axis] - slack <= p[axis] && p[axis] <= box.hi[axis] + slack)) return false;
    }
    return true;
}

/// Compares every ray's closest and any hit with brute force, bit for bit.
void expect_same_hits(const TestMesh& mesh, const StaticBvh& bvh, int ray_count, uint64_t seed) {
    ASSERT_EQ(validate(bvh, mesh.positions, mesh.corners), "");
    const Blas blas = blas_from(bvh, mesh);
    for (const Ray& ray : grazing_rays(mesh, ray_count, seed)) {
        const BlasHit expected = brute_force(mesh, ray), found = closest_hit(blas, ray);
        ASSERT_EQ(any_hit(blas, ray), expected.primitive != 0xffffffffu);
        ASSERT_TRUE(is_same(found, expected))
            << to_string(expected) << " by brute force, " << to_string(found) << " by the tree";
    }
}

constexpr int kMeshes = 40, kRaysAMesh = 30000;

TEST(Clip, PiecesOfAnySizeLoseNoHit) {
    for (int k = 0; k < kMeshes; ++k) {
        SCOPED_TRACE(::testing::Message() << "seed " << k);
        const TestMesh mesh = crossing_triangles(k % 3 == 0 ? 4 : k % 3 == 1 ? 16 : 40, 300 + k);
        expect_same_hits(mesh, tree_of_pieces(mesh, 5 << k % 4, k), kRaysAMesh, 400 + k);
    }
}

TEST(Clip, SpatialSplitsLoseNoHit) {
    for (int k = 0; k < kMeshes; ++k) {
        SCOPED_TRACE(::testing::Message() << "seed " << k);
        const TestMesh mesh = crossing_triangles(k % 3 == 0 ? 8 : k % 3 == 1 ? 24 : 48, 500 + k);
        const SbvhConfig config{.max_reference_growth = 6.0f, .min_overlap = 0.0f, .max_leaf_size = 1, .node_cost = 0.0f};
        expect_same_hits(mesh, build_sbvh(mesh.positions, mesh.corners, config), kRaysAMesh, 600 + k);
    }
}

TEST(Clip, EveryPointOfATriangleIsInAPiece) {
    const uint64_t seed = 71;
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Rng rng(seed);
    for (int k = 0; k < 5000; ++k) {
        const float size = log_uniform(rng, 1e-17, 1e17), thickness = log_uniform(rng, 1e-7, 1.0);
        const glm::vec3 place = random_point(rng, size * log_uniform(rng, 1e-3, 1e4));
        Triangle t{place + random_point(rng, size), place + random_point(rng, size), {}, 0};
        t.c = place + (rng.below(2) ? random_point(rng, size) : t.a - place + random_point(rng, size * thickness));
        std::vector<Aabb> pieces{bounds(t)};
        for (int cut = 0; cut < 12; ++cut) {
            Aabb& piece = pieces[rng.below(static_cast<uint32_t>(pieces.size()))];
            const int axis = int(rng.below(3));
            const float plane = glm::mix(piece.lo[axis], piece.hi[axis], rng.uniform());
            if (!(piece.lo[axis] < plane && plane < piece.hi[axis])) continue;
            const ClippedBoxes halves = split_box(t, piece, axis, plane);
            EXPECT_TRUE(piece.contains(halves.left) && piece.contains(halves.right));
            EXPECT_LE(halves.left.hi[axis], plane);
            EXPECT_GE(halves.right.lo[axis], plane);
            piece = halves.left;
            pieces.push_back(halves.right);
        }
        const glm::dvec3 a(t.a), b(t.b), c(t.c);
        const double largest = std::max({glm::length(a), glm::length(b), glm::length(c)});
        for (int point = 0; point < 50; ++point) {
            const double u = rng.uniform(), v = rng.uniform() * (1.0 - u);
            const glm::dvec3 p = (1.0 - u - v) * a + u * b + v * c;
            ASSERT_TRUE(std::any_of(pieces.begin(), pieces.end(),
                                    [&](const Aabb& piece) { return contains(piece, p, 0x1p-48 * largest); }));
        }
    }
}

TEST(Clip, NothingIsLeftWhereTheBoxHoldsNoPartOfTheTriangle) {
    // The triangle's part in x >= 0.5 is below y = 0.5: the upper half of the box is empty there.
    const Triangle t{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 0};
    const ClippedBoxes halves = split_box(t, {{0, 0.6f, 0}, {1, 1, 0}}, 0, 0.5f);
    EXPECT_FALSE(halves.left.is_empty());
    EXPECT_TRUE(halves.right.is_empty());
}

TEST(Clip, APlaneThroughACornerLeavesBothPiecesTheCorner) {
    const Triangle t{{0, 0, 0}, {2, 0, 0}, {1, 1, 0}, 0};
    const ClippedBoxes halves = split_box(t, bounds(t), 0, 1.0f);
    EXPECT_TRUE(halves.left.contains(glm::vec3(1, 1, 0)));
    EXPECT_TRUE(halves.right.contains(glm::vec3(1, 1, 0)));
    EXPECT_EQ(halves.left.hi.x, 1.0f);
    EXPECT_EQ(halves.right.lo.x, 1.0f);
}

TEST(Clip, PadsByAMillionthOfTheTriangleAndStaysFinite) {
    const Triangle t{{0, 0, 0}, {8, 0, 0}, {0, 4, 0}, 0};
    const Aabb piece{{1, 1, 0}, {2, 2, 0}}, wide = padded(piece, t);
    for (int axis = 0; axis < 3; ++axis) {
        EXPECT_LE(wide.lo[axis], piece.lo[axis] - 8 * 0x1p-20f);
        EXPECT_GE(wide.hi[axis], piece.hi[axis] + 8 * 0x1p-20f);
        EXPECT_GE(wide.lo[axis], piece.lo[axis] - 8 * 0x1p-19f);
        EXPECT_LE(wide.hi[axis], piece.hi[axis] + 8 * 0x1p-19f);
    }
    const float huge = std::numeric_limits<float>::max();
    const Triangle all{glm::vec3(-huge), glm::vec3(huge), {huge, -huge, 0}, 0};
    EXPECT_TRUE(padded(bounds(all), all).is_finite());
    EXPECT_TRUE(padded(bounds(all), all).contains(bounds(all)));
}

}  // namespace
}  // namespace zoe::test
