#include "engine/render/physical_sky.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <glm/common.hpp>
#include <glm/exponential.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>
#include <glm/trigonometric.hpp>

#include "engine/math/parallel.h"
#include "engine/scene/image.h"

namespace zoe {

namespace {

// Lengths in metres. Optical depths are vectors of red, green and blue.

constexpr int kWidth = 192, kHeight = 96;  // pixels of the map: the sky's brightest part, around the sun, is 20 degrees wide
constexpr int kViewSteps = 32, kSunSteps = 16;

constexpr double kPi = glm::pi<double>();
constexpr double kEarth = 6.371e6, kTop = kEarth + 80e3;  // radii: of the ground, and of what there is of air
constexpr double kEyeHeight = 2.0;
constexpr double kAirScale = 8.4e3, kHazeScale = 1.2e3;  // heights in which there is e times less
constexpr double kOzoneHeight = 25e3, kOzoneReach = 15e3;
constexpr double kHazeForward = 0.76;  // the mean cosine by which haze turns light
constexpr double kHazeWhite = 0.92;    // what of the light that haze meets it scatters; the rest is absorbed
constexpr double kGroundAlbedo = 0.3;

/// What air scatters on a metre at the ground, for a wavelength in metres (Rayleigh, by the refraction of air at 15 degrees
/// C).
constexpr double air_scatters(double wavelength) {
    constexpr double kRefraction = 1.000278 * 1.000278 - 1.0, kMolecules = 2.547e25;  // a cubic metre
    constexpr double kDepolarised = 1.048;                                            // molecules are no spheres
    return 8.0 * kPi * kPi * kPi * kRefraction * kRefraction * kDepolarised /
           (3.0 * kMolecules * wavelength * wavelength * wavelength * wavelength);
}
const glm::dvec3 kAir(air_scatters(680e-9), air_scatters(550e-9), air_scatters(440e-9));
/// What haze takes on a metre at the ground: a clear day's; less from longer waves, with the power 1.3.
const glm::dvec3 kHaze(3.8e-5, 5.0e-5, 6.7e-5);
/// What ozone takes on a metre where it is densest.
const glm::dvec3 kOzone(0.65e-6, 1.88e-6, 0.085e-6);

/// How much there is of air, haze and ozone: at a height in parts of the most, or along a ray in metres of that.
using Amounts = glm::dvec3;

Amounts amounts_at(double height) {
    return {std::exp(-height / kAirScale), std::exp(-height / kHazeScale),
            std::max(0.0, 1.0 - std::abs(height - kOzoneHeight) / kOzoneReach)};
}

glm::dvec3 left_after(const Amounts& amounts) {
    return glm::exp(-(amounts.x * kAir + amounts.y * kHaze + amounts.z * kOzone));
}

/// What scatters on a metre.
glm::dvec3 scattered_by(const Amounts& amounts) {
    return amounts.x * kAir + amounts.y * kHazeWhite * kHaze;
}

/// The way from a point to where the air ends.
/// r, cosine  distance from the earth's centre, and of the direction to up.
double way_out(double r, double cosine) {
    const double along = r * cosine;
    return std::sqrt(std::max(0.0, along * along + kTop * kTop - r * r)) - along;
}

bool meets_ground(double r, double cosine) {
    return cosine < 0.0 && r * r * (1.0 - cosine * cosine) < kEarth * kEarth;
}

/// Steps that grow with the way, as air gets thinner: the middle and the length of one, in parts of the whole.
struct Step {
    double middle, length;
};
Step step_of(int i, int count) {
    const double begin = static_cast<double>(i) / count, end = static_cast<double>(i + 1) / count;
    return {0.5 * (begin * begin + end * end), end * end - begin * begin};
}

/// What lies between a point and the sun.
Amounts toward_space(double r, double cosine) {
    const double way = way_out(r, cosine);
    Amounts sum(0.0);
    for (int i = 0; i < kSunSteps; ++i) {
        const Step step = step_of(i, kSunSteps);
        const double t = step.middle * way;
        sum += amounts_at(std::sqrt(r * r + t * (t + 2.0 * r * cosine)) - kEarth) * (step.length * way);
    }
    return sum;
}

/// Per steradian, by the cosine that light is turned by.
double air_phase(double cosine) {
    return 3.0 / (16.0 * kPi) * (1.0 + cosine * cosine);
}
double haze_phase(double cosine) {
    constexpr double g = kHazeForward;
    const double apart = 1.0 + g * g - 2.0 * g * cosine;
    return 3.0 / (8.0 * kPi) * (1.0 - g * g) / (2.0 + g * g) * (1.0 + cosine * cosine) / (apart * std::sqrt(apart));
}

/// Where a direction from a point leads, in steps: to where the air ends, or to the ground.
struct Way {
    double length;
    bool is_grounded;
};
Way way_of(double r, double cosine) {
    if (!meets_ground(r, cosine)) return {way_out(r, cosine), false};
    const double along = r * cosine;
    return {-along - std::sqrt(along * along - r * r + kEarth * kEarth), true};
}

/// Light that was scattered twice or more often, at heights and angles between up and the sun. Each time after the first it
/// is taken to go everywhere alike, and to meet as much as light does at the point itself: then all times add up to a
/// geometric series.
class ScatteredOften {
public:
    explicit ScatteredOften(double sun_angle) : first_angle_(sun_angle - kAngleReach) {
        parallel_for(0, entries_.size(), 1, [&](size_t begin, size_t end) {
            for (size_t i = begin; i < end; ++i) {
                const double share = static_cast<double>(i / kAngles) / (kHeights - 1);
                entries_[i] = measure(share * share * (kTop - kEarth),
                                      first_angle_ + 2.0 * kAngleReach * static_cast<double>(i % kAngles) / (kAngles - 1));
            }
        });
    }

