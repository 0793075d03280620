#include "engine/render/bsdf.h"

#include <gtest/gtest.h>

#include "engine/math/rng.h"

namespace zoe::test {
namespace {

glm::vec3 random_direction(Rng& rng) {
    const float z = rng.uniform(-1.0f, 1.0f), angle = rng.uniform(0.0f, glm::two_pi<float>());
    const float r = std::sqrt(std::max(0.0f, 1.0f - z * z));
    return {r * std::cos(angle), r * std::sin(angle), z};
}

/// A shading normal above the surface, leaning at most as far as the plane.
glm::vec3 random_shading_normal(Rng& rng, const glm::vec3& ng) {
    const glm::vec3 ns = random_direction(rng);
    return glm::dot(ns, ng) < 0.0f ? -ns : ns;
}

TEST(Bsdf, FramesAreOrthonormalAndRightHanded) {
    Rng rng(2);
    for (int i = 0; i < 1000; ++i) {
        const glm::vec3 n = i < 2 ? glm::vec3(0, 0, i == 0 ? 1 : -1) : glm::normalize(random_direction(rng));
        glm::vec3 t, b;
        make_frame(n, &t, &b);
        EXPECT_NEAR(glm::length(t), 1.0f, 1e-5f);
        EXPECT_NEAR(glm::length(b), 1.0f, 1e-5f);
        EXPECT_NEAR(glm::dot(t, n), 0.0f, 1e-5f);
        EXPECT_NEAR(glm::distance(glm::cross(t, b), n), 0.0f, 1e-5f);
    }
}

TEST(Bsdf, WithoutAShadingNormalTheDensityIsTheCosineOverPi) {
    const glm::vec3 n(0, 1, 0);
    EXPECT_FLOAT_EQ(diffuse(n, n, n), glm::one_over_pi<float>());
    EXPECT_NEAR(diffuse(n, n, glm::normalize(glm::vec3(1, 1, 0))), glm::one_over_pi<float>() * std::sqrt(0.5f), 1e-6f);
    EXPECT_EQ(diffuse(n, n, -n), 0.0f);
}

TEST(Bsdf, TheDensityIntegratesToOneHoweverTheShadingNormalLeans) {
    Rng rng(3);
    for (int round = 0; round < 8; ++round) {
        const glm::vec3 ng = glm::normalize(random_direction(rng)), ns = glm::normalize(random_shading_normal(rng, ng));
        double sum = 0.0;
        constexpr int kCount = 200000;
        for (int i = 0; i < kCount; ++i) sum += diffuse(ns, ng, random_direction(rng));
        EXPECT_NEAR(sum / kCount * 4.0 * glm::pi<double>(), 1.0, 0.02) << "cosine of the lean " << glm::dot(ns, ng);
    }
}

TEST(Bsdf, SampledDirectionsStayAboveTheSurfaceAndFollowTheDensity) {
    Rng rng(4);
    for (int round = 0; round < 8; ++round) {
        const glm::vec3 ng = glm::normalize(random_direction(rng)), ns = glm::normalize(random_shading_normal(rng, ng));
        constexpr int kCount = 100000;
        glm::dvec3 sampled(0.0), expected(0.0);
        for (int i = 0; i < kCount; ++i) {
            const glm::vec3 direction = sample_diffuse(ns, ng, {rng.uniform(), rng.uniform()});
            EXPECT_GE(glm::dot(direction, ng), 0.0f);
            EXPECT_NEAR(glm::length(direction), 1.0f, 1e-5f);
            sampled += glm::dvec3(direction) / static_cast<double>(kCount);
            const glm::vec3 other = random_direction(rng);
            expected += glm::dvec3(other) * static_cast<double>(diffuse(ns, ng, other)) * 4.0 * glm::pi<double>() /
                        static_cast<double>(kCount);
        }
        EXPECT_LT(glm::distance(sampled, expected), 0.03);
    }
}

}  // namespace
}  // namespace zoe::test
