#include <array>
#include <limits>

#include <gtest/gtest.h>

#include "engine/math/triangle.h"
#include "tests/math/random_inputs.h"

namespace zoe::test {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr float kMax = std::numeric_limits<float>::max();
constexpr float kDenormal = std::numeric_limits<float>::denorm_min();

float enter(const Ray& ray, const Aabb& box, float t_max = kInf) {
    return entry(RayFrame(ray), box.lo, box.hi, t_max);
}

/// Coordinates and directions that slab tests stumble over.
constexpr std::array<float, 16> kOdd = {0.0f, -0.0f, kDenormal, -kDenormal, 1e-38f, -1e-38f, 1e-30f, -1e-30f,
                                        1.0f, -1.0f, 3.0f,      -0.5f,      1e18f,  -1e18f,  kMax,   -kMax};

float random_odd(Rng& rng) {
    return rng.below(2) ? kOdd[rng.below(kOdd.size())] : rng.uniform(-2.0f, 2.0f);
}
glm::vec3 random_odd_point(Rng& rng) {
    const float x = random_odd(rng), y = random_odd(rng), z = random_odd(rng);
    return {x, y, z};
}

Aabb random_odd_box(Rng& rng) {
    Aabb box;
    box.extend(random_odd_point(rng));
    if (rng.below(4) > 0) box.extend(random_odd_point(rng));
    return box;
}

TEST(Entry, HandComputedCases) {
    const Aabb box{{-1, -1, -1}, {1, 1, 1}};
    EXPECT_NEAR(enter({{0, 0, 5}, {0, 0, -1}}, box), 4.0f, 4e-6f);
    EXPECT_LE(enter({{0, 0, 5}, {0, 0, -1}}, box), 4.0f) << "padded towards the ray, never away";
    EXPECT_NEAR(enter({{0, 0, 5}, {0, 0, -2}}, box), 2.0f, 4e-6f) << "t counts in lengths of the direction";
    EXPECT_EQ(enter({{0, 0, 0}, {1, 2, 3}}, box), 0.0f) << "starts inside";
    EXPECT_EQ(enter({{0, 0, 5}, {0, 0, 1}}, box), kInf) << "behind";
    EXPECT_EQ(enter({{2, 0, 5}, {0, 0, -1}}, box), kInf) << "beside";
    EXPECT_EQ(enter({{0, 0, 5}, {0, 0, -1}}, box, 3.9f), kInf) << "too far";
    EXPECT_NEAR(enter({{0, 0, 5}, {0, 0, -1}}, box, 4.0f), 4.0f, 4e-6f) << "the far end is inclusive";
}

TEST(Entry, AxisParallelRaysOnASlabEnterTheBox) {
    const Aabb box{{-1, -1, -1}, {1, 1, 1}};
    for (const float zero : {0.0f, -0.0f}) {
        for (const float x : {-1.0f, 1.0f}) {
            EXPECT_NEAR(enter({{x, 0, 5}, {zero, zero, -1}}, box), 4.0f, 4e-6f) << "on a face";
            EXPECT_NEAR(enter({{x, x, 5}, {zero, zero, -1}}, box), 4.0f, 4e-6f) << "on an edge";
            EXPECT_EQ(enter({{1.001f * x, 0, 5}, {zero, zero, -1}}, box), kInf) << "just beside";
        }
    }
}

TEST(Entry, FlatBoxesAndSinglePointsAreEntered) {
    const Aabb flat{{-1, -1, 2}, {1, 1, 2}};
    EXPECT_NEAR(enter({{0.3f, 0.2f, 5}, {0, 0, -1}}, flat), 3.0f, 4e-6f);
    EXPECT_NEAR(enter({{-5, 0, 2}, {1, 0, 0}}, flat), 4.0f, 4e-6f) << "along it, in its plane";
    const Aabb point{{1, 2, 3}, {1, 2, 3}};
    EXPECT_NEAR(enter({{0, 0, 0}, {1, 2, 3}}, point), 1.0f, 4e-6f);
    EXPECT_EQ(enter({{1, 2, 3}, {0, 1, 0}}, point), 0.0f);
}

TEST(Entry, IsNeverNan) {
    const uint64_t seed = 41;
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Rng rng(seed);
    for (int i = 0; i < 1000000; ++i) {
        Ray ray{random_odd_point(rng), random_odd_point(rng)};
        const RayFrame frame(ray);
        const Aabb box = random_odd_box(rng);
        const float t = entry(frame, box.lo, box.hi, rng.below(2) ? kInf : 1.0f);
        ASSERT_FALSE(std::isnan(t)) << "round " << i;
        ASSERT_GE(t, 0.0f) << "round " << i;
    }
}

TEST(Entry, IsMonotoneInBoxNestingToTheLastBit) {
    const uint64_t seed = 42;
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Rng rng(seed);
    int entered = 0;
    for (int i = 0; i < 1000000; ++i) {
        const bool is_odd = i % 2;
        const Aabb inner = is_odd ? random_odd_box(rng) : [&] {
            Aabb box;
            box.extend(random_point(rng, 2.0f));
            box.extend(random_point(rng, 2.0f));
            return box;
        }();
        Aabb outer = inner;
        for (int axis = 0; axis < 3; ++axis) {
            const int how = int(rng.below(4));  // Unchanged, by one ulp, somewhat, very much.
            if (how == 1) outer.lo[axis] = std::nextafter(outer.lo[axis], -kMax);
            if (how == 2) outer.lo[axis] -= rng.uniform();
            if (how == 3) outer.lo[axis] = std::min(outer.lo[axis], -1e30f);
            if (how == 1) outer.hi[axis] = std::nextafter(outer.hi[axis], kMax);
            if (how == 2) outer.hi[axis] += rng.uniform();
            if (how == 3) outer.hi[axis] = std::max(outer.hi[axis], 1e30f);
        }
        ASSERT_TRUE(outer.contains(inner));
        Ray ray;
        ray.origin = is_odd ? random_odd_point(rng) : random_point(rng, 4.0f);
        ray.direction = is_odd ? random_odd_point(rng) : random_direction(rng);
        const RayFrame frame(ray);
        const float t_max = rng.below(2) ? kInf : rng.uniform(0.0f, 8.0f);
        const float outside = entry(frame, outer.lo, outer.hi, t_max), inside = entry(frame, inner.lo, inner.hi, t_max);
        ASSERT_LE(outside, inside) << "round " << i;
        entered += inside < kInf;
    }
    EXPECT_GT(entered, 30000);
}

TEST(Entry, IsConservativeAgainstTheExactInterval) {
    const uint64_t seed = 43;
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Rng rng(seed);
    int entered = 0;
    for (int i = 0; i < 500000; ++i) {
        Aabb box;
        const float size = log_uniform(rng, 1e-6, 1e6);
        const glm::vec3 place = random_point(rng, size * log_uniform(rng, 0.1, 1e3));
        box.extend(place + random_point(rng, size));
        box.extend(place + random_point(rng, size));
        Ray ray;
        ray.origin = random_point(rng, size * 10.0f);
        // Through a corner half of the time: the interval is then a point or nearly so.
        const glm::vec3 corner{rng.below(2) ? box.lo.x : box.hi.x, rng.below(2) ? box.lo.y : box.hi.y,
                               rng.below(2) ? box.lo.z : box.hi.z};
        ray.direction = (i % 2 ? corner : place + random_point(rng, size)) - ray.origin;
        long double in = 0.0L, out = std::numeric_limits<long double>::infinity();
        bool is_parallel = false;
        for (int axis = 0; axis < 3; ++axis) {
            const long double o = ray.origin[axis], d = ray.direction[axis];
            is_parallel |= d == 0.0L;
            const long double t0 = (box.lo[axis] - o) / d, t1 = (box.hi[axis] - o) / d;
            in = std::max(in, std::min(t0, t1));
            out = std::min(out, std::max(t0, t1));
        }
        if (is_parallel || !(in <= out)) continue;
        ++entered;
        const float t = enter(ray, box);
        ASSERT_LE(t, in) << "round " << i;
        ASSERT_GE(t, in * (1.0L - 2e-6L)) << "round " << i;
    }
    EXPECT_GT(entered, 100000);
}

}  // namespace
}  // namespace zoe::test
