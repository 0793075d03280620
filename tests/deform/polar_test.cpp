#include "engine/deform/polar.h"

#include <gtest/gtest.h>
#include <glm/matrix.hpp>

#include "tests/math/random_inputs.h"

namespace zoe::test {
namespace {

double difference(const glm::dmat3& a, const glm::dmat3& b) {
    double most = 0.0;
    for (int column = 0; column < 3; ++column) {
        for (int row = 0; row < 3; ++row) {
            const double d = std::abs(a[column][row] - b[column][row]);
            if (!(d <= most)) most = d;
        }
    }
    return most;
}

void expect_rotation(const glm::dmat3& r) {
    EXPECT_LT(difference(glm::transpose(r) * r, glm::dmat3(1.0)), 1e-12);
    EXPECT_NEAR(glm::determinant(r), 1.0, 1e-12);
}

glm::dmat3 rotation_of(Rng& rng) {
    return glm::dmat3(glm::mat3_cast(glm::normalize(glm::dquat(random_rotation(rng)))));
}

TEST(Polar, FindsARotationAndAStretchThatWereMultiplied) {
    const uint64_t seed = 181;
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Rng rng(seed);
    for (int round = 0; round < 20000; ++round) {
        const glm::dmat3 rotation = rotation_of(rng), axes = rotation_of(rng);
        glm::dmat3 extents(0.0);
        const double size = log_uniform(rng, 1e-12, 1e12);
        for (int k = 0; k < 3; ++k) extents[k][k] = size * (rng.below(4) == 0 ? 1.0 : log_uniform(rng, 1e-3, 1.0));
        const double sign = rng.below(2) == 0 ? 1.0 : -1.0;
        const glm::dmat3 stretch = sign * (axes * extents * glm::transpose(axes));
        const Polar split = polar(rotation * stretch);
        expect_rotation(split.rotation);
        ASSERT_LT(difference(split.rotation, rotation), 1e-9) << "round " << round;
        ASSERT_LT(difference(split.stretch, stretch), 1e-9 * size) << "round " << round;
    }
}

TEST(Polar, FlattenedMapsTurnByWhatIsLeft) {
    const uint64_t seed = 182;
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Rng rng(seed);
    for (int round = 0; round < 2000; ++round) {
        const glm::dmat3 rotation = rotation_of(rng);
        const glm::dmat3 plane(1, 0, 0, 0, 0.5, 0, 0, 0, 0), line(0, 0, 0, 0, 2, 0, 0, 0, 0);
        const Polar flat = polar(rotation * plane);
        expect_rotation(flat.rotation);
        EXPECT_LT(difference(flat.rotation, rotation), 1e-9) << "round " << round;
        EXPECT_LT(difference(flat.stretch, plane), 1e-9) << "round " << round;
        const Polar thin = polar(rotation * line);
        expect_rotation(thin.rotation);
        EXPECT_LT(difference(thin.rotation * thin.stretch, rotation * line), 1e-12);
        // The shortest way: no turn has a smaller angle that takes the line to where it goes.
        const double cosine = rotation[1][1];
        EXPECT_NEAR(0.5 * (thin.rotation[0][0] + thin.rotation[1][1] + thin.rotation[2][2] - 1.0), cosine, 1e-9);
    }
    EXPECT_EQ(polar(glm::dmat3(0.0)).rotation, glm::dmat3(1.0));
    EXPECT_EQ(polar(glm::dmat3(0.0)).stretch, glm::dmat3(0.0));
}

TEST(Polar, AMirroredMapIsMinusAStretch) {
    const Polar split = polar(glm::dmat3(-2, 0, 0, 0, 1, 0, 0, 0, 1));
    expect_rotation(split.rotation);
    EXPECT_LT(difference(split.rotation, glm::dmat3(1, 0, 0, 0, -1, 0, 0, 0, -1)), 1e-12);
    EXPECT_LT(difference(split.stretch, glm::dmat3(-2, 0, 0, 0, -1, 0, 0, 0, -1)), 1e-12);
}

}  // namespace
}  // namespace zoe::test
