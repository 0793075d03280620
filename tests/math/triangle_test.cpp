#include "engine/math/triangle.h"

#include <algorithm>
#include <limits>

#include <gtest/gtest.h>
#include <glm/ext/vector_double3.hpp>

#include "tests/math/random_inputs.h"
#include "tests/math/shoot.h"

namespace zoe::test {
namespace {

constexpr double kEps = std::numeric_limits<float>::epsilon();

/// Where a ray meets a triangle's plane, in double, and how far rounding to float may move it.
struct Reference {
    double t, u, v, w;         ///< w, u, v weigh a, b, c.
    double error_t, error[3];  ///< Of t, and of w, u, v.
    bool is_clear_hit() const { return w > error[0] && u > error[1] && v > error[2]; }
    bool is_clear_miss() const { return w < -error[0] || u < -error[1] || v < -error[2]; }
};

Reference reference(const Ray& ray, const Triangle& triangle) {
    const glm::dvec3 d(ray.direction), o(ray.origin);
    const glm::dvec3 a = glm::dvec3(triangle.a) - o, b = glm::dvec3(triangle.b) - o, c = glm::dvec3(triangle.c) - o;
    const glm::dvec3 normal = glm::cross(b - a, c - a);
    const double facing = glm::dot(normal, d);
    Reference r;
    r.t = glm::dot(normal, a) / facing;
    r.w = glm::dot(d, glm::cross(b, c)) / facing;
    r.u = glm::dot(d, glm::cross(c, a)) / facing;
    r.v = glm::dot(d, glm::cross(a, b)) / facing;
    const double farthest = std::max({glm::length(a), glm::length(b), glm::length(c)});
    const double seen_area = std::abs(facing) / glm::length(d);  // Twice the area, seen along the ray.
    // A corner moves by a few ulps of its distance; an edge function then by that times the corners' distance from the ray.
    const auto from_ray = [&](const glm::dvec3& p) { return glm::length(glm::cross(p, d)) / glm::length(d); };
    const double sides[3] = {from_ray(b) + from_ray(c), from_ray(c) + from_ray(a), from_ray(a) + from_ray(b)};
    const double weights[3] = {r.w, r.u, r.v};
    const double moved = 8.0 * kEps * farthest / seen_area;
    const double spread = moved * (sides[0] + sides[1] + sides[2]);
    for (int k = 0; k < 3; ++k) {
        r.error[k] = spread < 0.25 ? moved * sides[k] + 2.0 * std::abs(weights[k]) * spread
                                   : std::numeric_limits<double>::infinity();  // Edge on: anything goes.
    }
    const double longest = std::max({glm::length(c - b), glm::length(a - c), glm::length(b - a)});
    r.error_t = (8.0 * kEps * farthest + (r.error[0] + r.error[1] + r.error[2]) * longest) / glm::length(d);
    return r;
}

void expect_agrees(const Ray& ray, const Triangle& triangle, int round, int* hit_count, int* miss_count) {
    const Reference expected = reference(ray, triangle);
    TriangleHit hit;
    const bool is_hit = shoot(ray, triangle, &hit);
    if (expected.is_clear_hit() && expected.t > expected.error_t) {
        ASSERT_TRUE(is_hit) << "round " << round;
        ++*hit_count;
    }
    if (expected.is_clear_miss() || expected.t < -expected.error_t) {
        ASSERT_FALSE(is_hit) << "round " << round;
        ++*miss_count;
    }
    if (is_hit) {
        ASSERT_LE(std::abs(hit.t - expected.t), expected.error_t) << "round " << round;
        ASSERT_GE(hit.t, 0.0f);
        ASSERT_LE(std::abs(hit.u - expected.u), expected.error[1] + 4 * kEps) << "round " << round;
        ASSERT_LE(std::abs(hit.v - expected.v), expected.error[2] + 4 * kEps) << "round " << round;
        ASSERT_GE(hit.u, 0.0f);
        ASSERT_GE(hit.v, 0.0f);
        ASSERT_LE(hit.u + hit.v, 1.0f + 4 * kEps);
    }
}

TEST(Triangle, HandComputedHit) {
    const Triangle triangle{{0, 0, -5}, {4, 0, -5}, {0, 4, -5}, 3};
    TriangleHit hit;
    ASSERT_TRUE(shoot({{1, 2, 0}, {0, 0, -2}}, triangle, &hit));
    EXPECT_EQ(hit.t, 2.5f);
    EXPECT_EQ(hit.u, 0.25f);
    EXPECT_EQ(hit.v, 0.5f);
    EXPECT_TRUE(shoot({{1, 2, -9}, {0, 0, 2}}, triangle)) << "the back side counts";
    EXPECT_FALSE(shoot({{3, 3, 0}, {0, 0, -2}}, triangle)) << "beside it";
    EXPECT_FALSE(shoot({{1, 2, -6}, {0, 0, -2}}, triangle)) << "behind the ray";
}

TEST(Triangle, AgreesWithDoubleFromTinyToHuge) {
    const uint64_t seed = 31;
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Rng rng(seed);
    int hits = 0, misses = 0;
    for (int i = 0; i < 300000; ++i) {
        const float size = log_uniform(rng, 1e-9, 1e9);
        const glm::vec3 place = random_direction(rng) * size * log_uniform(rng, 0.01, 1e4);
        const Triangle triangle{place + random_point(rng, size), place + random_point(rng, size),
                                place + random_point(rng, size), 0};
        const glm::vec3 target = place + random_point(rng, size);
        Ray ray;
        ray.origin = random_point(rng, size);
        ray.direction = (target - ray.origin) * log_uniform(rng, 1e-3, 1e3);
        expect_agrees(ray, triangle, i, &hits, &misses);
        if (HasFatalFailure()) return;
    }
    EXPECT_GT(hits, 20000);
    EXPECT_GT(misses, 20000);
}

TEST(Triangle, AgreesWithDoubleOnNeedles) {
    const uint64_t seed = 32;
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Rng rng(seed);
    int hits = 0, misses = 0;
    for (int i = 0; i < 300000; ++i) {
        const glm::vec3 along = random_direction(rng);
        const glm::vec3 across = glm::normalize(glm::cross(along, random_direction(rng)));
        const float width = log_uniform(rng, 1e-6, 1.0);
        const glm::vec3 a = random_point(rng, 1.0f);
        const Triangle triangle{a, a + along, a + along * rng.uniform() + across * width, 0};
        const float u = rng.uniform(), v = rng.uniform();
        const glm::vec3 target = a + along * u + across * (v * width);
        Ray ray;
        ray.origin = target + random_direction(rng) * log_uniform(rng, 1e-2, 1e2);
        ray.direction = target - ray.origin;
        expect_agrees(ray, triangle, i, &hits, &misses);
        if (HasFatalFailure()) return;
    }
    EXPECT_GT(hits, 20000);
    EXPECT_GT(misses, 20000);
}

}  // namespace
}  // namespace zoe::test
