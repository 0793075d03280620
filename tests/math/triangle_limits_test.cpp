#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "engine/math/triangle.h"
#include "tests/math/random_inputs.h"
#include "tests/math/shoot.h"

namespace zoe::test {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

TEST(Triangle, BehindTheRayIsMissedEvenWhereItsBoxHoldsTheOrigin) {
    const Triangle triangle{{-10, -10, -10}, {10, -10, 10}, {0, 10, 0}, 0};
    ASSERT_TRUE(bounds(triangle).contains(glm::vec3(0, 0, 5)));
    EXPECT_FALSE(shoot({{0, 0, 5}, {0, 0, 1}}, triangle));
    EXPECT_TRUE(shoot({{0, 0, 5}, {0, 0, -1}}, triangle));
}

// One side of an edge is cut at its middle: a triangle without area between the three corners seals the seam, which no
// rounding of sheared coordinates may open.
TEST(Triangle, OfNoAreaSealsTheSeamItLiesOn) {
    const uint64_t seed = 33;
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Rng rng(seed);
    const glm::vec3 a(-3, 1, 2), b(5, 3, -2), middle = 0.5f * (a + b);  // Exact in float.
    const glm::vec3 above(0, 9, 1), below(1, -7, 0);
    const Triangle whole{a, b, above, 0}, left{a, middle, below, 1}, right{middle, b, below, 2}, seal{a, b, middle, 3};
    int sealed = 0;
    for (int i = 0; i < 400000; ++i) {
        Ray ray;
        ray.origin = glm::vec3(1, 2, 40) + random_point(rng, 3.0f);
        ray.direction = glm::mix(a, b, rng.uniform(0.01f, 0.99f)) - ray.origin;
        if (shoot(ray, whole) || shoot(ray, left) || shoot(ray, right)) continue;
        ++sealed;
        ASSERT_TRUE(shoot(ray, seal)) << "round " << i;
    }
    EXPECT_GT(sealed, 0) << "the seam never opened: these rays test nothing";
}

TEST(Triangle, WithANonFiniteCornerIsNeverHit) {
    Rng rng(34);
    for (const float bad : {kNan, -kNan, kInf, -kInf}) {
        for (int component = 0; component < 9; ++component) {
            for (int i = 0; i < 200; ++i) {
                std::array<glm::vec3, 3> corners{glm::vec3{-1, -1, 0}, glm::vec3{1, -1, 0}, glm::vec3{0, 1, 0}};
                corners[component / 3][component % 3] = bad;
                Ray ray;
                ray.origin = random_point(rng, 3.0f);
                ray.direction = i % 2 ? random_direction(rng) : glm::vec3(0, 0, -1);
                ASSERT_FALSE(shoot(ray, {corners[0], corners[1], corners[2], 0})) << bad << " in component " << component;
            }
        }
    }
}

TEST(Triangle, RaysThatAreNotRaysHitNothing) {
    std::vector<Ray> rays = {{{0, 0, 1}, {0, 0, 0}}, {{0, 0, 0}, {0, 0, 0}}, {{0, 0, 1}, {-0.0f, 0.0f, -0.0f}}};
    for (int axis = 0; axis < 3; ++axis) {
        for (const float bad : {kNan, kInf, -kInf}) {
            Ray ray{{0, 0, 1}, {0, 0, -1}};
            ray.origin[axis] = bad;
            rays.push_back(ray);
            ray = {{0, 0, 1}, {0, 0, -1}};
            ray.direction[axis] = bad;
            rays.push_back(ray);
        }
    }
    for (size_t i = 0; i < rays.size(); ++i) EXPECT_FALSE(RayFrame(rays[i]).is_valid) << "ray " << i;
    EXPECT_TRUE(RayFrame(Ray{{0, 0, 1}, {0, 0, -1}}).is_valid);
    EXPECT_TRUE(RayFrame(Ray{{0, 0, 1}, {1e-30f, 0, 0}}).is_valid);
}

TEST(Triangle, SignsOfZeroInTheDirectionDoNotMatter) {
    Rng rng(35);
    for (int i = 0; i < 20000; ++i) {
        const int axis = int(rng.below(3));
        const float sign = random_sign(rng);
        // Whole coordinates: edges and corners are met exactly, and often.
        Triangle triangle;
        for (glm::vec3* corner : {&triangle.a, &triangle.b, &triangle.c}) {
            *corner = glm::vec3(int(rng.below(5)) - 2, int(rng.below(5)) - 2, int(rng.below(5)) - 2);
            (*corner)[axis] += 10.0f * sign;
        }
        glm::vec3 origin(int(rng.below(5)) - 2, int(rng.below(5)) - 2, int(rng.below(5)) - 2);
        origin[axis] = 0.0f;
        bool first = false;
        TriangleHit first_hit;
        for (int signs = 0; signs < 4; ++signs) {
            glm::vec3 direction(0.0f);
            direction[axis] = sign;
            direction[(axis + 1) % 3] = signs & 1 ? -0.0f : 0.0f;
            direction[(axis + 2) % 3] = signs & 2 ? -0.0f : 0.0f;
            TriangleHit hit;
            const bool is_hit = shoot({origin, direction}, triangle, &hit);
            if (signs == 0) {
                first = is_hit;
                first_hit = hit;
            }
            ASSERT_EQ(is_hit, first) << "round " << i;
            if (is_hit) {
                ASSERT_EQ(hit.t, first_hit.t);
                ASSERT_EQ(hit.u, first_hit.u);
                ASSERT_EQ(hit.v, first_hit.v);
            }
        }
    }
}

TEST(Triangle, AxisParallelRaysHitEdgesAndCornersOfAGrid) {
    // A square of two triangles in each axis plane; rays along the axis at every half step hit at least one of the two.
    for (int axis = 0; axis < 3; ++axis) {
        for (const float sign : {-1.0f, 1.0f}) {
            const auto at = [&](float x, float y) {
                glm::vec3 p(0.0f);
                p[axis] = 7.0f * sign;
                p[(axis + 1) % 3] = x;
                p[(axis + 2) % 3] = y;
                return p;
            };
            const Triangle lower{at(0, 0), at(2, 0), at(2, 2), 0}, upper{at(0, 0), at(2, 2), at(0, 2), 1};
            for (int x = 0; x <= 4; ++x) {
                for (int y = 0; y <= 4; ++y) {
                    Ray ray{at(0.5f * x, 0.5f * y), glm::vec3(0.0f)};
                    ray.origin[axis] = 0.0f;
                    ray.direction[axis] = sign;
                    EXPECT_TRUE(shoot(ray, lower) || shoot(ray, upper)) << "axis " << axis << ", " << x << ", " << y;
                }
            }
        }
    }
}

TEST(Triangle, ARayThatStartsOnItHitsAtZero) {
    const Triangle triangle{{-1, -1, 4}, {1, -1, 4}, {0, 1, 4}, 0};
    for (const glm::vec3& direction : {glm::vec3(0, 0, 1), glm::vec3(0, 0, -1), glm::vec3(0.3f, -0.2f, 0.5f)}) {
        TriangleHit hit;
        ASSERT_TRUE(shoot({{0, 0, 4}, direction}, triangle, &hit));
        EXPECT_EQ(hit.t, 0.0f);
        Ray ray{{0, 0, 4}, direction};
        ray.t_min = 1e-6f;
        EXPECT_FALSE(shoot(ray, triangle));
        ray = {{0, 0, 4}, direction};
        ray.t_max = 0.0f;
        EXPECT_TRUE(shoot(ray, triangle));
    }
    EXPECT_FALSE(shoot({{0, 0, 4}, {1, 0, 0}}, triangle)) << "in its plane: seen edge on, it has no area";
}

TEST(Triangle, BothEndsOfTheRayAreInclusive) {
    const uint64_t seed = 36;
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Rng rng(seed);
    int count = 0;
    for (int i = 0; i < 50000; ++i) {
        const Triangle triangle{random_point(rng, 1), random_point(rng, 1), random_point(rng, 1), 0};
        Ray ray{random_point(rng, 5.0f), {}};
        ray.direction = (triangle.a + triangle.b + triangle.c) / 3.0f - ray.origin;
        TriangleHit hit, again;
        if (!shoot(ray, triangle, &hit)) continue;
        ++count;
        ray.t_min = ray.t_max = hit.t;
        ASSERT_TRUE(shoot(ray, triangle, &again)) << "round " << i;
        ASSERT_EQ(again.t, hit.t);
        ray.t_min = std::nextafter(hit.t, kInf);
        ray.t_max = kInf;
        ASSERT_FALSE(shoot(ray, triangle)) << "round " << i;
        ray.t_min = 0.0f;
        ray.t_max = std::nextafter(hit.t, 0.0f);
        ASSERT_FALSE(shoot(ray, triangle)) << "round " << i;
    }
    EXPECT_GT(count, 40000);
}

TEST(Triangle, NoHitIsNearerThanTheFloorOrTheEntryIntoItsBox) {
    const uint64_t seed = 37;
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Rng rng(seed);
    for (int i = 0; i < 100000; ++i) {
        const Triangle triangle{random_point(rng, 1), random_point(rng, 1), random_point(rng, 1), 0};
        Ray ray{random_point(rng, 5.0f), {}};
        ray.direction = triangle.a - ray.origin;
        const RayFrame frame(ray);
        TriangleHit hit;
        if (!intersect(frame, triangle, 0.0f, 0.0f, kInf, &hit)) continue;
        const Aabb box = bounds(triangle);
        ASSERT_GE(hit.t, entry(frame, box.lo, box.hi, kInf)) << "round " << i;
        const float floor = hit.t * 1.5f;
        TriangleHit lifted;
        ASSERT_TRUE(intersect(frame, triangle, floor, 0.0f, kInf, &lifted));
        ASSERT_EQ(lifted.t, floor);
        ASSERT_FALSE(intersect(frame, triangle, floor, 0.0f, std::nextafter(floor, 0.0f), &lifted));
    }
}

/// Rays through points of an edge that two triangles share, or of a corner that a fan shares: one of them is hit.
TEST(Triangle, EdgesAndCornersOfAFanLetNothingThrough) {
    const uint64_t seed = 38;
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Rng rng(seed);
    constexpr int kBlades = 6;
    for (int i = 0; i < 100000; ++i) {
        // A fan about `hub`, somewhat bent, that faces -z and is seen from +z.
        const float size = log_uniform(rng, 1e-6, 1e6);
        const glm::vec3 hub = random_point(rng, size * log_uniform(rng, 1.0, 100.0));
        std::array<glm::vec3, kBlades> rim;
        for (int k = 0; k < kBlades; ++k) {
            const float angle = (k + rng.uniform(-0.3f, 0.3f)) * 6.2831853f / kBlades;
            const float radius = size * rng.uniform(0.5f, 1.0f);
            rim[k] = hub + glm::vec3(radius * std::cos(angle), radius * std::sin(angle), size * rng.uniform(-0.2f, 0.2f));
        }
        Ray ray;
        ray.origin = hub + glm::vec3(size * rng.uniform(-2.0f, 2.0f), size * rng.uniform(-2.0f, 2.0f), size * 8.0f);
        const glm::vec3 target = i % 4 == 0 ? hub : glm::mix(hub, rim[rng.below(kBlades)], rng.uniform(0.0f, 0.6f));
        ray.direction = target - ray.origin;
        bool is_hit = false;
        for (int k = 0; k < kBlades; ++k) {
            // Corners in any order, as meshes have them.
            const glm::vec3 other = rim[(k + 1) % kBlades];
            const Triangle turned[3] = {{hub, rim[k], other, 0}, {rim[k], other, hub, 0}, {other, hub, rim[k], 0}};
            is_hit |= shoot(ray, turned[rng.below(3)]);
        }
        ASSERT_TRUE(is_hit) << "round " << i << ", size " << size;
    }
}

}  // namespace
}  // namespace zoe::test
