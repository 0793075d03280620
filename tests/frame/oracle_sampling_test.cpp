// How the oracle transforms and plays, against values worked out by hand.

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "tests/support/affine_double.h"
#include "tests/support/gltf_animation.h"

namespace zoe::test {
namespace {

void expect_near(const glm::dvec3& a, const glm::dvec3& b, double tolerance = 1e-12) {
    EXPECT_TRUE(glm::length(a - b) <= tolerance)
        << "(" << a.x << ", " << a.y << ", " << a.z << ") is not (" << b.x << ", " << b.y << ", " << b.z << ")";
}

DocumentChannel channel(const std::string& path, const std::string& interpolation, std::vector<double> times,
                        std::vector<double> values, uint32_t width) {
    return {.node = 0, .path = path, .interpolation = interpolation, .width = width, .times_s = times, .values = values};
}

TEST(OracleTransform, ScalesThenRotatesThenMoves) {
    const double h = std::sqrt(0.5);
    const AffineDouble m = from_trs({1, 2, 3}, {0, 0, h, h}, {2, 3, 4});
    expect_near(m.point({1, 1, 1}), {-2, 4, 7});
    expect_near((m * m).point({1, 1, 1}), m.point(m.point({1, 1, 1})));
    expect_near(from_columns({1, 2, 3, 0, 4, 5, 6, 0, 7, 8, 10, 0, 11, 12, 13, 1}).point({1, 10, 100}), {752, 864, 1076});
}

TEST(OracleSampling, StepHoldsLinearBlends) {
    const DocumentChannel step = channel("translation", "STEP", {1, 2, 4}, {0, 0, 0, 1, 2, 3, 5, 5, 5}, 3);
    EXPECT_EQ(sample_channel(step, 0.0), (std::vector<double>{0, 0, 0}));
    EXPECT_EQ(sample_channel(step, 1.999), (std::vector<double>{0, 0, 0}));
    EXPECT_EQ(sample_channel(step, 2.0), (std::vector<double>{1, 2, 3}));
    EXPECT_EQ(sample_channel(step, 9.0), (std::vector<double>{5, 5, 5}));
    const DocumentChannel linear = channel("weights", "LINEAR", {1, 2, 4}, {0, 1, 4, 1, 6, 3}, 2);
    EXPECT_EQ(sample_channel(linear, 0.5), (std::vector<double>{0, 1}));
    EXPECT_EQ(sample_channel(linear, 1.25), (std::vector<double>{1, 1}));
    EXPECT_EQ(sample_channel(linear, 2.0), (std::vector<double>{4, 1}));
    EXPECT_EQ(sample_channel(linear, 3.0), (std::vector<double>{5, 2}));
    EXPECT_EQ(sample_channel(linear, 4.0), (std::vector<double>{6, 3}));
}

TEST(OracleSampling, SplineUsesTangentsTimesTheInterval) {
    // In-tangent, value, out-tangent: 0 with slope 1 outwards, 1 with slope -1 inwards, two seconds apart.
    // Half way: 0.5 * 0 + 2 * 0.125 * 1 + 0.5 * 1 - 2 * 0.125 * -1 = 1.
    const DocumentChannel spline = channel("weights", "CUBICSPLINE", {1, 3}, {9, 0, 1, -1, 1, 9}, 1);
    EXPECT_DOUBLE_EQ(sample_channel(spline, 2.0)[0], 1.0);
    EXPECT_DOUBLE_EQ(sample_channel(spline, 0.0)[0], 0.0);
    EXPECT_DOUBLE_EQ(sample_channel(spline, 1.0)[0], 0.0);
    EXPECT_DOUBLE_EQ(sample_channel(spline, 3.0)[0], 1.0);
}

TEST(OracleSampling, RotationsTakeTheShortWayAtConstantSpeed) {
    const double h = std::sqrt(0.5);
    for (const double sign : {1.0, -1.0}) {
        const DocumentChannel turn = channel("rotation", "LINEAR", {0, 3}, {0, 0, 0, 1, 0, 0, sign * h, sign * h}, 4);
        const std::vector<double> q = sample_channel(turn, 1.0);
        EXPECT_NEAR(std::abs(q[3]), std::cos(15.0 * M_PI / 180), 1e-12);
        EXPECT_NEAR(q[2] * q[3], 0.25, 1e-12);  // sin 15 cos 15 = sin(30) / 2
    }
    const DocumentChannel still = channel("rotation", "LINEAR", {0, 1}, {0, 0, 0, 2, 0, 0, 0, -3}, 4);
    EXPECT_EQ(sample_channel(still, 0.5), (std::vector<double>{0, 0, 0, 1}));
    const DocumentChannel spline = channel("rotation", "CUBICSPLINE", {0, 1},
                                           {0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0}, 4);
    const std::vector<double> q = sample_channel(spline, 0.5);
    EXPECT_NEAR(q[0], h, 1e-12);
    EXPECT_NEAR(q[1], h, 1e-12);
}

TEST(OracleSampling, OfEqualTimesTheLaterKeyHolds) {
    const DocumentChannel jump = channel("weights", "LINEAR", {0, 1, 1, 2}, {0, 1, 5, 6}, 1);
    EXPECT_DOUBLE_EQ(sample_channel(jump, 0.5)[0], 0.5);
    EXPECT_DOUBLE_EQ(sample_channel(jump, 1.0)[0], 5.0);
    EXPECT_DOUBLE_EQ(sample_channel(jump, 1.5)[0], 5.5);
    const DocumentChannel end = channel("weights", "LINEAR", {0, 1, 1}, {0, 1, 5}, 1);
    EXPECT_DOUBLE_EQ(sample_channel(end, 1.0)[0], 5.0);
}

TEST(OracleSampling, TimeLoopsByTheClip) {
    const DocumentClip clip{.name = "", .channels = {}, .duration_s = 2.0};
    EXPECT_DOUBLE_EQ(clip_time_s(clip, 4.5, true), 0.5);
    EXPECT_DOUBLE_EQ(clip_time_s(clip, 2.0, true), 0.0);
    EXPECT_DOUBLE_EQ(clip_time_s(clip, -0.5, true), 1.5);
    EXPECT_DOUBLE_EQ(clip_time_s(clip, 4.5, false), 4.5);
    EXPECT_DOUBLE_EQ(clip_time_s(DocumentClip{}, 4.5, true), 4.5);
}

}  // namespace
}  // namespace zoe::test
