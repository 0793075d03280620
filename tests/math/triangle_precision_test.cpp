// How exact t, u and v are: to an ulp for the triangle that the ray sees, whose corners are rounded to float once.

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>
#include <glm/ext/vector_double3.hpp>

#include "engine/math/triangle.h"
#include "tests/math/random_inputs.h"

namespace zoe::test {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();

struct Shot {
    Ray ray;
    Triangle triangle;
};

/// Rays at triangles of every size, far and near, thin, and seen edge on by as little as one part in 1e7.
Shot random_shot(Rng& rng) {
    const float size = log_uniform(rng, 1e-6, 1e6);
    const glm::vec3 place = random_direction(rng) * size * log_uniform(rng, 0.01, 1e4);
    const glm::vec3 along = random_direction(rng);
    const glm::vec3 across = glm::normalize(glm::cross(along, random_direction(rng)));
    const glm::vec3 normal = glm::cross(along, across);
    const float width = log_uniform(rng, 1e-6, 1.0);
    const auto point = [&](float x, float y) { return place + size * (x * along + y * width * across); };
    Shot shot;
    shot.triangle = {point(0.0f, 0.0f), point(1.0f, 0.0f), point(rng.uniform(), 1.0f), 0};
    const float u = rng.uniform();
    const glm::vec3 target = point(u, rng.uniform() * 0.5f * u);
    const glm::vec3 in_plane = along * rng.uniform(-1.0f, 1.0f) + across * rng.uniform(-1.0f, 1.0f);
    const glm::vec3 towards = in_plane + normal * (random_sign(rng) * log_uniform(rng, 1e-7, 10.0));
    shot.ray.origin = target - towards * size * log_uniform(rng, 0.1, 100.0);
    shot.ray.direction = (target - shot.ray.origin) * log_uniform(rng, 1e-3, 1e3);
    return shot;
}

double ulp(double x) {
    const float magnitude = std::abs(static_cast<float>(x));
    return double(std::nextafter(magnitude, kInf)) - magnitude;
}

TEST(TrianglePrecision, WithinAnUlpForTheCornersThatTheRaySees) {
    const uint64_t seed = 51;
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Rng rng(seed);
    int hits = 0, thin = 0;
    for (int i = 0; i < 400000; ++i) {
        const auto [ray, triangle] = random_shot(rng);
        const RayFrame frame(ray);
        TriangleHit hit;
        if (!intersect(frame, triangle, 0.0f, 0.0f, kInf, &hit)) continue;
        long double x[3], y[3], z[3];
        const glm::vec3* const corners[3] = {&triangle.a, &triangle.b, &triangle.c};
        for (int k = 0; k < 3; ++k) {
            const glm::vec3 p = *corners[k] - ray.origin;
            // Rounded, whatever the compiler makes of the loop.
            const volatile float px = p[frame.kx], py = p[frame.ky], pz = p[frame.kz];
            const volatile float shifted_x = frame.shear_x * pz, shifted_y = frame.shear_y * pz;
            const volatile float sx = px - shifted_x, sy = py - shifted_y;
            x[k] = sx, y[k] = sy, z[k] = pz;
        }
        // The products of floats are exact, so each area is rounded once.
        const long double areas[3] = {x[2] * y[1] - y[2] * x[1], x[0] * y[2] - y[0] * x[2], x[1] * y[0] - y[1] * x[0]};
        const long double whole = areas[0] + areas[1] + areas[2];
        ASSERT_NE(whole, 0.0L) << "round " << i;
        const long double u = areas[1] / whole, v = areas[2] / whole;
        const long double t = (areas[0] * z[0] + areas[1] * z[1] + areas[2] * z[2]) / whole * frame.shear_z;
        ASSERT_LE(std::abs(hit.u - u), 0.501L * ulp(u)) << "round " << i;
        ASSERT_LE(std::abs(hit.v - v), 0.501L * ulp(v)) << "round " << i;
        const Aabb box = bounds(triangle);
        if (hit.t != entry(frame, box.lo, box.hi, kInf)) {
            const long double farthest = std::max({std::abs(z[0]), std::abs(z[1]), std::abs(z[2])});
            ASSERT_LE(std::abs(hit.t - t), 0.501L * ulp(t) + 1e-15L * farthest * std::abs(frame.shear_z)) << "round " << i;
        }
        ++hits;
        const long double longest = std::max({std::abs(areas[0]), std::abs(areas[1]), std::abs(areas[2])});
        thin += longest < 1e-7L * (x[0] * x[0] + y[0] * y[0]);
    }
    EXPECT_GT(hits, 100000);
    EXPECT_GT(thin, 1000) << "few looked thin to their rays";
}

// What trees with clipped boxes rely on: a thin look at a triangle makes t no worse.
TEST(TrianglePrecision, TheHitIsAPointOfBothTheTriangleAndTheRay) {
    const uint64_t seed = 52;
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Rng rng(seed);
    int hits = 0;
    double worst = 0.0;
    for (int i = 0; i < 400000; ++i) {
        const auto [ray, triangle] = random_shot(rng);
        const RayFrame frame(ray);
        TriangleHit hit;
        if (!intersect(frame, triangle, 0.0f, 0.0f, kInf, &hit)) continue;
        const Aabb box = bounds(triangle);
        if (hit.t == entry(frame, box.lo, box.hi, kInf)) continue;  // Moved, to where its box begins.
        ++hits;
        const glm::dvec3 o(ray.origin), d(ray.direction), a(triangle.a), b(triangle.b), c(triangle.c);
        const double u = hit.u, v = hit.v;
        const glm::dvec3 on_triangle = (1.0 - u - v) * a + u * b + v * c, on_ray = o + double(hit.t) * d;
        const double farthest = std::max({glm::length(a - o), glm::length(b - o), glm::length(c - o)});
        const double off = glm::length(on_triangle - on_ray) / (farthest * std::numeric_limits<float>::epsilon());
        ASSERT_LE(off, 3.0) << "round " << i << ", in ulps of the farthest corner's distance";
        worst = std::max(worst, off);
    }
    EXPECT_GT(hits, 100000);
    RecordProperty("worst_ulps", std::to_string(worst));
    EXPECT_GT(worst, 0.1) << "the bound is idle";
}

}  // namespace
}  // namespace zoe::test
