// One ray against many boxes, and against many triangles: some are hit and some are missed, in no order to be predicted.
#include <algorithm>
#include <limits>
#include <vector>

#include <glm/geometric.hpp>

#include "engine/math/triangle.h"
#include "tests/bench/harness.h"
#include "tests/math/random_inputs.h"

namespace zoe::test {

namespace {

constexpr int kCount = 4096;  // Boxes or triangles: they stay in the cache.
constexpr float kInf = std::numeric_limits<float>::infinity();

Ray slanted_ray() {
    return {.origin = {0.3f, -4.0f, 0.2f}, .direction = {0.21f, 1.3f, -0.4f}};
}

/// A point on the slanted ray, a bit off it.
glm::vec3 near_the_ray(Rng& rng, float off) {
    const Ray ray = slanted_ray();
    return ray.origin + rng.uniform(1.0f, 8.0f) * ray.direction + random_point(rng, off);
}

std::vector<Aabb> boxes_about_the_ray() {
    Rng rng(11);
    std::vector<Aabb> boxes(kCount);
    for (Aabb& box : boxes) {
        const glm::vec3 middle = near_the_ray(rng, 0.6f), half = glm::abs(random_point(rng, 1.0f));
        box = {middle - half, middle + half};
    }
    return boxes;
}

std::vector<Triangle> triangles_about_the_ray() {
    Rng rng(12);
    std::vector<Triangle> triangles(kCount);
    for (uint32_t k = 0; k < kCount; ++k) {
        const glm::vec3 middle = near_the_ray(rng, 0.3f);
        triangles[k] = {middle + random_point(rng, 1.0f), middle + random_point(rng, 1.0f), middle + random_point(rng, 1.0f),
                        k};
    }
    return triangles;
}

/// Slabs in double: a box that is entered there must be entered.
bool is_entered_in_double(const Ray& ray, const Aabb& box) {
    double t_in = 0.0, t_out = std::numeric_limits<double>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
        const double o = ray.origin[axis], d = ray.direction[axis];
        const double a = (box.lo[axis] - o) / d, b = (box.hi[axis] - o) / d;
        t_in = std::max(t_in, std::min(a, b));
        t_out = std::min(t_out, std::max(a, b));
    }
    return t_in <= t_out;
}

/// How far inside of a triangle the ray passes in double: its least barycentric coordinate.
double depth_inside(const Ray& ray, const Triangle& t) {
    const glm::dvec3 a(t.a), ab = glm::dvec3(t.b) - a, ac = glm::dvec3(t.c) - a, d(ray.direction);
    const glm::dvec3 from_a = glm::dvec3(ray.origin) - a, across = glm::cross(d, ac);
    const double determinant = glm::dot(ab, across);
    const double u = glm::dot(from_a, across) / determinant;
    const double v = glm::dot(d, glm::cross(from_a, ab)) / determinant;
    return std::min({u, v, 1.0 - u - v});
}

void check_share(benchmark::State& state, size_t hit_count) {
    state.counters["hit_share"] = static_cast<double>(hit_count) / kCount;
    if (hit_count < kCount / 10 || hit_count > kCount - kCount / 10) fail(state, "nearly all are hit, or nearly none");
}

void box_test(benchmark::State& state) {
    const std::vector<Aabb> boxes = boxes_about_the_ray();
    const RayFrame frame(slanted_ray());
    for (auto _ : state) {
        for (const Aabb& box : boxes) {
            float t = entry(frame, box.lo, box.hi, kInf);
            benchmark::DoNotOptimize(t);
        }
    }
    count_per_second(state, "boxes", boxes.size());
    size_t hit_count = 0;
    for (const Aabb& box : boxes) {
        const bool is_hit = entry(frame, box.lo, box.hi, kInf) < kInf;
        hit_count += is_hit ? 1 : 0;
        if (!is_hit && is_entered_in_double(slanted_ray(), box)) return fail(state, "a box that is entered was missed");
    }
    check_share(state, hit_count);
}

void triangle_test(benchmark::State& state) {
    const std::vector<Triangle> triangles = triangles_about_the_ray();
    const RayFrame frame(slanted_ray());
    TriangleHit hit{};
    for (auto _ : state) {
        for (const Triangle& triangle : triangles) {
            bool is_hit = intersect(frame, triangle, 0.0f, 0.0f, kInf, &hit);
            benchmark::DoNotOptimize(is_hit);
        }
    }
    count_per_second(state, "triangles", triangles.size());
    size_t hit_count = 0;
    for (const Triangle& triangle : triangles) {
        const bool is_hit = intersect(frame, triangle, 0.0f, 0.0f, kInf, &hit);
        hit_count += is_hit ? 1 : 0;
        const double depth = depth_inside(slanted_ray(), triangle);
        if (is_hit ? depth < -1e-3 : depth > 1e-3) return fail(state, "a triangle's hit is not what double precision says");
    }
    check_share(state, hit_count);
}

}  // namespace

void register_kernels() {
    benchmark::RegisterBenchmark("entry", box_test);
    benchmark::RegisterBenchmark("intersect", triangle_test);
}

}  // namespace zoe::test
