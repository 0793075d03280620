#include "engine/math/affine.h"

#include <limits>

#include <gtest/gtest.h>
#include <glm/ext/matrix_double3x3.hpp>
#include <glm/ext/vector_double3.hpp>
#include <glm/matrix.hpp>

#include "tests/math/random_inputs.h"

namespace zoe::test {
namespace {

constexpr double kEps = std::numeric_limits<float>::epsilon();

glm::dvec3 point(const Affine& a, const glm::dvec3& p) {
    return glm::dmat3(a.linear) * p + glm::dvec3(a.translation);
}

/// Sum of the magnitudes that go into each coordinate of a.point(p): what rounding errors are relative to.
glm::dvec3 magnitude(const Affine& a, const glm::dvec3& p) {
    glm::dvec3 sum = glm::abs(glm::dvec3(a.translation));
    for (int k = 0; k < 3; ++k) sum += glm::abs(glm::dvec3(a.linear[k]) * p[k]);
    return sum;
}

double largest(const glm::mat3& m) {
    double most = 0.0;
    for (int k = 0; k < 9; ++k) most = std::max(most, std::abs(double{m[k / 3][k % 3]}));
    return most;
}

TEST(Affine, ProductAppliesTheRightMapFirst) {
    const Affine move{glm::mat3(1.0f), {1, 2, 3}};
    const Affine grow{glm::mat3(2.0f), {0, 0, 0}};
    EXPECT_EQ((move * grow).point({1, 1, 1}), glm::vec3(3, 4, 5));
    EXPECT_EQ((grow * move).point({1, 1, 1}), glm::vec3(4, 6, 8));
    EXPECT_EQ((move * grow).vector({1, 1, 1}), glm::vec3(2, 2, 2));
}

TEST(Affine, ProductAgreesWithDouble) {
    const uint64_t seed = 21;
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Rng rng(seed);
    for (int i = 0; i < 20000; ++i) {
        const Affine a = random_affine(rng, 1e-3, 1e3, 100.0f);
        const Affine b = random_affine(rng, 1e-3, 1e3, 100.0f);
        const glm::vec3 p = random_point(rng, 10.0f);
        const glm::dvec3 expected = point(a, point(b, p));
        const glm::dvec3 actual = point(a * b, p);
        const glm::dvec3 bound =
            16.0 * kEps *
            magnitude({glm::mat3(glm::abs(a.linear[0]), glm::abs(a.linear[1]), glm::abs(a.linear[2])), a.translation},
                      magnitude(b, p));
        for (int k = 0; k < 3; ++k) ASSERT_LE(std::abs(actual[k] - expected[k]), bound[k]) << "round " << i;
    }
}

TEST(Affine, TrsScalesThenRotatesThenMoves) {
    // A quarter turn about z takes x to y.
    const float half = std::sqrt(0.5f);
    const Trs trs{{10, 20, 30}, glm::quat(half, 0, 0, half), {2, 3, 4}};
    const glm::vec3 image = to_affine(trs).point({1, 0, 0});
    EXPECT_NEAR(image.x, 10.0f, 1e-5f);
    EXPECT_NEAR(image.y, 22.0f, 1e-5f);
    EXPECT_NEAR(image.z, 30.0f, 1e-5f);
}

TEST(Affine, InverseUndoesTheMapAtScalesFromMillionthsToMillions) {
    const uint64_t seed = 23;
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Rng rng(seed);
    for (int i = 0; i < 20000; ++i) {
        // Each axis its own scale within a factor 100, the whole between 1e-6 and 1e6.
        Affine a = random_affine(rng, 0.1, 10.0, 1.0f);
        const float size = log_uniform(rng, 1e-5, 1e5);
        a.linear *= size;
        a.translation *= log_uniform(rng, 1e-5, 1e5);
        Affine inverse;
        ASSERT_TRUE(invert(a, &inverse));
        const glm::dmat3 exact = glm::inverse(glm::dmat3(a.linear));
        const glm::dvec3 exact_translation = -(exact * glm::dvec3(a.translation));
        const double linear_size = largest(inverse.linear);
        for (int k = 0; k < 9; ++k) {
            ASSERT_NEAR(inverse.linear[k / 3][k % 3], exact[k / 3][k % 3], 2.0 * kEps * linear_size) << "round " << i;
        }
        const double bound = 4.0 * kEps * 3.0 * linear_size * glm::length(glm::dvec3(a.translation));
        for (int k = 0; k < 3; ++k) ASSERT_NEAR(inverse.translation[k], exact_translation[k], bound) << "round " << i;
    }
}

TEST(Affine, ASingularMapHasNoInverseAndLeavesTheResultAlone) {
    const float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
    const Affine marker{glm::mat3(7.0f), {7, 7, 7}};
    std::vector<Affine> singular = {
        {glm::mat3(0.0f), {1, 2, 3}},
        to_affine(Trs{{1, 2, 3}, glm::quat(1, 0, 0, 0), {0, 0, 0}}),
        to_affine(Trs{{1, 2, 3}, glm::quat(1, 0, 0, 0), {1, 0, 1}}),
        to_affine(Trs{{1, 2, 3}, glm::normalize(glm::quat(1, 2, 3, 4)), {0, 1, 1}}),
        {glm::mat3(glm::vec3(1, 2, 3), glm::vec3(2, 4, 6), glm::vec3(0, 0, 1)), {0, 0, 0}},
        {glm::mat3(nan), {0, 0, 0}},
        {glm::mat3(inf), {0, 0, 0}},
        {glm::mat3(1.0f), {0, nan, 0}},
        {glm::mat3(1.0f), {0, 0, inf}},
        {glm::mat3(1e-44f), {0, 0, 0}},  // The inverse would overflow.
    };
    for (size_t i = 0; i < singular.size(); ++i) {
        Affine inverse = marker;
        EXPECT_FALSE(invert(singular[i], &inverse)) << "map " << i;
        EXPECT_EQ(inverse, marker) << "map " << i;
    }
}

TEST(Affine, AnInverseIsFiniteAtAnyScaleThatHasOne) {
    for (double scale = 1e-30; scale < 1e30; scale *= 10.0) {
        Affine inverse;
        ASSERT_TRUE(invert({glm::mat3(float(scale)), {1, 2, 3}}, &inverse)) << scale;
        EXPECT_TRUE(is_finite(inverse)) << scale;
        EXPECT_NEAR(inverse.linear[0][0] * scale, 1.0, 1e-6) << scale;
    }
}

TEST(Affine, IsFiniteSeesEveryNumber) {
    EXPECT_TRUE(is_finite(Affine{}));
    for (int k = 0; k < 12; ++k) {
        for (const float bad : {std::numeric_limits<float>::quiet_NaN(), -std::numeric_limits<float>::infinity()}) {
            Affine a;
            (k < 9 ? a.linear[k / 3][k % 3] : a.translation[k - 9]) = bad;
            EXPECT_FALSE(is_finite(a)) << "number " << k;
        }
    }
}

TEST(Affine, DecomposeGivesBackTheMapItCameFrom) {
    const uint64_t seed = 24;
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Rng rng(seed);
    for (int i = 0; i < 20000; ++i) {
        Trs trs{random_point(rng, 100.0f), random_rotation(rng), {}};
        const float size = log_uniform(rng, 1e-3, 1e3);
        for (int k = 0; k < 3; ++k) trs.scale[k] = size * log_uniform(rng, 0.1, 10.0) * random_sign(rng);
        const Affine a = to_affine(trs);
        Trs found;
        ASSERT_TRUE(decompose(a, &found)) << "round " << i;
        ASSERT_NEAR(glm::length(found.rotation), 1.0f, 1e-5f);
        // The mirror, if any, is in x.
        ASSERT_GT(found.scale.y, 0.0f);
        ASSERT_GT(found.scale.z, 0.0f);
        ASSERT_EQ(found.scale.x < 0.0f, trs.scale.x * trs.scale.y * trs.scale.z < 0.0f);
        const Affine again = to_affine(found);
        ASSERT_EQ(again.translation, a.translation);
        for (int k = 0; k < 9; ++k) {
            ASSERT_NEAR(again.linear[k / 3][k % 3], a.linear[k / 3][k % 3], 16.0 * kEps * largest(a.linear))
                << "round " << i;
        }
    }
}

TEST(Affine, DecomposeReportsShearAndSingularity) {
    Trs trs;
    EXPECT_TRUE(decompose(Affine{}, &trs));
    EXPECT_EQ(trs, Trs{});
    Affine shear;
    shear.linear[1][0] = 0.5f;
    EXPECT_FALSE(decompose(shear, &trs));
    EXPECT_TRUE(is_finite(to_affine(trs))) << "the nearest TRS is still usable";
    Affine small_shear;
    small_shear.linear[2][1] = 1e-2f;
    EXPECT_FALSE(decompose(small_shear, &trs));
    for (const glm::vec3& scale : {glm::vec3(0, 0, 0), glm::vec3(1, 0, 1), glm::vec3(0, 1, 1), glm::vec3(1, 1, 0)}) {
        EXPECT_FALSE(decompose(to_affine(Trs{{1, 2, 3}, glm::quat(1, 0, 0, 0), scale}), &trs));
        EXPECT_TRUE(is_finite(to_affine(trs)));
        EXPECT_EQ(trs.translation, glm::vec3(1, 2, 3));
        EXPECT_NEAR(glm::length(trs.rotation), 1.0f, 1e-5f);
    }
}

TEST(Affine, TransformedBoxContainsTheImageOfEveryPointInIt) {
    const uint64_t seed = 25;
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Rng rng(seed);
    for (int i = 0; i < 50000; ++i) {
        const Affine a = random_affine(rng, 1e-6, 1e6, log_uniform(rng, 1e-6, 1e6));
        Aabb box;
        const float size = log_uniform(rng, 1e-6, 1e6);
        const glm::vec3 centre = random_point(rng, log_uniform(rng, 1e-6, 1e6));
        box.extend(centre + random_point(rng, size));
        box.extend(centre + random_point(rng, size));
        const Aabb image = transform(a, box);
        for (int k = 0; k < 16; ++k) {
            glm::vec3 p;
            if (k < 8) {
                p = {k & 1 ? box.hi.x : box.lo.x, k & 2 ? box.hi.y : box.lo.y, k & 4 ? box.hi.z : box.lo.z};
            } else {
                const glm::vec3 u{rng.uniform(), rng.uniform(), rng.uniform()};
                p = glm::clamp(box.lo + u * box.extent(), box.lo, box.hi);
            }
            const glm::dvec3 exact = point(a, p);
            ASSERT_TRUE(glm::all(glm::lessThanEqual(glm::dvec3(image.lo), exact)) &&
                        glm::all(glm::lessThanEqual(exact, glm::dvec3(image.hi))))
                << "round " << i << ", point " << k;
            ASSERT_TRUE(image.contains(a.point(p))) << "as rounded to float; round " << i << ", point " << k;
        }
    }
}

TEST(Affine, TransformedBoxIsTightUpToRounding) {
    const uint64_t seed = 26;
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Rng rng(seed);
    for (int i = 0; i < 10000; ++i) {
        const Affine a = random_affine(rng, 1e-3, 1e3, 1.0f);
        Aabb box;
        box.extend(random_point(rng, 10.0f));
        box.extend(random_point(rng, 10.0f));
        glm::dvec3 lo(std::numeric_limits<double>::infinity()), hi(-lo), size(0.0);
        for (int k = 0; k < 8; ++k) {
            const glm::vec3 p{k & 1 ? box.hi.x : box.lo.x, k & 2 ? box.hi.y : box.lo.y, k & 4 ? box.hi.z : box.lo.z};
            lo = glm::min(lo, point(a, p));
            hi = glm::max(hi, point(a, p));
            size = glm::max(size, magnitude(a, p));
        }
        const Aabb image = transform(a, box);
        for (int k = 0; k < 3; ++k) {
            ASSERT_LE(lo[k] - double{image.lo[k]}, 64.0 * kEps * size[k]) << "round " << i;
            ASSERT_LE(double{image.hi[k]} - hi[k], 64.0 * kEps * size[k]) << "round " << i;
        }
    }
}

TEST(Affine, TransformOfAnEmptyBoxIsEmpty) {
    Rng rng(27);
    for (int i = 0; i < 100; ++i) EXPECT_TRUE(transform(random_affine(rng, 0.1, 10.0, 5.0f), Aabb{}).is_empty());
}

}  // namespace
}  // namespace zoe::test
