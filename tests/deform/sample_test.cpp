#include "engine/deform/sample.h"

#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/deform/samplers.h"
#include "tests/math/random_inputs.h"

namespace zoe::test {
namespace {

constexpr float kHalf = 0.70710678f;  // sin and cos of an eighth turn.

void expect_near(const Values& actual, const Values& expected, double bound, const char* what = "") {
    ASSERT_EQ(actual.size(), expected.size());
    for (size_t k = 0; k < actual.size(); ++k) EXPECT_NEAR(actual[k], expected[k], bound) << what << ", value " << k;
}

TEST(Sample, StepHoldsAKeyUntilTheNext) {
    const Sampler s = of(Interpolation::kStep, 1, {1, 2, 4}, {10, 20, 40});
    EXPECT_EQ(at(s, -5), Values{10});
    EXPECT_EQ(at(s, 1), Values{10});
    EXPECT_EQ(at(s, std::nextafter(2.0, 0.0)), Values{10});
    EXPECT_EQ(at(s, 2), Values{20}) << "the exact time of a key is already its";
    EXPECT_EQ(at(s, 3.999), Values{20});
    EXPECT_EQ(at(s, 4), Values{40});
    EXPECT_EQ(at(s, 1e9), Values{40});
}

TEST(Sample, LinearIsOnTheLineBetweenKeys) {
    const Sampler s = of(Interpolation::kLinear, 3, {1, 3}, {0, 10, -4, 8, 20, 4});
    EXPECT_EQ(at(s, 0), (Values{0, 10, -4}));
    EXPECT_EQ(at(s, 1), (Values{0, 10, -4}));
    EXPECT_EQ(at(s, 1.5), (Values{2, 12.5, -2}));
    EXPECT_EQ(at(s, 2), (Values{4, 15, 0}));
    EXPECT_EQ(at(s, 3), (Values{8, 20, 4}));
    EXPECT_EQ(at(s, 4), (Values{8, 20, 4}));
}

TEST(Sample, CubicSplineIsTheHermiteCurveWithTangentsTimesTheInterval) {
    // in, value, out a key; two seconds apart. By hand at the middle: (1 + 5) / 2 + 2 * (3 - -1) / 8.
    const Sampler s = of(Interpolation::kCubicSpline, 1, {1, 3}, {99, 1, 3, -1, 5, 99});
    EXPECT_EQ(at(s, 1), Values{1});
    EXPECT_EQ(at(s, 3), Values{5});
    EXPECT_EQ(at(s, 2), Values{4});
    EXPECT_EQ(at(s, 0), Values{1}) << "before the first key: its value, not its tangent";
    EXPECT_EQ(at(s, 9), Values{5});
    // A quarter of the way: h00 = 27/32, h10 = 9/64, h01 = 5/32, h11 = -3/64.
    expect_near(at(s, 1.5), {27.0f / 32 * 1 + 2 * 9.0f / 64 * 3 + 5.0f / 32 * 5 + 2 * -3.0f / 64 * -1}, 1e-6);
}

TEST(Sample, CubicSplineOfWeightsKeepsItsWidth) {
    // Three weights: a key holds nine floats.
    const Sampler s =
        of(Interpolation::kCubicSpline, 3, {0, 1}, {0, 0, 0, 1, 2, 3, 0, 0, 0, /* key 1 */ 0, 0, 0, 3, 6, 9, 0, 0, 0});
    EXPECT_EQ(at(s, 0), (Values{1, 2, 3}));
    expect_near(at(s, 0.5), {2, 4, 6}, 1e-6);
    EXPECT_EQ(at(s, 1), (Values{3, 6, 9}));
}

TEST(Sample, ASingleKeyHoldsForEver) {
    for (const double t : {-1.0, 0.0, 2.0, 100.0}) {
        EXPECT_EQ(at(of(Interpolation::kStep, 2, {2}, {3, 4}), t), (Values{3, 4}));
        EXPECT_EQ(at(of(Interpolation::kLinear, 2, {2}, {3, 4}), t), (Values{3, 4}));
        EXPECT_EQ(at(of(Interpolation::kCubicSpline, 2, {2}, {9, 9, 3, 4, 9, 9}), t), (Values{3, 4}));
    }
}

TEST(Sample, ExactKeysGiveTheirValuesToTheLastBit) {
    Rng rng(151);
    for (const Interpolation interpolation : {Interpolation::kStep, Interpolation::kLinear, Interpolation::kCubicSpline}) {
        Sampler s = of(interpolation, 3, {}, {});
        float time = 0.1f;
        const int stride = interpolation == Interpolation::kCubicSpline ? 9 : 3;
        for (int key = 0; key < 100; ++key) {
            s.times_s.push_back(time);
            time += rng.uniform(0.01f, 0.1f);
            for (int k = 0; k < stride; ++k) s.values.push_back(rng.uniform(-1, 1));
        }
        for (int key = 0; key < 100; ++key) {
            const float* value = &s.values[key * stride + (stride == 9 ? 3 : 0)];
            EXPECT_EQ(at(s, s.times_s[key]), Values(value, value + 3)) << "key " << key;
        }
    }
}

TEST(Sample, OfEqualTimesTheLaterKeyHoldsFromThatTimeOn) {
    for (const Interpolation interpolation : {Interpolation::kStep, Interpolation::kLinear}) {
        const Sampler s = of(interpolation, 1, {0, 1, 1, 2}, {0, 10, 50, 60});
        EXPECT_EQ(at(s, 1), Values{50});
        EXPECT_NEAR(at(s, 1 - 1e-9)[0], interpolation == Interpolation::kStep ? 0 : 10, 1e-6);
        EXPECT_NEAR(at(s, 1.5)[0], interpolation == Interpolation::kStep ? 50 : 55, 1e-6);
        const Sampler thrice = of(interpolation, 1, {0, 0, 0, 1}, {1, 2, 3, 3});
        EXPECT_EQ(at(thrice, 0), Values{3});
        EXPECT_EQ(at(thrice, -1), Values{1});
        EXPECT_EQ(at(thrice, 0.5), Values{3});
        const Sampler at_the_end = of(interpolation, 1, {0, 1, 1}, {1, 1, 7});
        EXPECT_EQ(at(at_the_end, 1), Values{7});
        EXPECT_EQ(at(at_the_end, 5), Values{7});
        const Sampler all = of(interpolation, 1, {3, 3, 3}, {1, 2, 4});
        EXPECT_EQ(at(all, 3), Values{4});
    }
    const Sampler cubic = of(Interpolation::kCubicSpline, 1, {0, 1, 1, 2}, {0, 0, 0, 0, 10, 5, 5, 50, 0, 0, 60, 0});
    EXPECT_EQ(at(cubic, 1), Values{50});
    EXPECT_TRUE(std::isfinite(at(cubic, 1 - 1e-12)[0]));
}

TEST(Sample, RotationsGoTheShortWay) {
    // Identity to a quarter turn about z; half way is an eighth turn, whichever sign the second key has.
    const float c = std::cos(0.39269908f), s = std::sin(0.39269908f);
    for (const float sign : {1.0f, -1.0f}) {
        const Sampler r = of(Interpolation::kLinear, 4, {0, 1}, {0, 0, 0, 1, 0, 0, sign * kHalf, sign * kHalf}, true);
        expect_near(at(r, 0.5), {0, 0, s, c}, 1e-6, "half way");
        const float third = 0.26179939f;
        expect_near(at(r, 1.0 / 3.0), {0, 0, std::sin(third), std::cos(third)}, 1e-6, "a third");
    }
}

TEST(Sample, RotationsBetweenQAndMinusQStandStill) {
    const Sampler r = of(Interpolation::kLinear, 4, {0, 1}, {0.5f, 0.5f, 0.5f, 0.5f, -0.5f, -0.5f, -0.5f, -0.5f}, true);
    for (const double t : {0.0, 0.25, 0.5, 0.75}) expect_near(at(r, t), {0.5f, 0.5f, 0.5f, 0.5f}, 1e-6);
}

TEST(Sample, RotationsByHalfATurnGoThroughAQuarterTurn) {
    const Sampler r = of(Interpolation::kLinear, 4, {0, 1}, {0, 0, 0, 1, 1, 0, 0, 0}, true);
    expect_near(at(r, 0.5), {kHalf, 0, 0, kHalf}, 1e-6);
    const Sampler nearly = of(Interpolation::kLinear, 4, {0, 1}, {0, 0, 0, 1, 1, 0, 0, -1e-7f}, true);
    for (const double t : {0.1, 0.5, 0.9}) {
        for (const float x : at(nearly, t)) EXPECT_TRUE(std::isfinite(x));
    }
}

TEST(Sample, NearlyParallelRotationsStayUnitLengthAndBetweenTheKeys) {
    for (double angle = 1e-9; angle < 0.5; angle *= 3.0) {
        const auto sine = static_cast<float>(std::sin(angle)), cosine = static_cast<float>(std::cos(angle));
        const Sampler r = of(Interpolation::kLinear, 4, {0, 1}, {0, 0, 0, 1, sine, 0, 0, cosine}, true);
        for (const double t : {0.1, 0.5, 0.7}) {
            const Values q = at(r, t);
            EXPECT_NEAR(q[0], std::sin(t * angle), 1e-6) << "angle " << angle << ", t " << t;
            EXPECT_NEAR(q[0] * q[0] + q[3] * q[3], 1.0, 1e-6);
        }
    }
}

TEST(Sample, SplinesOfRotationsAreRenormalised) {
    // Tangents that are zero: half way is (q0 + q1) / 2, too short by itself.
    const Sampler r = of(Interpolation::kCubicSpline, 4, {0, 1},
                         {0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, /* key 1 */ 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0}, true);
    expect_near(at(r, 0.5), {0, 0, kHalf, kHalf}, 1e-6);
    for (double t = 0; t <= 1.0; t += 0.05) {
        const Values q = at(r, t);
        EXPECT_NEAR(std::hypot(q[2], q[3]), 1.0, 1e-6) << t;
    }
}

TEST(Sample, RotationKeysThatAreNotUnitLengthComeOutNormalised) {
    for (const Interpolation interpolation : {Interpolation::kStep, Interpolation::kLinear}) {
        const Sampler r = of(interpolation, 4, {0, 1}, {0, 0, 0, 2, 0, 0, 0.5f, 0}, true);
        for (const double t : {-1.0, 0.0, 0.3, 1.0, 2.0}) {
            const Values q = at(r, t);
            EXPECT_NEAR(std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]), 1.0, 1e-6) << t;
        }
    }
}

