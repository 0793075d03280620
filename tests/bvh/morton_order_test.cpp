// The order of boxes along the Z curve.

#include "engine/bvh/morton_order.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <gtest/gtest.h>

#include "engine/math/parallel.h"
#include "tests/math/random_inputs.h"
#include "tests/support/allocation_count.h"

namespace zoe::test {
namespace {

using Order = std::vector<uint32_t>;

Order morton(const std::vector<Aabb>& boxes) {
    Order order;
    MortonScratch scratch;
    morton_order(boxes, &order, &scratch);
    return order;
}

Aabb point(const glm::vec3& at) {
    return {at, at};
}

// On a line, the curve is the line.
Order along(const std::vector<float>& xs, int axis) {
    std::vector<Aabb> boxes;
    for (const float x : xs) {
        glm::vec3 at(7.0f);
        at[axis] = x;
        boxes.push_back(point(at));
    }
    return morton(boxes);
}

Order sorted(const std::vector<float>& xs) {
    Order order(xs.size());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return xs[a] < xs[b]; });
    return order;
}

TEST(MortonOrder, TellsApartPointsOfAllMagnitudes) {
    Rng rng(500);
    std::vector<float> xs;
    for (int power = -120; power <= 127; ++power) {
        for (int k = 0; k < 100; ++k) xs.push_back(std::ldexp(rng.uniform(-1.0f, 1.0f), power));
    }
    for (size_t k = xs.size(); k > 1; --k) std::swap(xs[k - 1], xs[rng.below(uint32_t(k))]);
    for (int axis = 0; axis < 3; ++axis) {
        EXPECT_EQ(along(xs, axis), sorted(xs)) << "axis " << axis << ", seed 500";
    }
}

TEST(MortonOrder, EqualCentresGoByIndexAndBoxesThatAreNoneStandLast) {
    const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
    std::vector<Aabb> boxes;
    for (int k = 0; k < 5; ++k) {
        boxes.insert(boxes.end(), {Aabb{}, point({1, 0, 0}), point({nan, 0, 0}), point({0, 0, 0}), point({1e9f, 1e9f, 1e9f}),
                                   Aabb{{0, 0, 0}, {0, inf, 0}}});
    }
    EXPECT_EQ(morton(boxes), (Order{3, 9, 15, 21, 27, 1,  7,  13, 19, 25, 4,  10, 16, 22, 28,
                                    0, 2, 5,  6,  8,  11, 12, 14, 17, 18, 20, 23, 24, 26, 29}));
    EXPECT_EQ(morton({}), Order{});
    EXPECT_EQ(morton({Aabb{}}), Order{0});
    EXPECT_EQ(morton({Aabb{}, point({1, 2, 3})}), (Order{1, 0}));
}

TEST(MortonOrder, IsTheSameOnAnyNumberOfThreadsAndAllocatesNothingTheSecondTime) {
    Rng rng(510);
    std::vector<Aabb> boxes;
    for (int k = 0; k < 50'000; ++k) boxes.push_back(point(random_point(rng, k % 2 == 0 ? 1.0f : 1e-9f)));
    boxes.push_back(point(glm::vec3(1e18f)));
    set_thread_count(1);
    Order expected;
    MortonScratch scratch;
    morton_order(boxes, &expected, &scratch);
    Order order = expected;
    const size_t before = allocation_count();
    morton_order(boxes, &order, &scratch);
    EXPECT_EQ(allocation_count() - before, 0u);
    EXPECT_EQ(order, expected);
    for (const int threads : {2, 5}) {
        set_thread_count(threads);
        EXPECT_EQ(morton(boxes), expected) << threads << " threads, seed 510";
    }
    set_thread_count(0);
}

}  // namespace
}  // namespace zoe::test
