#include "engine/render/physical_sky.h"

#include <array>
#include <cmath>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>
#include <glm/trigonometric.hpp>

#include "engine/math/rng.h"
#include "tests/render/scenes.h"

namespace zoe::test {
namespace {

constexpr double kPi = glm::pi<double>();
constexpr int kWidth = 192, kHeight = 96;  // of the sky's map: places between pixels would be blended

struct Pixel {
    glm::vec3 direction;
    double solid_angle;
};
Pixel pixel(int x, int y) {
    const double down = (y + 0.5) * kPi / kHeight, round = (x + 0.5) * 2.0 * kPi / kWidth - kPi;
    return {glm::vec3(std::sin(down) * std::sin(round), std::cos(down), -std::sin(down) * std::cos(round)),
            std::sin(down) * 2.0 * kPi * kPi / (kWidth * kHeight)};
}

/// On a horizontal plane, from the pixels above it.
glm::dvec3 irradiance_of(const Environment& sky) {
    glm::dvec3 sum(0.0);
    for (int y = 0; y < kHeight / 2; ++y) {
        for (int x = 0; x < kWidth; ++x) {
            const Pixel at = pixel(x, y);
            sum += glm::dvec3(sky.radiance(at.direction)) * (static_cast<double>(at.direction.y) * at.solid_angle);
        }
    }
    return sum;
}

// The sky again, straight from its definition: planes through the earth's centre, even steps that are far smaller, no code
// in common.

struct Color {
    double scatters_air, haze, ozone;
};
constexpr std::array<Color, 3> kColors = {
    {{680e-9, 3.8e-5, 0.65e-6}, {550e-9, 5.0e-5, 1.88e-6}, {440e-9, 6.7e-5, 0.085e-6}}};

double air(double wavelength) {
    const double n2 = 1.000278 * 1.000278 - 1.0;
    return 8.0 * std::pow(kPi, 3) * n2 * n2 * 1.048 / (3.0 * 2.547e25 * std::pow(wavelength, 4));
}

double taken_at(const Color& color, double height, bool is_scattered) {
    return air(color.scatters_air) * std::exp(-height / 8.4e3) +
           (is_scattered ? 0.92 : 1.0) * color.haze * std::exp(-height / 1.2e3) +
           (is_scattered ? 0.0 : color.ozone * std::max(0.0, 1.0 - std::abs(height - 25e3) / 15e3));
}

/// Optical depth from a point at a height, by the angle to up, as far as `length`; to where the air ends for 0. Infinite
/// through the ground.
double depth_of(const Color& color, double height, double angle, double length, int steps) {
    const double earth = 6.371e6, r = earth + height;
    if (length == 0.0) {
        const double b = r * std::cos(angle), c = r * r - std::pow(earth + 80e3, 2);
        if (b < 0.0 && r * std::sin(angle) < earth) return std::numeric_limits<double>::infinity();
        length = -b + std::sqrt(b * b - c);
    }
    double sum = 0.0;
    for (int i = 0; i < steps; ++i) {
        const double t = (i + 0.5) * length / steps;
        sum += taken_at(color, std::sqrt(r * r + t * t + 2.0 * r * t * std::cos(angle)) - earth, false);
    }
    return sum * length / steps;
}

/// The mean radiance that arrives at a height, of all orders from the second on: what is scattered once or by the ground,
/// from all around, and a geometric series of it.
double often(const Color& color, double height, const glm::dvec3& sun) {
    constexpr int kUps = 10, kRounds = 16, kSteps = 28, kSunSteps = 40;
    const double earth = 6.371e6, r = earth + height;
    double once = 0.0, again = 0.0;
    for (int i = 0; i < kUps; ++i) {
        for (int j = 0; j < kRounds; ++j) {
            const double up = -1.0 + (i + 0.5) * 2.0 / kUps, round = j * 2.0 * kPi / kRounds,
                         flat = std::sqrt(1.0 - up * up);
            const glm::dvec3 direction(flat * std::sin(round), up, flat * std::cos(round));
            const bool is_grounded = up < 0.0 && r * flat < earth;
            const double top = is_grounded ? earth : earth + 80e3, root = std::sqrt(r * r * (up * up - 1.0) + top * top),
                         length = -r * up + (is_grounded ? -root : root);
            double behind = 0.0;
            for (int k = 0; k < kSteps; ++k) {
                // Short steps at both ends.
                const auto place = [&](double x) { return length * x * x * (3.0 - 2.0 * x); };
                const double begin = place(double(k) / kSteps), end = place(double(k + 1) / kSteps), step = end - begin;
                const glm::dvec3 point = glm::dvec3(0, r, 0) + 0.5 * (begin + end) * direction;
                const double h = glm::length(point) - earth, half = 0.5 * step * taken_at(color, h, false);
                const double angle = std::acos(glm::dot(point, sun) / glm::length(point));
                behind += half;
                const double arrives = taken_at(color, h, true) * std::exp(-behind) * step;
                again += arrives;
                once += arrives * std::exp(-depth_of(color, h, angle, 0.0, kSunSteps)) / (4.0 * kPi);
                behind += half;
            }
            if (!is_grounded) continue;
            const glm::dvec3 ground = glm::normalize(glm::dvec3(0, r, 0) + length * direction);
            const double cosine = glm::dot(ground, sun);
            if (cosine > 0.0)
                once += 0.3 / kPi * cosine * std::exp(-behind - depth_of(color, 0.0, std::acos(cosine), 0.0, kSunSteps));
        }
    }
    constexpr double kCount = kUps * kRounds;
    return once / kCount / (1.0 - again / kCount);
}

double reference(const Color& color, const glm::dvec3& direction, const glm::dvec3& sun) {
    constexpr int kSteps = 600, kSunSteps = 300, kOften = 30;  // each so many steps looks at light that was scattered often
    const double earth = 6.371e6, r = earth + 2.0;
    const double up = direction.y, length = -r * up + std::sqrt(r * r * up * up + std::pow(earth + 80e3, 2) - r * r);
    const double cosine = glm::dot(direction, sun), g = 0.76;
    const double air_phase = 3.0 / (16.0 * kPi) * (1.0 + cosine * cosine);
    const double haze_phase = 3.0 / (8.0 * kPi) * (1.0 - g * g) * (1.0 + cosine * cosine) /
                              ((2.0 + g * g) * std::pow(1.0 + g * g - 2.0 * g * cosine, 1.5));
    double sum = 0.0, behind = 0.0, around = 0.0;
    for (int i = 0; i < kSteps; ++i) {
        const glm::dvec3 point = glm::dvec3(0, r, 0) + (i + 0.5) * length / kSteps * direction;
        const double height = glm::length(point) - earth, step = length / kSteps;
        const double angle = std::acos(glm::dot(point, sun) / glm::length(point));
        const double half = 0.5 * step * taken_at(color, height, false);
        if (i % kOften == 0) around = often(color, height, {std::sin(angle), std::cos(angle), 0});
        behind += half;
        const double once = air(color.scatters_air) * std::exp(-height / 8.4e3) * air_phase +
                            0.92 * color.haze * std::exp(-height / 1.2e3) * haze_phase;
        sum += std::exp(-behind) * step *
               (once * std::exp(-depth_of(color, height, angle, 0.0, kSunSteps)) + taken_at(color, height, true) * around);
        behind += half;
    }
    return kPi * sum;
}

TEST(PhysicalSky, FollowsItsIntegralInFarSmallerSteps) {
    const uint64_t seed = 91;
    SCOPED_TRACE(seed);
    Rng rng(seed);
    for (const double elevation : {60.0, 8.0, -3.0}) {
        const glm::vec3 sun = sky_direction(elevation, 20.0);
        const Environment sky = make_physical_sky(sun);
        const double share =
            elevation > 0.0 ? 0.06 : 0.15;  // at dusk the shadow's edge crosses the table of what is scattered often
        const double brightest = static_cast<double>(sky.radiance(sky_direction(4.0, 20.0)).r);
        for (int i = 0; i < 3; ++i) {
            const int y = i == 0 ? kHeight / 2 - 1 : static_cast<int>(rng.below(kHeight / 2));
            const Pixel at = pixel(static_cast<int>(rng.below(kWidth)), y);
            const glm::vec3 found = sky.radiance(at.direction);
            for (size_t c = 0; c < 3; ++c) {
                const double expected = reference(kColors[c], at.direction, sun);
                EXPECT_NEAR(static_cast<double>(found[static_cast<int>(c)]), expected, share * expected + 2e-3 * brightest)
                    << "sun at " << elevation << ", row " << y << ", colour " << c;
            }
        }
    }
}

TEST(PhysicalSky, IsLightWhereverTheSunStands) {
    glm::vec3 last(0.0f);
    for (double elevation = -90.0; elevation <= 90.0; elevation += elevation > -2.0 && elevation < 2.0 ? 0.25 : 8.0) {
        const Environment sky = make_physical_sky(sky_direction(elevation, 77.0));
        EXPECT_EQ(sky.repaired_count(), 0u) << "NaN, below 0, or more than any light";
        const glm::vec3 sun = sky.sun().irradiance();
        for (int c = 0; c < 3; ++c) {
            EXPECT_GE(sun[c], last[c]) << "the higher, the brighter; sun at " << elevation;
            EXPECT_LE(sun[c], glm::pi<float>());
            if (c > 0) {
                EXPECT_LE(sun[c], sun[c - 1]) << "red before blue; sun at " << elevation;
            }
        }
        if (elevation < -0.3) {
            EXPECT_TRUE(sky.sun().is_dark());
        } else if (elevation > 0.0) {
            EXPECT_FALSE(sky.sun().is_dark());
        }
        last = sun;
    }
    const Environment night = make_physical_sky(sky_direction(-60.0, 0.0));
    EXPECT_EQ(irradiance_of(night), glm::dvec3(0.0));
    EXPECT_EQ(night.density({0, 1, 0}), 0.0f);
}

TEST(PhysicalSky, TurnsWithTheSunAndIsTheSameOnBothSidesOfIt) {
    constexpr double kColumn = 360.0 / kWidth;
    const Environment sky = make_physical_sky(sky_direction(25.0, 10.0 * kColumn)),
                      turned = make_physical_sky(sky_direction(25.0, 30.0 * kColumn));
    for (int y = 0; y < kHeight; y += 5) {
        for (int x = 0; x < kWidth; x += 7) {
            const glm::vec3 there = sky.radiance(pixel(x, y).direction),
                            round = turned.radiance(pixel((x + 20) % kWidth, y).direction);
            // The sun is at the edge of columns 105 and 106.
            const glm::vec3 opposite = sky.radiance(pixel((2 * 106 - 1 - x + kWidth) % kWidth, y).direction);
            for (int c = 0; c < 3; ++c) {
                EXPECT_NEAR(there[c], round[c], 1e-4f * there[c]) << x << ", " << y;
                EXPECT_NEAR(there[c], opposite[c], 1e-4f * there[c]) << x << ", " << y;
            }
        }
    }
}

TEST(PhysicalSky, LightsAFloorAsItsPixelsAndItsSunDo) {
    for (const double elevation : {70.0, 20.0, 2.0}) {
        const Environment sky = make_physical_sky(sky_direction(elevation, 200.0));
        const glm::dvec3 irradiance =
            irradiance_of(sky) + glm::dvec3(sky.sun().irradiance()) * static_cast<double>(sky.sun().toward().y);
        Scene scene;
        add_node(scene, make_floor(1.0f, 0.0f, add_diffuse(scene, glm::vec3(0.5f))));
        RenderConfig config;
        config.environment = &sky;
        const View view = look_at({0, 3, 0.1f}, {0, 0, 0}, 10.0f, 1.0f);
        const glm::vec3 mean = mean_radiance(picture(scene, view, config, 16, 16, 256));
        for (int c = 0; c < 3; ++c) {
            const double expected = 0.5 * irradiance[c] / kPi;
            EXPECT_NEAR(static_cast<double>(mean[c]), expected, 0.01 * expected) << "sun at " << elevation;
        }
        // No more than came to where the air begins.
        EXPECT_LT(irradiance.b, kPi * std::sin(glm::radians(elevation)) + 0.05);
    }
}

TEST(PhysicalSky, IsBlueAtNoonAndRedAroundTheSettingSun) {
    const Environment noon = make_physical_sky(sky_direction(60.0, 0.0));
    const glm::vec3 above = noon.radiance(sky_direction(60.0, 180.0));
    EXPECT_TRUE(above.b > 1.5f * above.g && above.g > 1.3f * above.r) << above.r << ' ' << above.g << ' ' << above.b;
    const glm::dvec3 from_sky = irradiance_of(noon),
                     from_sun = glm::dvec3(noon.sun().irradiance()) * static_cast<double>(noon.sun().toward().y);
    EXPECT_GT(from_sky.g / (from_sky.g + from_sun.g), 0.06);
    EXPECT_LT(from_sky.g / (from_sky.g + from_sun.g), 0.25);
    const Environment evening = make_physical_sky(sky_direction(1.0, 0.0));
    const glm::vec3 beside = evening.radiance(sky_direction(3.0, 0.0));
    EXPECT_TRUE(beside.r > 1.3f * beside.g && beside.g > 1.5f * beside.b) << beside.r << ' ' << beside.g << ' ' << beside.b;
}

}  // namespace
}  // namespace zoe::test
