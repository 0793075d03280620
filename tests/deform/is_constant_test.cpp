#include <cmath>
#include <utility>

#include <gtest/gtest.h>

#include "engine/deform/sample.h"
#include "engine/math/rng.h"
#include "tests/deform/samplers.h"

namespace zoe::test {
namespace {

TEST(IsConstant, WhereAllKeysAreEqual) {
    for (const Interpolation interpolation : {Interpolation::kStep, Interpolation::kLinear}) {
        EXPECT_TRUE(is_constant(of(interpolation, 2, {0, 1, 2}, {1, 2, 1, 2, 1, 2})));
        EXPECT_FALSE(is_constant(of(interpolation, 2, {0, 1, 2}, {1, 2, 1, 2, 1, 3})));
        EXPECT_FALSE(is_constant(of(interpolation, 2, {0, 1}, {1, 2, 1, std::nextafter(2.0f, 3.0f)})));
        EXPECT_TRUE(is_constant(of(interpolation, 1, {5}, {7})));
    }
}

TEST(IsConstant, SplinesNeedTangentsOfZeroToo) {
    EXPECT_TRUE(is_constant(of(Interpolation::kCubicSpline, 1, {0, 1}, {0, 5, 0, 0, 5, 0})));
    EXPECT_FALSE(is_constant(of(Interpolation::kCubicSpline, 1, {0, 1}, {0, 5, 1, 0, 5, 0}))) << "out-tangent";
    EXPECT_FALSE(is_constant(of(Interpolation::kCubicSpline, 1, {0, 1}, {0, 5, 0, 1, 5, 0}))) << "in-tangent";
    EXPECT_FALSE(is_constant(of(Interpolation::kCubicSpline, 1, {0, 1}, {0, 5, 0, 0, 6, 0})));
    EXPECT_TRUE(is_constant(of(Interpolation::kCubicSpline, 1, {2}, {3, 5, 4}))) << "a single key plays no tangent";
}

TEST(IsConstant, RotationsThatAreOppositeQuaternionsAreOne) {
    const Values flipped = {0, 0, 0.6f, 0.8f, 0, 0, -0.6f, -0.8f};
    EXPECT_TRUE(is_constant(of(Interpolation::kLinear, 4, {0, 1}, flipped, true)));
    EXPECT_FALSE(is_constant(of(Interpolation::kLinear, 4, {0, 1}, flipped, false))) << "not as plain numbers";
    EXPECT_FALSE(
        is_constant(of(Interpolation::kCubicSpline, 4, {0, 1},
                       {0, 0, 0, 0, 0, 0, 0.6f, 0.8f, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, -0.6f, -0.8f, 0, 0, 0, 0}, true)))
        << "a spline goes through zero on its way";
}

TEST(IsConstant, SaysNothingThatSampleContradicts) {
    const uint64_t seed = 153;
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Rng rng(seed);
    int constant = 0;
    for (int round = 0; round < 3000; ++round) {
        Sampler s;
        s.interpolation = static_cast<Interpolation>(rng.below(3));
        s.width = 1 + rng.below(2);
        const int parts = s.interpolation == Interpolation::kCubicSpline ? 3 : 1;
        const uint32_t keys = 1 + rng.below(3);
        for (uint32_t key = 0; key < keys; ++key) {
            s.times_s.push_back(float(key));
            for (int k = 0; k < parts * int(s.width); ++k) s.values.push_back(rng.below(4) == 0 ? 1.0f : 0.0f);
        }
        bool moves = false;
        const Values first = at(s, -1.0);
        for (double t = -0.5; t < keys + 0.5; t += 0.0625) moves |= at(s, t) != first;
        EXPECT_EQ(is_constant(s), !moves) << "round " << round;
        constant += is_constant(s);
    }
    EXPECT_GT(constant, 100);
}

}  // namespace
}  // namespace zoe::test
