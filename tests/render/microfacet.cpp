#include "engine/render/microfacet.h"

#include <gtest/gtest.h>

#include "engine/math/rng.h"
#include "engine/render/albedo.h"

namespace zoe::test {
namespace {

constexpr double kPi = glm::pi<double>();

// The reference: the formulas of the papers as they stand, in double precision, integrated over directions.

double reference_density(const glm::dvec3& normal, double alpha) {
    const double cosine2 = normal.z * normal.z, a2 = alpha * alpha;
    const double root = cosine2 * (a2 - 1.0) + 1.0;
    return a2 / (kPi * root * root);
}

double reference_hidden(const glm::dvec3& direction, double alpha) {
    const double tangent2 = (1.0 - direction.z * direction.z) / (direction.z * direction.z);
    return 0.5 * (std::sqrt(1.0 + alpha * alpha * tangent2) - 1.0);
}

glm::dvec3 direction(double z, double angle) {
    const double r = std::sqrt(std::max(0.0, 1.0 - z * z));
    return {r * std::cos(angle), r * std::sin(angle), z};
}

/// Integrates over the upper hemisphere, most finely at its rim and at its pole.
template <typename Function>
double integrate(Function&& function) {
    constexpr int kHeights = 800, kAngles = 400;
    double sum = 0.0;
    for (int i = 0; i < kHeights; ++i) {
        const double s = (i + 0.5) / kHeights;
        double ring = 0.0;
        for (int j = 0; j < kAngles; ++j)
            ring += function(direction(s * s * (3.0 - 2.0 * s), (j + 0.5) * 2.0 * kPi / kAngles));
        sum += ring * 6.0 * s * (1.0 - s);
    }
    return sum * 2.0 * kPi / (kHeights * kAngles);
}

TEST(Microfacet, FacetsCoverTheSurfaceOnce) {
    for (float alpha : {0.1f, 0.3f, 1.0f}) {
        const double area = integrate([&](const glm::dvec3& n) {
            const double density = static_cast<double>(ggx_density(glm::vec3(n), alpha));
            EXPECT_NEAR(density, reference_density(n, static_cast<double>(alpha)), 1e-4 * density);
            return density * n.z;
        });
        EXPECT_NEAR(area, 1.0, 2e-3) << alpha;
    }
}

TEST(Microfacet, SampledNormalsAreThoseThatAreSeen) {
    const uint64_t seed = 31;
    SCOPED_TRACE(seed);
    Rng rng(seed);
    constexpr int kCount = 200000;
    for (float alpha : {0.2f, 0.6f, 1.0f}) {
        for (double cosine : {0.1, 0.5, 0.95}) {
            const glm::dvec3 viewer = direction(cosine, 0.0);
            const double seen = 1.0 / (1.0 + reference_hidden(viewer, static_cast<double>(alpha)));
            glm::dvec3 expected(0.0), sampled(0.0);
            for (int axis = 0; axis < 3; ++axis) {
                expected[axis] = integrate([&](const glm::dvec3& n) {
                    const double area =
                        std::max(0.0, glm::dot(viewer, n)) * reference_density(n, static_cast<double>(alpha));
                    return n[axis] * area * seen / cosine;
                });
            }
            for (int i = 0; i < kCount; ++i) {
                sampled += glm::dvec3(sample_seen_normal(glm::vec3(viewer), alpha, {rng.uniform(), rng.uniform()}));
            }
            EXPECT_LT(glm::distance(sampled / static_cast<double>(kCount), expected), 0.01) << alpha << ", " << cosine;
        }
    }
}

TEST(Microfacet, TablesHoldWhatFacetsReflect) {
    for (float roughness : {0.35f, 0.5f, 0.77f, 1.0f}) {
        for (double cosine : {0.06, 0.2, 0.51, 1.0}) {
            const double alpha = static_cast<double>(roughness) * static_cast<double>(roughness);
            const glm::dvec3 viewer = direction(cosine, 0.0);
            const auto reflect = [&](bool is_edge) {
                return integrate([&](const glm::dvec3& light) {
                    const glm::dvec3 half = glm::normalize(viewer + light);
                    const double both = 1.0 / (1.0 + reference_hidden(viewer, alpha) + reference_hidden(light, alpha));
                    const double edge = is_edge ? std::pow(1.0 - glm::dot(viewer, half), 5.0) : 1.0;
                    return edge * reference_density(half, alpha) * both / (4.0 * cosine);
                });
            };
            const Albedo albedo = GgxAlbedo(roughness).at(static_cast<float>(cosine));
            EXPECT_NEAR(static_cast<double>(albedo.all), reflect(false), 0.006) << roughness << ", " << cosine;
            EXPECT_NEAR(static_cast<double>(albedo.edge), reflect(true), 0.006) << roughness << ", " << cosine;
        }
    }
    EXPECT_NEAR(GgxAlbedo(0.0f).at(1.0f).all, 1.0f, 1e-4f);
}

TEST(Microfacet, SheenReflectsLessThanArrives) {
    for (float roughness : {0.0f, 0.2f, 0.5f, 1.0f}) {
        for (double cosine : {0.01, 0.1, 0.5, 1.0}) {
            const double reference = integrate([&](const glm::dvec3& light) {
                const double alpha = static_cast<double>(sheen_alpha(roughness));
                const double z = glm::normalize(direction(cosine, 0.0) + light).z, v = cosine, l = light.z;
                const double density = (2.0 + 1.0 / alpha) / (2.0 * kPi) * std::pow(1.0 - z * z, 0.5 / alpha);
                return density * l / (4.0 * (l + v - l * v));
            });
            const double albedo = static_cast<double>(sheen_albedo(static_cast<float>(cosine), roughness));
            const double scaled = reference * static_cast<double>(sheen_scale(roughness));
            EXPECT_NEAR(albedo, std::min(scaled, 1.0), 0.03) << roughness << ", " << cosine;
            EXPECT_LE(scaled, 1.03) << roughness << ", " << cosine;
        }
    }
}

}  // namespace
}  // namespace zoe::test
