#include "engine/render/bsdf.h"

#include <gtest/gtest.h>

#include "engine/render/direction.h"
#include "engine/render/sampler.h"
#include "tests/math/random_inputs.h"

namespace zoe::test {
namespace {

constexpr double kSphere = 4.0 * glm::pi<double>();

glm::vec3 random_direction_above(Rng& rng, const glm::vec3& normal) {
    const glm::vec3 direction = random_direction(rng);
    return glm::dot(direction, normal) < 0.0f ? -direction : direction;
}

/// With a cosine to z.
glm::vec3 at_cosine(float cosine) {
    return glm::normalize(glm::vec3(std::sqrt(1.0f - cosine * cosine), 0.0f, cosine));
}

Surface diffuse(const glm::vec3& ng, const glm::vec3& ns) {
    Surface surface;
    surface.ng = ng;
    surface.ns = surface.coat_ns = ns;
    return surface;
}

/// White, flat, with z up.
Surface white(float metallic, float roughness) {
    Surface surface;
    surface.metallic = metallic;
    surface.roughness = roughness;
    surface.specular = 1.0f;
    return surface;
}

/// Any mixture of layers.
Surface random_surface(Rng& rng, float least_roughness) {
    Surface surface = white(rng.uniform(), rng.uniform(least_roughness, 1.0f));
    surface.base_color = {rng.uniform(), rng.uniform(), rng.uniform()};
    surface.specular = rng.uniform();
    surface.specular_color = {rng.uniform(), rng.uniform(), rng.uniform()};
    if (rng.below(2) == 0) {
        surface.coat = rng.uniform();
        surface.coat_roughness = rng.uniform(least_roughness, 1.0f);
    }
    if (rng.below(2) == 0) {
        surface.sheen_color = {rng.uniform(), rng.uniform(), rng.uniform()};
        surface.sheen_roughness = rng.uniform(0.3f, 1.0f);
    }
    return surface;
}

/// What a surface shows under a sky of 1.
glm::dvec3 shown(const Surface& surface, const glm::vec3& to_viewer, uint32_t sample_count) {
    const Bsdf bsdf(surface, to_viewer);
    glm::dvec3 sum(0.0);
    for (uint32_t i = 0; i < sample_count; ++i) {
        const SampleKey key{7, i};
        const auto sample = bsdf.sample(uniform_2d(key, 0), uniform_1d(key, 1));
        if (sample) sum += glm::dvec3(sample->weight);
    }
    return sum / static_cast<double>(sample_count);
}

TEST(Bsdf, FramesAreOrthonormalAndRightHanded) {
    Rng rng(2);
    for (int i = 0; i < 1000; ++i) {
        const glm::vec3 n = i < 2 ? glm::vec3(0, 0, i == 0 ? 1 : -1) : random_direction(rng);
        glm::vec3 t, b;
        make_frame(n, &t, &b);
        EXPECT_NEAR(glm::length(t), 1.0f, 1e-5f);
        EXPECT_NEAR(glm::length(b), 1.0f, 1e-5f);
        EXPECT_NEAR(glm::dot(t, n), 0.0f, 1e-5f);
        EXPECT_NEAR(glm::distance(glm::cross(t, b), n), 0.0f, 1e-5f);
    }
}

TEST(Bsdf, ADiffuseSurfaceScattersByTheCosineOverPi) {
    const glm::vec3 n(0, 1, 0);
    const Surface surface = diffuse(n, n);
    const Bsdf bsdf(surface, glm::normalize(glm::vec3(1, 2, 3)));
    EXPECT_FLOAT_EQ(bsdf.evaluate(n).value.r, glm::one_over_pi<float>());
    EXPECT_NEAR(bsdf.evaluate(glm::normalize(glm::vec3(1, 1, 0))).value.r, glm::one_over_pi<float>() * std::sqrt(0.5f),
                1e-6f);
    EXPECT_EQ(bsdf.evaluate(-n).value.r, 0.0f);
    EXPECT_EQ(bsdf.evaluate(-n).density, 0.0f);
}

TEST(Bsdf, DensitiesIntegrateToTheShareOfSamplesHoweverTheShadingNormalLeans) {
    const uint64_t seed = 3;
    SCOPED_TRACE(seed);
    Rng rng(seed);
    constexpr int kCount = 100000;
    for (int round = 0; round < 16; ++round) {
        const bool is_diffuse = round < 4;
        const glm::vec3 ng = random_direction(rng), ns = random_direction_above(rng, ng);
        Surface surface = is_diffuse ? diffuse(ng, ns) : random_surface(rng, 0.4f);
        surface.ng = ng;
        surface.ns = surface.coat_ns = ns;
        const Bsdf bsdf(surface, random_direction_above(rng, ng));
        double integral = 0.0, found = 0.0;
        glm::dvec3 expected(0.0), sampled(0.0);
        for (int i = 0; i < kCount; ++i) {
            const glm::vec3 any = random_direction(rng);
            const Bsdf::Value value = bsdf.evaluate(any);
            if (glm::dot(any, ng) <= 0.0f) {
                EXPECT_EQ(value.density, 0.0f);
            }
            integral += static_cast<double>(value.density) * kSphere / kCount;
            expected += glm::dvec3(any) * static_cast<double>(value.density) * kSphere / static_cast<double>(kCount);
            const auto sample = bsdf.sample({rng.uniform(), rng.uniform()}, rng.uniform());
            if (!sample) continue;
            EXPECT_GE(glm::dot(sample->direction, ng), 0.0f);
            EXPECT_NEAR(glm::length(sample->direction), 1.0f, 1e-5f);
            found += 1.0 / kCount;
            sampled += glm::dvec3(sample->direction) / static_cast<double>(kCount);
            const Bsdf::Value there = bsdf.evaluate(sample->direction);
            EXPECT_EQ(sample->density, there.density);
            EXPECT_EQ(sample->weight, there.value / there.density);
        }
        if (is_diffuse) {
            EXPECT_NEAR(found, 1.0, 1e-6);
        }
        EXPECT_NEAR(integral, found, 0.03) << "round " << round << ", roughness " << surface.roughness;
        EXPECT_LT(glm::distance(sampled, expected), 0.04) << "round " << round;
    }
}

TEST(Bsdf, WhiteStaysWhiteAtEveryRoughnessAndMetalness) {
    // Light between facets is little and comes in at grazing angles: many samples for that.
    for (int r = 0; r <= 14; ++r) {
        for (int m = 0; m <= 2; ++m) {
            const float roughness = static_cast<float>(r) / 14.0f, metallic = static_cast<float>(m) / 2.0f;
            for (float cosine : {0.03f, 0.1f, 0.4f, 1.0f}) {
                const double brightness = shown(white(metallic, roughness), at_cosine(cosine), 65536).g;
                EXPECT_NEAR(brightness, 1.0, 0.01)
                    << "roughness " << roughness << ", metallic " << metallic << ", cosine " << cosine;
            }
        }
    }
}

TEST(Bsdf, WhiteStaysWhiteWhenTheShadingNormalLeansAndInBodies) {
    const uint64_t seed = 5;
    SCOPED_TRACE(seed);
    Rng rng(seed);
    for (int round = 0; round < 40; ++round) {
        Surface surface = white(rng.uniform(), rng.uniform());
        surface.ng = random_direction(rng);
        surface.ns = random_direction_above(rng, surface.ng);
        if (round % 2 == 0) {
            surface.transmission = rng.uniform();
            surface.has_volume = true;
            surface.is_inside = round % 4 == 0;
        }
        const glm::dvec3 brightness = shown(surface, random_direction_above(rng, surface.ng), 65536);
        EXPECT_NEAR(brightness.r, 1.0, 0.01) << "round " << round << ", roughness " << surface.roughness;
    }
}

TEST(Bsdf, NoSurfaceReflectsMoreThanArrives) {
    const uint64_t seed = 6;
    SCOPED_TRACE(seed);
    Rng rng(seed);
    for (int round = 0; round < 60; ++round) {
        Surface surface = random_surface(rng, 0.0f);
        surface.base_color = glm::vec3(1.0f);
        const float cosine = rng.uniform(0.02f, 1.0f);
        const double brightness = shown(surface, at_cosine(cosine), 16384).g;
        EXPECT_LT(brightness, 1.015) << "round " << round << ", cosine " << cosine << ", sheen " << surface.sheen_color.g
                                     << " / " << surface.sheen_roughness << ", coat " << surface.coat;
        EXPECT_GT(brightness, 0.3);
    }
}

TEST(Bsdf, LightGoesBothWaysAlike) {
    const uint64_t seed = 7;
    SCOPED_TRACE(seed);
    Rng rng(seed);
    for (int round = 0; round < 2000; ++round) {
        const Surface surface = random_surface(rng, 0.1f);
        const glm::vec3 a = at_cosine(rng.uniform(0.05f, 1.0f)), b = random_direction_above(rng, surface.ng);
        if (b.z < 0.05f) continue;
        const glm::vec3 there = Bsdf(surface, a).evaluate(b).value / b.z, back = Bsdf(surface, b).evaluate(a).value / a.z;
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(there[c], back[c], 2e-3f * (1e-3f + there[c])) << "round " << round;
    }
}

TEST(Bsdf, SmoothBodiesBendLightBySnellsLaw) {
    Surface glass = white(0.0f, 0.0f);
    glass.transmission = 1.0f;
    glass.has_volume = true;
    const glm::vec3 viewer = at_cosine(0.6f);  // sine 0.8
    // The narrowest distribution still has wide tails: a few samples stray.
    constexpr uint32_t kCount = 1024;
    const auto count = [&](float x, bool is_above) {
        uint32_t near = 0;
        for (uint32_t i = 0; i < kCount; ++i) {
            const SampleKey key{1, i};
            const auto sample = Bsdf(glass, viewer).sample(uniform_2d(key, 0), uniform_1d(key, 1));
            if (!sample || (sample->direction.z > 0.0f) != is_above) continue;
            near += std::abs(sample->direction.x - x) < 0.01f ? 1 : 0;
            if (!is_above) {
                EXPECT_EQ(sample->density, 0.0f);
            }
        }
        return near;
    };
    EXPECT_GT(count(-0.8f / 1.5f, false), 0.9 * kCount);
    // From inside, beyond the critical angle, all of it goes back.
    glass.is_inside = true;
    EXPECT_GT(count(-0.8f, true), 0.97 * kCount);
    // Below that angle it leaves by the same law.
    const glm::vec3 steep = at_cosine(std::sqrt(1.0f - 0.25f));  // sine 0.5
    uint32_t left = 0;
    for (uint32_t i = 0; i < kCount; ++i) {
        const SampleKey key{2, i};
        const auto sample = Bsdf(glass, steep).sample(uniform_2d(key, 0), uniform_1d(key, 1));
        left += sample && std::abs(sample->direction.x + 0.75f) < 0.01f && sample->direction.z < 0.0f ? 1 : 0;
    }
    EXPECT_GT(left, 0.85 * kCount);
}

TEST(Bsdf, AThinSheetReflectsWhatItDoesNotLetPass) {
    for (float roughness : {0.0f, 0.09f, 0.11f, 0.3f, 0.9f}) {
        for (float cosine : {0.1f, 0.5f, 1.0f}) {
            Surface sheet = white(0.0f, roughness);
            sheet.transmission = 1.0f;
            const double scattered = shown(sheet, at_cosine(cosine), 16384).r;
            EXPECT_NEAR(scattered + static_cast<double>(passes_straight(sheet, at_cosine(cosine)).r), 1.0, 0.01)
                << "roughness " << roughness << ", cosine " << cosine;
        }
    }
}

TEST(Bsdf, FrostedSheetsScatterWhatPassesAroundTheStraightWay) {
    const uint64_t seed = 9;
    SCOPED_TRACE(seed);
    Rng rng(seed);
    constexpr int kCount = 100000;
    for (int round = 0; round < 8; ++round) {
        Surface sheet = random_surface(rng, 0.4f);
        sheet.transmission = rng.uniform(0.3f, 1.0f);
        sheet.ng = random_direction(rng);
        sheet.ns = sheet.coat_ns = round % 2 == 0 ? sheet.ng : random_direction_above(rng, sheet.ng);
        const glm::vec3 viewer = random_direction_above(rng, sheet.ng);
        const Bsdf bsdf(sheet, viewer);
        double integral = 0.0, found = 0.0;
        glm::dvec3 shows(0.0), sampled(0.0);
        for (int i = 0; i < kCount; ++i) {
            const Bsdf::Value value = bsdf.evaluate(random_direction(rng));
            integral += static_cast<double>(value.density) * kSphere / kCount;
            shows += glm::dvec3(value.value) * (kSphere / kCount);
            const auto sample = bsdf.sample({rng.uniform(), rng.uniform()}, rng.uniform());
            if (!sample) continue;
            found += 1.0 / kCount;
            sampled += glm::dvec3(sample->weight) / static_cast<double>(kCount);
            EXPECT_EQ(sample->density, bsdf.evaluate(sample->direction).density);
        }
        EXPECT_NEAR(integral, found, 0.03) << "round " << round;
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(shows[c], sampled[c], 0.03) << "round " << round;
    }
    // Straight on, whichever way the shading normal leans.
    for (const float lean : {-0.4f, -0.2f, 0.0f, 0.2f, 0.4f}) {
        Surface sheet = white(0.0f, 0.25f);
        sheet.transmission = 1.0f;
        sheet.ns = sheet.coat_ns = glm::normalize(glm::vec3(lean, 0.1f, 1.0f));
        const glm::vec3 viewer = at_cosine(0.9f);
        const Bsdf bsdf(sheet, viewer);
        glm::vec3 mean(0.0f);
        for (uint32_t i = 0; i < 4096; ++i) {
            const auto sample = bsdf.sample(uniform_2d({4, i}, 0), uniform_1d({4, i}, 1));
            if (sample && sample->direction.z < 0.0f) mean += sample->direction * sample->weight.r;
        }
        EXPECT_GT(glm::dot(glm::normalize(mean), -viewer), 0.998f) << lean;
    }
    // The rougher, the wider.
    double last = 0.0;
    for (const float roughness : {0.15f, 0.3f, 0.5f, 0.8f}) {
        Surface sheet = white(0.0f, roughness);
        sheet.transmission = 1.0f;
        const glm::vec3 viewer = at_cosine(0.9f);
        const Bsdf bsdf(sheet, viewer);
        double apart = 0.0;
        int count = 0;
        for (uint32_t i = 0; i < 4096; ++i) {
            const auto sample = bsdf.sample(uniform_2d({3, i}, 0), uniform_1d({3, i}, 1));
            if (!sample || sample->direction.z > 0.0f) continue;
            apart += static_cast<double>(glm::distance(sample->direction, -viewer));
            ++count;
        }
        ASSERT_GT(count, 2000);
        EXPECT_GT(apart / count, 1.5 * last) << roughness;
        last = apart / count;
    }
}

/// From one side of the interpolated normal's horizon to the other, for all layers, whichever way bumps and facet lean.
TEST(Bsdf, BumpsFadeSteadilyTowardsTheirSurfacesHorizon) {
    const uint64_t seed = 8;
    SCOPED_TRACE(seed);
    Rng rng(seed);
    for (int round = 0; round < 200; ++round) {
        Surface surface = white(0.0f, 1.0f);
        if (round % 2 == 0) surface.coat = surface.coat_roughness = 1.0f;
        const auto lean = [&] {
            return glm::normalize(glm::vec3(random_point(rng, 0.8f).x, random_point(rng, 0.8f).y, 1.0f));
        };
        surface.ng = lean();
        surface.ns = lean();
        surface.coat_ns = lean();
        const Bsdf bsdf(surface, surface.smooth);
        const float round_angle = rng.uniform(0.0f, glm::two_pi<float>());
        const glm::vec3 side(std::cos(round_angle), std::sin(round_angle), 0.0f);
        float last = 0.0f, most = 0.0f;
        for (int i = -20; i <= 100; ++i) {
            const float angle = static_cast<float>(i) * 0.01f * glm::half_pi<float>();
            const float shown = bsdf.evaluate_sharp(std::cos(angle) * side + std::sin(angle) * surface.smooth).g;
            EXPECT_LT(shown, i <= 0 ? 1e-6f : 1.0f);
            EXPECT_LE(std::abs(shown - last), 0.04f) << "a step, where the light moves by 0.016";
            last = shown;
            most = std::max(most, shown);
        }
        EXPECT_GT(most, 0.2f);
        EXPECT_EQ(past_terminator(surface.smooth, surface.smooth, random_direction(rng)), 1.0f);
        const glm::vec3 light = random_direction(rng);
        EXPECT_EQ(past_terminator(surface.smooth, surface.ns, light), past_terminator(-surface.smooth, -surface.ns, light))
            << "light from behind fades as it does on the other side";
    }
}

TEST(Bsdf, FrostedSheetsWithBumpsReflectNoSharpLightFromBehind) {
    Surface sheet = white(0.0f, 0.5f);
    sheet.base_color = {1.0f, 0.0f, 0.0f};  // of what passes; what is reflected is white
    sheet.transmission = 1.0f;
    sheet.ns = glm::normalize(glm::vec3(0.6f, 0.0f, 1.0f));
    const Bsdf bsdf(sheet, glm::vec3(0, 0, 1));
    const glm::vec3 grazing = glm::normalize(glm::vec3(1.0f, 0.0f, -0.1f)), behind(0, 0, -1);
    EXPECT_EQ(bsdf.evaluate_sharp(grazing), glm::vec3(0.0f));
    EXPECT_GT(bsdf.evaluate_sharp(behind).r, 0.1f);
    EXPECT_EQ(bsdf.evaluate_sharp(behind).g, 0.0f);
}

}  // namespace
}  // namespace zoe::test