    /// The mean radiance from all around, for a sun of irradiance 1.
    glm::dvec3 at(double height, double angle) const {
        const double h = std::sqrt(std::clamp(height / (kTop - kEarth), 0.0, 1.0)) * (kHeights - 1),
                     a = std::clamp((angle - first_angle_) / (2.0 * kAngleReach), 0.0, 1.0) * (kAngles - 1);
        const size_t i = std::min(static_cast<size_t>(h), kHeights - 2), j = std::min(static_cast<size_t>(a), kAngles - 2);
        const double hi = h - static_cast<double>(i), aj = a - static_cast<double>(j);
        const glm::dvec3* const low = &entries_[i * kAngles + j];
        return glm::mix(glm::mix(low[0], low[1], aj), glm::mix(low[kAngles], low[kAngles + 1], aj), hi);
    }

private:
    static constexpr size_t kHeights = 12, kAngles = 9;
    static constexpr double kAngleReach = 0.165;  // how far up turns along the longest way through the air
    static constexpr int kUps = 8, kRounds = 8, kSteps = 12;

    static glm::dvec3 measure(double height, double sun_angle) {
        const glm::dvec3 from(0.0, kEarth + std::clamp(height, 1.0, kTop - kEarth - 1.0), 0.0);
        const glm::dvec3 sun(std::sin(sun_angle), std::cos(sun_angle), 0.0);
        glm::dvec3 once(0.0), again(0.0);  // light scattered once from all around; what of light from everywhere comes back
        for (int i = 0; i < kUps * kRounds; ++i) {
            const double up = (i / kRounds + 0.5) * 2.0 / kUps - 1.0, round = (i % kRounds + 0.5) * kPi / kRounds;
            const double flat = std::sqrt(1.0 - up * up);
            const glm::dvec3 direction(flat * std::cos(round), up, flat * std::sin(round));  // the other half is as this one
            const Way way = way_of(from.y, up);
            Amounts behind(0.0);
            for (int k = 0; k < kSteps; ++k) {
                const Step step = step_of(k, kSteps);
                const glm::dvec3 point = from + (step.middle * way.length) * direction;
                const double r = glm::length(point), cosine = glm::dot(point, sun) / r;
                const Amounts here = amounts_at(r - kEarth), half = here * (0.5 * step.length * way.length);
                behind += half;
                const glm::dvec3 arrives = scattered_by(here) * left_after(behind) * (step.length * way.length);
                again += arrives;
                if (!meets_ground(r, cosine)) once += arrives * left_after(toward_space(r, cosine)) / (4.0 * kPi);
                behind += half;
            }
            if (!way.is_grounded) continue;
            const glm::dvec3 ground = from + way.length * direction;
            const double cosine = glm::dot(ground, sun) / kEarth;
            if (cosine > 0.0) once += left_after(behind + toward_space(kEarth, cosine)) * (kGroundAlbedo / kPi * cosine);
        }
        constexpr double kCount = kUps * kRounds;
        return once / kCount / (1.0 - again / kCount);
    }