/// The same from the specification's formulas, in double, by a linear search.
std::vector<double> reference(const Sampler& s, double t) {
    const size_t w = s.width, n = s.times_s.size();
    const bool is_cubic = s.interpolation == Interpolation::kCubicSpline;
    const auto value = [&](size_t key, size_t k) {
        return double{s.values[is_cubic ? (3 * key + 1) * w + k : key * w + k]};
    };
    size_t key = 0;
    for (size_t k = 0; k < n; ++k) {
        if (s.times_s[k] <= t) key = k;
    }
    std::vector<double> out(w);
    if (t <= s.times_s[0] || key + 1 == n || s.interpolation == Interpolation::kStep) {
        for (size_t k = 0; k < w; ++k) out[k] = value(key, k);
    } else {
        const double dt = double{s.times_s[key + 1]} - double{s.times_s[key]}, u = (t - s.times_s[key]) / dt;
        double dot = 0.0;
        for (size_t k = 0; k < w; ++k) dot += value(key, k) * value(key + 1, k);
        const double angle = std::acos(std::min(1.0, std::abs(dot)));
        for (size_t k = 0; k < w; ++k) {
            const double a = value(key, k), b = value(key + 1, k);
            if (is_cubic) {
                const double out_tangent = s.values[(3 * key + 2) * w + k], in_tangent = s.values[3 * (key + 1) * w + k];
                out[k] = (2 * u * u * u - 3 * u * u + 1) * a + dt * (u * u * u - 2 * u * u + u) * out_tangent +
                         (-2 * u * u * u + 3 * u * u) * b + dt * (u * u * u - u * u) * in_tangent;
            } else if (s.is_rotation && angle > 1e-9) {
                out[k] = std::sin((1 - u) * angle) / std::sin(angle) * a +
                         (dot < 0 ? -1 : 1) * std::sin(u * angle) / std::sin(angle) * b;
            } else {
                out[k] = a + u * (b - a);
            }
        }
    }
    if (s.is_rotation) {
        double length = 0.0;
        for (const double x : out) length += x * x;
        for (double& x : out) x /= std::sqrt(length);
    }
    return out;
}

