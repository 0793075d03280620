// The oracle's brute force and its comparators, against values worked out by hand. No assets and nothing of the engine but
// Hit and Ray.

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "tests/support/brute_force.h"
#include "tests/support/compare.h"
#include "tests/support/rays.h"

namespace zoe::test {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr float kNaNf = std::numeric_limits<float>::quiet_NaN();

/// One triangle at z = 0 with its right angle at (x, 0), legs of length 1.
WorldTriangle leg(double x, double z, uint32_t node, uint32_t primitive) {
    return {{x, 0, z}, {x + 1, 0, z}, {x, 1, z}, node, primitive, 2.0};
}

OracleRay down(double x, double y, double z = 4.0) {
    return {.origin = {x, y, z}, .direction = {0, 0, -2}};
}

TEST(OracleBruteForce, FindsTheClosestFromBothSides) {
    const BruteForce truth({leg(0, 0, 7, 1), leg(0, 1, 8, 2)});
    const auto hit = truth.closest_hit(down(0.25, 0.25));
    ASSERT_TRUE(hit);
    EXPECT_DOUBLE_EQ(hit->t, 1.5);
    EXPECT_EQ(hit->triangle, 1u);
    const auto from_below = truth.closest_hit({.origin = {0.25, 0.25, -1}, .direction = {0, 0, 1}});
    ASSERT_TRUE(from_below);
    EXPECT_DOUBLE_EQ(from_below->t, 1.0);
    EXPECT_EQ(from_below->triangle, 0u);
    EXPECT_FALSE(truth.closest_hit(down(0.6, 0.6)));
    EXPECT_FALSE(truth.closest_hit({.origin = {0.25, 0.25, 4}, .direction = {0, 0, 1}}));
}

TEST(OracleBruteForce, RespectsTheEndsOfTheRay) {
    const BruteForce truth({leg(0, 0, 0, 0)});
    OracleRay ray = down(0.25, 0.25);
    ray.t_max = 2.0;
    EXPECT_TRUE(truth.closest_hit(ray));
    ray.t_max = 1.999;
    EXPECT_FALSE(truth.closest_hit(ray));
    ray = down(0.25, 0.25);
    ray.t_min = 2.0;
    EXPECT_TRUE(truth.closest_hit(ray));
    ray.t_min = 2.001;
    EXPECT_FALSE(truth.closest_hit(ray));
}

TEST(OracleBruteForce, BreaksTiesByNodeThenPrimitive) {
    const BruteForce truth({leg(0, 0, 5, 1), leg(0, 0, 4, 9), leg(0, 0, 4, 3), leg(0, 0, 6, 0)});
    EXPECT_EQ(truth.closest_hit(down(0.25, 0.25))->triangle, 2u);
}

TEST(OracleBruteForce, HitsNothingThatHasNoAreaOrIsNotANumber) {
    const WorldTriangle line{{0, 0, 0}, {1, 0, 0}, {0.5, 0, 0}, 0, 0, 1.0};
    WorldTriangle broken = leg(0, 0, 0, 1);
    broken.b.x = kNaN;
    const BruteForce truth({line, broken});
    EXPECT_FALSE(truth.closest_hit(down(0.25, 0)));
    EXPECT_FALSE(truth.closest_hit(down(0.25, 0.25)));
    const BruteForce good({leg(0, 0, 0, 0)});
    EXPECT_FALSE(good.closest_hit({.origin = {kNaN, 0, 0}, .direction = {0, 0, 1}}));
    EXPECT_FALSE(good.closest_hit({.origin = {0.2, 0.2, 0}, .direction = {0, 0, 0}}));
}

TEST(OracleBruteForce, KnowsHowNearTheEdgesAre) {
    const BruteForce truth({leg(0, 0, 0, 0)});
    const double tolerance = BruteForce::kRounding * (2.0 + std::sqrt(0.25 * 0.25 + 0.25 * 0.25 + 16.0));
    const auto inside = truth.candidates(down(0.25, 0.25));
    ASSERT_EQ(inside.size(), 1u);
    EXPECT_TRUE(inside[0].is_sure);
    EXPECT_NEAR(inside[0].edge_distance, 0.25, 1e-12);
    EXPECT_NEAR(inside[0].cosine, 1.0, 1e-12);
    EXPECT_NEAR(inside[0].tolerance, tolerance, 1e-12);
    EXPECT_LT(inside[0].t_lo, 2.0);
    EXPECT_GT(inside[0].t_hi, 2.0);
    EXPECT_LT(inside[0].t_hi - inside[0].t_lo, 2.0 * tolerance);
    const auto on_edge = truth.candidates(down(0.25, -0.5 * tolerance));
    ASSERT_EQ(on_edge.size(), 1u);
    EXPECT_FALSE(on_edge[0].is_sure);
    EXPECT_NEAR(on_edge[0].edge_distance, -0.5 * tolerance, 1e-12);
    EXPECT_TRUE(truth.candidates(down(0.25, -2.0 * tolerance)).empty());
    const auto grazing = truth.candidates({.origin = {0.25, -1, 0}, .direction = {0, 1, 0}});
    ASSERT_EQ(grazing.size(), 1u);
    EXPECT_FALSE(grazing[0].is_sure);
    EXPECT_LE(grazing[0].t_lo, 1.0);
    EXPECT_GE(grazing[0].t_hi, 1.75);
}

TEST(OracleBruteForce, GroupsSkipNothing) {
    std::vector<WorldTriangle> triangles;
    for (uint32_t i = 0; i < 500; ++i) {
        const double x = std::fmod(i * 0.618, 3.0), y = std::fmod(i * 0.414, 2.0), z = std::fmod(i * 0.732, 5.0);
        triangles.push_back({{x, y, z}, {x + 0.4, y + 0.1, z}, {x, y + 0.3, z + 0.3}, i, 0, 6.0});
    }
    const BruteForce all(triangles);
    size_t hit_count = 0;
    for (const OracleRay& ray : rays_around(triangles, 400, 1)) {
        double nearest = std::numeric_limits<double>::infinity();
        size_t candidate_count = 0;
        for (const WorldTriangle& triangle : triangles) {
            const BruteForce one({triangle});
            if (const auto hit = one.closest_hit(ray)) nearest = std::min(nearest, hit->t);
            candidate_count += one.candidates(ray).size();
        }
        const auto hit = all.closest_hit(ray);
        EXPECT_EQ(hit ? hit->t : std::numeric_limits<double>::infinity(), nearest);
        EXPECT_EQ(all.candidates(ray).size(), candidate_count);
        hit_count += hit.has_value();
    }
    EXPECT_GT(hit_count, 200u);
}

/// Compares one made-up answer.
Agreement compare_one(const BruteForce& truth, const OracleRay& ray, const Hit& hit) {
    Agreement agreement;
    compare_closest(truth, ray, hit, &agreement);
    return agreement;
}

const Hit kRight{.t = 2.0f, .u = 0.25f, .v = 0.25f, .node = NodeId{0}, .primitive = 3};

TEST(OracleComparator, AcceptsTheRightAnswer) {
    const BruteForce truth({leg(0, 0, 0, 3)});
    const Agreement agreement = compare_one(truth, down(0.25, 0.25), kRight);
    EXPECT_TRUE(agreement.verdict());
    EXPECT_EQ(agreement.borderline_count, 0u);
    EXPECT_EQ(agreement.hit_count, 1u);
    EXPECT_TRUE(compare_one(truth, down(2, 2), Hit{}).verdict());
}

TEST(OracleComparator, FailsOnNaN) {
    const BruteForce truth({leg(0, 0, 0, 3)});
    Hit hit = kRight;
    hit.t = kNaNf;
    EXPECT_FALSE(compare_one(truth, down(0.25, 0.25), hit).verdict());
    hit = kRight;
    hit.u = kNaNf;
    EXPECT_FALSE(compare_one(truth, down(0.25, 0.25), hit).verdict());
    hit = kRight;
    hit.v = kNaNf;
    EXPECT_FALSE(compare_one(truth, down(0.25, 0.25), hit).verdict());
    Hit miss;
    miss.t = kNaNf;
    EXPECT_FALSE(compare_one(truth, down(2, 2), miss).verdict());
    // An oracle that is NaN expects a miss, so that a hit fails.
    WorldTriangle broken = leg(0, 0, 0, 3);
    broken.a.z = kNaN;
    EXPECT_FALSE(compare_one(BruteForce({broken}), down(0.25, 0.25), kRight).verdict());
    EXPECT_FALSE(compare_one(truth, {.origin = {kNaN, 0, 0}, .direction = {0, 0, 1}}, kRight).verdict());
}

TEST(OracleComparator, FailsOnEveryWrongNumber) {
    const BruteForce truth({leg(0, 0, 0, 3), leg(5, 0, 1, 3)});
    const OracleRay ray = down(0.25, 0.25);
    std::vector<Hit> wrong(8, kRight);
    wrong[0] = Hit{};
    wrong[1].t = 2.0002f;
    wrong[2].t = std::numeric_limits<float>::infinity();
    wrong[3].node = NodeId{1};
    wrong[4].primitive = 2;
    wrong[5].u = 0.2505f;
    wrong[6].v = -0.25f;
    wrong[7].t = -2.0f;
    for (const Hit& hit : wrong) EXPECT_FALSE(compare_one(truth, ray, hit).verdict());
    EXPECT_FALSE(compare_one(truth, down(2, 2), kRight).verdict());
    OracleRay cut = ray;
    cut.t_max = 1.0;
    EXPECT_FALSE(compare_one(truth, cut, kRight).verdict());
    Hit second = kRight;
    second.primitive = 4;
    second.t = 2.5f;
    const BruteForce two({leg(0, 0, 0, 3), leg(0, -1, 0, 4)});
    EXPECT_FALSE(compare_one(two, ray, second).verdict()) << "the one behind";
    EXPECT_FALSE(Agreement{}.verdict()) << "no ray at all";
}

TEST(OracleComparator, AcceptsEitherAnswerOnlyAtAnEdgeOrATie) {
    const double tolerance = BruteForce::kRounding * 6.0;
    const BruteForce edge({leg(0, 0, 0, 3)});
    Hit hit = kRight;
    hit.v = 0.0f;
    for (const double y : {0.3 * tolerance, -0.3 * tolerance}) {
        EXPECT_TRUE(compare_one(edge, down(0.25, y), hit).verdict());
        EXPECT_TRUE(compare_one(edge, down(0.25, y), Hit{}).verdict());
        EXPECT_EQ(compare_one(edge, down(0.25, y), y > 0 ? Hit{} : hit).borderline_count, 1u);
    }
    EXPECT_FALSE(compare_one(edge, down(0.25, 3.0 * tolerance), Hit{}).verdict());
    EXPECT_FALSE(compare_one(edge, down(0.25, -3.0 * tolerance), hit).verdict());

    Hit second = kRight;
    second.primitive = 4;
    const BruteForce tie({leg(0, 0, 0, 3), leg(0, -0.3 * tolerance, 0, 4)});
    EXPECT_EQ(compare_one(tie, down(0.25, 0.25), second).tie_count, 1u);
    EXPECT_TRUE(compare_one(tie, down(0.25, 0.25), second).verdict());
    const BruteForce apart({leg(0, 0, 0, 3), leg(0, -5.0 * tolerance, 0, 4)});
    EXPECT_FALSE(compare_one(apart, down(0.25, 0.25), second).verdict());
}

TEST(OracleComparator, FailsOnTooManyTies) {
    const BruteForce tie({leg(0, 0, 0, 3), leg(0, 0, 0, 4)});
    Hit second = kRight;
    second.primitive = 4;
    Agreement agreement;
    for (int i = 0; i < 100; ++i) compare_closest(tie, down(0.25, 0.25), i < 5 ? second : kRight, &agreement);
    EXPECT_EQ(agreement.tie_count, 5u);
    EXPECT_EQ(agreement.borderline_count, 0u);
    EXPECT_FALSE(agreement.verdict());
    EXPECT_TRUE(agreement.verdict(0.05));
}

TEST(OracleComparator, FailsOnTooManyBorderlineRays) {
    const BruteForce edge({leg(0, 0, 0, 3)});
    const double y = 0.3 * BruteForce::kRounding * 6.0;
    Agreement agreement;
    for (int i = 0; i < 197; ++i) compare_closest(edge, down(0.25, 0.25), kRight, &agreement);
    for (int i = 0; i < 2; ++i) compare_closest(edge, down(0.25, y), Hit{}, &agreement);
    EXPECT_FALSE(agreement.verdict());
    compare_closest(edge, down(0.25, 0.25), kRight, &agreement);
    EXPECT_TRUE(agreement.verdict());
}

TEST(OracleComparator, ComparesAnyHit) {
    const BruteForce truth({leg(0, 0, 0, 3)});
    const auto verdict = [&](const OracleRay& ray, bool is_hit) {
        Agreement agreement;
        compare_any(truth, ray, is_hit, &agreement);
        return static_cast<bool>(agreement.verdict());
    };
    EXPECT_TRUE(verdict(down(0.25, 0.25), true));
    EXPECT_FALSE(verdict(down(0.25, 0.25), false));
    EXPECT_TRUE(verdict(down(2, 2), false));
    EXPECT_FALSE(verdict(down(2, 2), true));
    EXPECT_TRUE(verdict(down(0.25, 1e-6), false));
    EXPECT_TRUE(verdict(down(0.25, -1e-6), true));
}

TEST(OracleRays, AreTheSameForTheSameSeedAndKeepFloats) {
    std::vector<WorldTriangle> triangles{leg(0, 0, 0, 0), leg(0, 0, 0, 1)};
    triangles[1].a.x = kNaN;
    const auto rays = rays_around(triangles, 64, 5), again = rays_around(triangles, 64, 5),
               other = rays_around(triangles, 64, 6);
    ASSERT_EQ(rays.size(), 64u);
    size_t different = 0, hit_count = 0;
    const BruteForce truth(triangles);
    for (size_t i = 0; i < rays.size(); ++i) {
        EXPECT_EQ(rays[i].origin, again[i].origin);
        EXPECT_EQ(rays[i].direction, again[i].direction);
        EXPECT_EQ(rays[i].origin, glm::dvec3(engine_ray(rays[i]).origin));
        EXPECT_EQ(rays[i].direction, glm::dvec3(engine_ray(rays[i]).direction));
        EXPECT_LE(rays[i].t_min, rays[i].t_max);
        different += rays[i].origin != other[i].origin;
        hit_count += truth.closest_hit(rays[i]).has_value();
    }
    EXPECT_GT(different, 60u);
    EXPECT_GT(hit_count, 32u);
    EXPECT_TRUE(rays_around({&triangles[1], 1}, 8, 1).empty());
}

}  // namespace
}  // namespace zoe::test
