#include "engine/bvh/epo.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "engine/bvh/build_sbvh.h"
#include "engine/bvh/build_sweep.h"
#include "engine/math/parallel.h"
#include "tests/bvh/inputs.h"
#include "tests/math/random_inputs.h"

namespace zoe::test {
namespace {

using Real = long double;

bool is_finite_triangle(const Triangle& t) {
    return is_finite(t.a) && is_finite(t.b) && is_finite(t.c);
}

Real area(const Triangle& t) {
    Real square = 0;
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        const Real x = (Real(t.b[j]) - t.a[j]) * (Real(t.c[k]) - t.a[k]) - (Real(t.b[k]) - t.a[k]) * (Real(t.c[j]) - t.a[j]);
        square += x * x;
    }
    return std::sqrt(square) / 2;
}

/// The part of a triangle inside a box, 0 to 1: each side of the box cuts a half plane off the triangle of the barycentric
/// coordinates (u, v), whose area is 1/2.
Real share_inside(const Triangle& t, const Aabb& box) {
    std::vector<std::pair<Real, Real>> polygon = {{0, 0}, {1, 0}, {0, 1}};
    for (int side = 0; side < 6; ++side) {
        const int axis = side / 2;
        const Real sign = side % 2 == 0 ? 1 : -1, plane = side % 2 == 0 ? box.hi[axis] : box.lo[axis];
        const Real u1 = Real(t.b[axis]) - t.a[axis], v1 = Real(t.c[axis]) - t.a[axis];
        const auto outside = [&](const std::pair<Real, Real>& p) {
            return sign * (t.a[axis] + p.first * u1 + p.second * v1 - plane);
        };
        std::vector<std::pair<Real, Real>> kept;
        for (size_t k = 0; k < polygon.size(); ++k) {
            const auto &p = polygon[k], &q = polygon[(k + 1) % polygon.size()];
            const Real dp = outside(p), dq = outside(q);
            if (dp <= 0) kept.push_back(p);
            if ((dp <= 0) == (dq <= 0)) continue;
            const Real s = dp / (dp - dq);
            kept.emplace_back(p.first + s * (q.first - p.first), p.second + s * (q.second - p.second));
        }
        polygon = std::move(kept);
    }
    Real twice = 0;
    for (size_t k = 0; k < polygon.size(); ++k) {
        const auto &p = polygon[k], &q = polygon[(k + 1) % polygon.size()];
        twice += p.first * q.second - p.second * q.first;
    }
    return std::abs(twice);
}

/// A binary tree, and its triangles in the order of the leaves.
struct Tree {
    Bvh bvh;
    std::vector<Triangle> triangles;
};

Tree tree_from(Bvh bvh, const TestMesh& mesh) {
    Tree tree{std::move(bvh), {}};
    for (const uint32_t primitive : tree.bvh.primitives) tree.triangles.push_back(mesh.triangle(primitive));
    return tree;
}

/// The same tree over a mesh whose triangles moved: the boxes follow.
Tree refitted(const Tree& tree, const TestMesh& moved) {
    Tree fitted = tree_from(tree.bvh, moved);
    const std::vector<Aabb> boxes = moved.boxes();
    std::vector<BvhNode>& nodes = fitted.bvh.nodes;
    for (size_t k = nodes.size(); k-- > 0;) {
        Aabb box;
        for (uint32_t i = 0; i < nodes[k].count; ++i) box.extend(boxes[fitted.bvh.primitives[nodes[k].first + i]]);
        if (!nodes[k].is_leaf()) box = merge(nodes[nodes[k].first].bounds(), nodes[nodes[k].first + 1].bounds());
        nodes[k].lo = box.lo;
        nodes[k].hi = box.hi;
    }
    return fitted;
}

/// Every node against every triangle, which is under all nodes that have a leaf with it.
double reference(const Tree& tree) {
    const std::vector<BvhNode>& nodes = tree.bvh.nodes;
    std::vector<std::set<uint32_t>> under(nodes.size());
    for (size_t k = nodes.size(); k-- > 0;) {
        if (nodes[k].is_leaf()) {
            for (uint32_t i = 0; i < nodes[k].count; ++i) under[k].insert(tree.bvh.primitives[nodes[k].first + i]);
        } else {
            under[k] = under[nodes[k].first];
            under[k].insert(under[nodes[k].first + 1].begin(), under[nodes[k].first + 1].end());
        }
    }
    Real sum = 0, whole = 0;
    std::set<uint32_t> seen;
    for (uint32_t slot = 0; slot < tree.triangles.size(); ++slot) {
        const Triangle& t = tree.triangles[slot];
        const uint32_t primitive = tree.bvh.primitives[slot];
        if (!seen.insert(primitive).second || !is_finite_triangle(t)) continue;
        whole += area(t);
        for (size_t k = 0; k < nodes.size(); ++k) {
            if (under[k].contains(primitive)) continue;
            sum += (nodes[k].is_leaf() ? nodes[k].count : 1) * area(t) * share_inside(t, nodes[k].bounds());
        }
    }
    return whole > 0 ? static_cast<double>(sum / whole) : 0.0;
}

void expect_reference(const Tree& tree, double tolerance = 1e-9) {
    const double epo = epo_cost(tree.bvh, tree.triangles), expected = reference(tree);
    EXPECT_TRUE(std::abs(epo - expected) <= tolerance * std::max(1.0, expected)) << epo << ", not " << expected;
}

/// A leaf a triangle under a root.
Tree two_leaves(const Triangle& a, const Triangle& b) {
    Tree tree;
    tree.triangles = {a, b};
    const Aabb left = bounds(a), right = bounds(b), root = merge(left, right);
    tree.bvh.primitives = {0, 1};
    tree.bvh.nodes = {{root.lo, 1, root.hi, 0}, {left.lo, 0, left.hi, 1}, {right.lo, 1, right.hi, 1}};
    return tree;
}

Tree built(const TestMesh& mesh) {
    return tree_from(build_sweep(mesh.boxes()), mesh);
}

TEST(Epo, ATriangleInPiecesCountsOnceAndBelongsWhereverAPieceIs) {
    TestMesh mesh = random_soup(150, 1.0f, 71);
    Rng rng(71);
    for (int k = 0; k < 12; ++k) mesh.add(random_point(rng, 10.0f), random_point(rng, 10.0f), random_point(rng, 10.0f));
    const StaticBvh bvh = build_sbvh(mesh.positions, mesh.corners, {.max_reference_growth = 3.0f, .min_overlap = 0.0f});
    ASSERT_GT(bvh.tree.primitives.size(), mesh.corners.size() + 20);
    const Tree tree = tree_from(bvh.tree, mesh);
    const double expected = reference(tree);
    EXPECT_GT(expected, 0.0);
    EXPECT_NEAR(epo_cost(tree.bvh, tree.triangles), expected, 1e-9 * expected);
}

TEST(EpoCost, IsZeroWhereNothingOverlaps) {
    const Triangle a{{0, 0, 0}, {1, 0, 0}, {0, 1, 1}, 0};
    const Tree apart = two_leaves(a, {{3, 0, 0}, {4, 0, 0}, {3, 1, 1}, 1});
    EXPECT_EQ(epo_cost(apart.bvh, apart.triangles), 0.0);
    const Tree touching = two_leaves(a, {{1, 0, 0}, {2, 0, 0}, {2, 1, 1}, 1});
    EXPECT_EQ(epo_cost(touching.bvh, touching.triangles), 0.0) << "an edge of a box has no area";
    EXPECT_EQ(epo_cost({}, {}), 0.0);
    Bvh leaf;
    leaf.nodes = {{{0, 0, 0}, 0, {1, 1, 1}, 1}};
    leaf.primitives = {0};
    EXPECT_EQ(epo_cost(leaf, std::span(&a, 1)), 0.0);
}

// In the plane z = 0. The box of a is [0, 2]^2, that of b [1, 3] x [0, 2].
//
//   2 |\  |\         of b (area 2) 1.5 is left of x = 2
//     | \ | \        of a (area 2) 0.5 is right of x = 1
//     |  \|  \.
//   0 +---+---+---   EPO = (1.5 + 0.5) / 4
//     0   1   2   3
TEST(EpoCost, OfTwoFlatTrianglesByHand) {
    Tree tree = two_leaves({{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, 0}, {{1, 0, 0}, {3, 0, 0}, {1, 2, 0}, 1});
    EXPECT_DOUBLE_EQ(epo_cost(tree.bvh, tree.triangles), 0.5);
    // A leaf costs a unit a triangle: what has no area counts in it, but lies nowhere.
    tree.triangles.push_back({{0, 0, 0}, {1, 1, 0}, {2, 2, 0}, 2});
    tree.bvh.primitives = {0, 2, 1};
    std::swap(tree.triangles[1], tree.triangles[2]);
    tree.bvh.nodes[1].count = 2;
    tree.bvh.nodes[2].first = 2;
    EXPECT_DOUBLE_EQ(epo_cost(tree.bvh, tree.triangles), (2 * 1.5 + 0.5) / 4);
}

// The small one, of area 1/2, lies wholly in the large one's box; the large one passes the small one's flat box by.
TEST(EpoCost, OfATriangleThatIsWhollyInsideByHand) {
    const Triangle large{{0, 0, 0}, {4, 0, 4}, {0, 4, 4}, 0}, small{{1, 1, 1}, {2, 1, 1}, {1, 1, 2}, 1};
    const Tree tree = two_leaves(large, small);
    const double large_area = 8.0 * std::sqrt(3.0);
    EXPECT_NEAR(epo_cost(tree.bvh, tree.triangles), 0.5 / (0.5 + large_area), 1e-12);
}

TEST(EpoCost, EqualsEveryNodeAgainstEveryTriangle) {
    for (uint64_t seed = 500; seed < 540; ++seed) {
        Rng rng(seed);
        const int count = 1 + static_cast<int>(rng.below(120));
        const TestMesh mesh = random_soup(count, log_uniform(rng, 0.01, 3.0), seed);
        const std::vector<Aabb> boxes = mesh.boxes();
        for (const NamedBuilder& builder : all_builders()) {
            SCOPED_TRACE(::testing::Message() << "seed " << seed << ", " << count << " triangles, " << builder.name);
            expect_reference(tree_from(builder.build(boxes), mesh));
        }
    }
}

TEST(EpoCost, IsRightOnTreesThatOverlapAsTreesNeverShould) {
    for (uint64_t seed = 540; seed < 550; ++seed) {
        SCOPED_TRACE(::testing::Message() << "seed " << seed);
        const TestMesh mesh = random_soup(150, 0.5f, seed);
        Tree tree = built(mesh);
        TestMesh moved = mesh;
        Rng rng(seed);
        for (glm::vec3& p : moved.positions) p = random_point(rng, 1.0f);
        tree = refitted(tree, moved);
        EXPECT_GT(epo_cost(tree.bvh, tree.triangles), 1.0);
        expect_reference(tree);
    }
}

TEST(EpoCost, TakesWhatBuildersTake) {
    for (const TestMesh& mesh : nasty_meshes()) {
        if (mesh.corners.size() > 400) continue;
        SCOPED_TRACE(mesh.name);
        const std::vector<Aabb> boxes = mesh.boxes();
        for (const NamedBuilder& builder : all_builders()) {
            if (!accepts(builder, boxes)) continue;
            SCOPED_TRACE(builder.name);
            expect_reference(tree_from(builder.build(boxes), mesh));
        }
    }
}

TEST(EpoCost, WhatIsNotFiniteOrHasNoAreaAddsNothing) {
    const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
    for (uint64_t seed = 550; seed < 560; ++seed) {
        SCOPED_TRACE(::testing::Message() << "seed " << seed);
        Rng rng(seed);
        TestMesh mesh = random_soup(60, 0.8f, seed);
        for (int k = 0; k < 10; ++k) {
            const glm::vec3 p = random_point(rng, 1.0f), q = random_point(rng, 1.0f);
            mesh.add(p, q, glm::vec3(nan, 0.0f, 0.0f));
            mesh.add(p, glm::vec3(0.0f, inf, 0.0f), q);
            mesh.add(p, p, q);
        }
        expect_reference(built(mesh));
    }
    TestMesh nothing;
    nothing.name = "nothing finite";
    for (int k = 0; k < 20; ++k) nothing.add(glm::vec3(nan), glm::vec3(inf), glm::vec3(0.0f));
    const Tree tree = built(nothing);
    EXPECT_EQ(epo_cost(tree.bvh, tree.triangles), 0.0);
}

/// Other leaf orders and other primitive numbers: only the order of the sums changes.
TEST(EpoCost, DoesNotDependOnTheOrderOfTriangles) {
    for (uint64_t seed = 560; seed < 570; ++seed) {
        SCOPED_TRACE(::testing::Message() << "seed " << seed);
        Rng rng(seed);
        const TestMesh mesh = random_soup(500, 0.4f, seed);
        const Tree tree = built(mesh);
        const double epo = epo_cost(tree.bvh, tree.triangles);
        ASSERT_GT(epo, 0.0);
        // The leaves' slots are dealt out anew, in any order, so that subtrees no longer own neighbours.
        Tree shuffled = tree;
        std::vector<size_t> leaves;
        for (size_t k = 0; k < tree.bvh.nodes.size(); ++k) {
            if (tree.bvh.nodes[k].is_leaf()) leaves.push_back(k);
        }
        for (size_t k = leaves.size(); k-- > 1;) std::swap(leaves[k], leaves[rng.below(uint32_t(k + 1))]);
        uint32_t slot = 0;
        for (const size_t k : leaves) {
            const BvhNode& from = tree.bvh.nodes[k];
            shuffled.bvh.nodes[k].first = slot;
            for (uint32_t i = from.count; i-- > 0; ++slot) {
                shuffled.bvh.primitives[slot] = tree.bvh.primitives[from.first + i];
                shuffled.triangles[slot] = tree.triangles[from.first + i];
            }
        }
        ASSERT_EQ(validate(shuffled.bvh, mesh.boxes()), "");
        EXPECT_NEAR(epo_cost(shuffled.bvh, shuffled.triangles), epo, 1e-12 * epo);
        for (Triangle& t : shuffled.triangles) t = {t.b, t.c, t.a, 0};
        EXPECT_NEAR(epo_cost(shuffled.bvh, shuffled.triangles), epo, 1e-12 * epo);
    }
}

TEST(EpoCost, IsTheSameBitsOnAnyNumberOfThreads) {
    const Tree tree = built(random_soup(5000, 0.3f, 570));
    set_thread_count(1);
    const double epo = epo_cost(tree.bvh, tree.triangles);
    for (const int threads : {2, 3, 8}) {
        set_thread_count(threads);
        EXPECT_EQ(epo_cost(tree.bvh, tree.triangles), epo) << threads;
    }
    set_thread_count(0);
}

TEST(EpoCost, GrowsWhenATreeIsRefittedToAScrambledMesh) {
    const TestMesh mesh = random_soup(1000, 0.2f, 571);
    Tree tree = built(mesh);
    TestMesh moved = mesh;
    Rng rng(571);
    for (size_t k = 0; k + 3 <= moved.positions.size(); k += 3) {
        const glm::vec3 away = random_point(rng, 2.0f);
        for (size_t i = 0; i < 3; ++i) moved.positions[k + i] += away;
    }
    tree = refitted(tree, moved);
    const Tree fresh = built(moved);
    EXPECT_GT(epo_cost(tree.bvh, tree.triangles), 2.0 * epo_cost(fresh.bvh, fresh.triangles));
}

}  // namespace
}  // namespace zoe::test
