// Coordinates beyond what any scene has: right as far as is said, and harmless as far as floats go.

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "engine/bvh/traverse.h"
#include "tests/bvh/each_target.h"
#include "tests/bvh/inputs.h"
#include "tests/math/random_inputs.h"
#include "tests/support/brute_force.h"

namespace zoe::test {
namespace {

constexpr BlasBuilder kBuilders[] = {BlasBuilder::kBinned, BlasBuilder::kSweep, BlasBuilder::kReinserted, BlasBuilder::kSbvh,
                                     BlasBuilder::kMedian};

/// A closed ball about a point.
void add_ball(const glm::vec3& centre, float radius, TestMesh* mesh) {
    constexpr int kAround = 20, kRows = 10;
    const auto place = [&](int row, int k) {
        const double a = M_PI * row / kRows, b = 2.0 * M_PI * (k % kAround) / kAround;
        const glm::dvec3 p(std::sin(a) * std::cos(b), std::cos(a), std::sin(a) * std::sin(b));
        return glm::vec3(glm::dvec3(centre) + double{radius} * p);
    };
    for (int row = 0; row < kRows; ++row) {
        for (int k = 0; k < kAround; ++k) {
            mesh->add(place(row, k), place(row, k + 1), place(row + 1, k));
            mesh->add(place(row, k + 1), place(row + 1, k + 1), place(row + 1, k));
        }
    }
}

BruteForce oracle_of(const TestMesh& mesh) {
    std::vector<WorldTriangle> triangles;
    for (uint32_t k = 0; k < mesh.corners.size(); ++k) {
        const Triangle t = mesh.triangle(k);
        const double size =
            std::max({glm::length(glm::dvec3(t.a)), glm::length(glm::dvec3(t.b)), glm::length(glm::dvec3(t.c))});
        triangles.push_back({glm::dvec3(t.a), glm::dvec3(t.b), glm::dvec3(t.c), 0, k, size});
    }
    return BruteForce(std::move(triangles));
}

/// From one point of a cube to another, by directions of length 1 or as long as they are.
std::vector<Ray> rays_in(float size, int count, uint64_t seed) {
    Rng rng(seed);
    std::vector<Ray> rays;
    for (int k = 0; k < count; ++k) {
        // Scaled last: a uniform number's range would overflow.
        const glm::dvec3 from(random_point(rng, 1.0f)), to(0.6f * random_point(rng, 1.0f));
        const glm::dvec3 way = rng.below(2) ? glm::normalize(to - from) : 0.5 * double{size} * (to - from);
        rays.push_back({.origin = glm::vec3(double{size} * from), .direction = glm::vec3(way)});
    }
    return rays;
}

OracleRay to_oracle(const Ray& ray) {
    return {.origin = glm::dvec3(ray.origin), .direction = glm::dvec3(ray.direction), .t_min = ray.t_min};
}

/// A hit is one that the ray has, nothing that is surely hit lies before it, and nothing that is surely hit is missed
/// unless `may_miss`. Returns whether there was one.
bool expect_hit_right(const BruteForce& oracle, const Ray& ray, const BlasHit& hit, bool may_miss) {
    const std::vector<Candidate> candidates = oracle.candidates(to_oracle(ray));
    const bool is_hit = hit.primitive != kEmptyChild;
    const auto is_this = [&](const Candidate& c) {
        return c.triangle == hit.primitive && c.t_lo <= hit.t && hit.t <= c.t_hi;
    };
    const auto is_nearer = [&](const Candidate& c) { return c.is_sure && !(c.t_hi >= hit.t); };
    EXPECT_TRUE(!is_hit || std::ranges::any_of(candidates, is_this)) << to_string(hit);
    EXPECT_TRUE(may_miss || std::ranges::none_of(candidates, is_nearer)) << to_string(hit);
    return is_hit;
}

TEST(Huge, UpToThreeTimesTenToTheEighteenEveryHitIsFound) {
    for (const float size : {1e15f, 1e18f, 3e18f}) {
        SCOPED_TRACE(size);
        TestMesh mesh{"balls", {}, {}};
        add_ball(glm::vec3(0.0f), 0.6f * size, &mesh);
        add_ball(glm::vec3(0.7f, -0.7f, 0.7f) * size, 0.3f * size, &mesh);
        const BruteForce oracle = oracle_of(mesh);
        const std::vector<Ray> rays = rays_in(size, 400, 301);
        for (const BlasBuilder builder : kBuilders) {
            Blas blas;
            build_blas(mesh.positions, mesh.corners, builder, &blas);
            int hit_count = 0;
            for (const Ray& ray : rays) hit_count += expect_hit_right(oracle, ray, closest_hit(blas, ray), false);
            EXPECT_GT(hit_count, 250);
        }
    }
}

TEST(Huge, AsFarAsFloatsGoHitsAreRightAndTheSameInEveryTree) {
    for (const float size : {1e19f, 1e20f, 1e22f, 1e30f, 1e38f, 3e38f}) {
        SCOPED_TRACE(size);
        TestMesh mesh{"balls", {}, {}};
        add_ball(glm::vec3(0.0f), 0.6f * size, &mesh);
        add_ball(glm::vec3(0.7f, -0.7f, 0.7f) * size, 0.3f * size, &mesh);
        const BruteForce oracle = oracle_of(mesh);
        const std::vector<Ray> rays = rays_in(size, 200, 302);
        for (const BlasBuilder builder : kBuilders) {
            Blas blas;
            build_blas(mesh.positions, mesh.corners, builder, &blas);
            EXPECT_EQ(validate(blas, mesh.positions, mesh.corners), "");
            on_each_target([&] {
                for (const Ray& ray : rays) {
                    const BlasHit hit = closest_hit(blas, ray);
                    ASSERT_TRUE(is_same(hit, brute_force(mesh, ray))) << to_string(hit);
                    ASSERT_EQ(any_hit(blas, ray), hit.primitive != kEmptyChild);
                }
            });
            int hit_count = 0;
            for (const Ray& ray : rays) hit_count += expect_hit_right(oracle, ray, closest_hit(blas, ray), true);
            EXPECT_GT(hit_count, size < 1e37f ? 20 : -1);
        }
    }
}

TEST(Huge, DisturbNothingBesideThem) {
    TestMesh alone{"ball", {}, {}};
    add_ball({1, 2, 3}, 1.0f, &alone);
    for (const float size : {1e18f, 1e20f, 1e30f, 3e38f}) {
        SCOPED_TRACE(size);
        TestMesh mesh = alone;
        Rng rng(303);
        for (int k = 0; k < 40; ++k) {  // Around the ball: no ray meets them before it.
            const glm::vec3 at = size * random_direction(rng);
            mesh.add(at, 0.9f * at + 0.05f * size * random_direction(rng), 0.9f * at + 0.05f * size * random_direction(rng));
        }
        for (const BlasBuilder builder : kBuilders) {
            Blas blas;
            build_blas(mesh.positions, mesh.corners, builder, &blas);
            for (int k = 0; k < 300; ++k) {
                const glm::vec3 origin = glm::vec3(1, 2, 3) + 5.0f * random_direction(rng);
                const Ray ray{.origin = origin, .direction = glm::vec3(1, 2, 3) + 0.5f * random_direction(rng) - origin};
                const BlasHit hit = closest_hit(blas, ray);
                ASSERT_LT(hit.primitive, alone.corners.size());
                ASSERT_TRUE(is_same(hit, brute_force(alone, ray))) << to_string(hit);
            }
        }
    }
}

}  // namespace
}  // namespace zoe::test