    double first_angle_;
    std::vector<glm::dvec3> entries_ = std::vector<glm::dvec3>(kHeights * kAngles);
};

/// The radiance from above the horizon, for a sun of irradiance 1.
glm::dvec3 sky_from(const glm::dvec3& direction, const glm::dvec3& toward_sun, const ScatteredOften& often) {
    const glm::dvec3 eye(0.0, kEarth + kEyeHeight, 0.0);
    const double turned = glm::dot(direction, toward_sun);
    const glm::dvec3 by_air = kAir * air_phase(turned), by_haze = kHaze * (kHazeWhite * haze_phase(turned));
    const double way = way_out(eye.y, direction.y);
    Amounts behind(0.0);  // between the eye and the step
    glm::dvec3 radiance(0.0);
    for (int i = 0; i < kViewSteps; ++i) {
        const Step step = step_of(i, kViewSteps);
        const glm::dvec3 point = eye + (step.middle * way) * direction;
        const double r = glm::length(point), cosine = glm::dot(point, toward_sun) / r;
        const Amounts here = amounts_at(r - kEarth), half = here * (0.5 * step.length * way);
        behind += half;
        if (!meets_ground(r, cosine)) {
            const glm::dvec3 scatters = here.x * by_air + here.y * by_haze;
            radiance += scatters * left_after(behind + toward_space(r, cosine)) * (step.length * way);
        }
        radiance += scattered_by(here) * often.at(r - kEarth, std::acos(std::clamp(cosine, -1.0, 1.0))) *
                    left_after(behind) * (step.length * way);
        behind += half;
    }
    return radiance;
}

/// What of a disc is above the horizon.
/// height     of its centre, in its radii.
double share_above(double height) {
    const double h = std::clamp(height, -1.0, 1.0);
    return 1.0 - (std::acos(h) - h * std::sqrt(1.0 - h * h)) / kPi;
}

/// What arrives on a surface that faces the sun, where it would be 1 without air.
glm::dvec3 sun_left(const glm::dvec3& toward_sun) {
    const double share = share_above(std::asin(std::clamp(toward_sun.y, -1.0, 1.0)) / static_cast<double>(kSunRadius));
    return share * left_after(toward_space(kEarth + kEyeHeight, std::max(toward_sun.y, 0.0)));
}

glm::dvec3 pixel_direction(int x, int y) {
    const double down = (y + 0.5) * kPi / kHeight, round = (x + 0.5) * 2.0 * kPi / kWidth - kPi;
    return {std::sin(down) * std::sin(round), std::cos(down), -std::sin(down) * std::cos(round)};
}

}  // namespace

glm::vec3 sky_direction(double elevation_degrees, double azimuth_degrees) {
    const double up = glm::radians(elevation_degrees), round = glm::radians(azimuth_degrees);
    return glm::vec3(std::cos(up) * std::sin(round), std::sin(up), -std::cos(up) * std::cos(round));
}

Environment make_physical_sky(const glm::vec3& toward_sun) {
    constexpr int kSkyHeight = kHeight / 2;
    const glm::dvec3 sun = glm::normalize(glm::dvec3(toward_sun));
    const ScatteredOften often(std::acos(std::clamp(sun.y, -1.0, 1.0)));
    std::vector<glm::dvec3> sky(static_cast<size_t>(kSkyHeight) * kWidth);
    parallel_for(0, kSkyHeight, 1, [&](size_t begin, size_t end) {
        for (size_t i = begin * kWidth; i < end * kWidth; ++i) {
            const glm::dvec3 direction = pixel_direction(static_cast<int>(i % kWidth), static_cast<int>(i / kWidth));
            sky[i] = kPi * sky_from(direction, sun, often);
        }
    });

    const glm::dvec3 sun_irradiance = kPi * sun_left(sun);
    glm::dvec3 on_ground = sun_irradiance * std::max(sun.y, 0.0);
    for (size_t i = 0; i < sky.size(); ++i) {
        const double down = (static_cast<double>(i / kWidth) + 0.5) * kPi / kHeight;
        const double solid_angle = std::sin(down) * (kPi / kHeight) * (2.0 * kPi / kWidth);
        on_ground += sky[i] * (std::cos(down) * solid_angle);
    }
    sky.resize(static_cast<size_t>(kHeight) * kWidth, on_ground * (kGroundAlbedo / kPi));

    FloatImage picture{.width = kWidth, .height = kHeight, .channels = {"R", "G", "B"}};
    for (const glm::dvec3& radiance : sky) {
        for (int c = 0; c < 3; ++c) picture.values.push_back(static_cast<float>(radiance[c]));
    }
    return Environment(picture, Sun(glm::vec3(sun), glm::vec3(sun_irradiance)));
}

}  // namespace zoe