TEST(Sample, AgreesWithDoubleOnRandomSamplers) {
    const uint64_t seed = 152;
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Rng rng(seed);
    for (int round = 0; round < 2000; ++round) {
        Sampler s;
        s.interpolation = static_cast<Interpolation>(rng.below(3));
        s.is_rotation = rng.below(2) == 1;
        s.width = s.is_rotation ? 4 : 1 + rng.below(12);
        const uint32_t keys = 1 + rng.below(20);
        float time = rng.uniform(-1.0f, 1.0f);
        for (uint32_t key = 0; key < keys; ++key) {
            s.times_s.push_back(time);
            if (rng.below(8) > 0) time += log_uniform(rng, 1e-3, 1.0);
            for (int part = 0; part < (s.interpolation == Interpolation::kCubicSpline ? 3 : 1); ++part) {
                if (s.is_rotation) {
                    const glm::quat q = random_rotation(rng);
                    s.values.insert(s.values.end(), {q.x, q.y, q.z, q.w});
                } else {
                    for (uint32_t k = 0; k < s.width; ++k) s.values.push_back(rng.uniform(-2.0f, 2.0f));
                }
            }
        }
        for (int k = 0; k < 40; ++k) {
            const double t = k % 4 == 0 ? double{s.times_s[rng.below(keys)]}
                                        : double{rng.uniform(s.times_s.front() - 0.5f, s.times_s.back() + 0.5f)};
            const std::vector<double> expected = reference(s, t);
            const Values actual = at(s, t);
            // A spline of rotations may pass near 0, where normalising magnifies its rounding.
            const bool is_wild = s.is_rotation && s.interpolation == Interpolation::kCubicSpline;
            for (uint32_t c = 0; c < s.width; ++c) {
                ASSERT_NEAR(actual[c], expected[c], is_wild ? 2e-4 : 4e-6) << "round " << round << ", time " << t;
            }
        }
    }
}

}  // namespace
}  // namespace zoe::test
