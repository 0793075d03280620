#include "tests/support/rays.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace zoe::test {
namespace {

class Random {
public:
    explicit Random(uint64_t seed) : engine_(seed) {}
    double uniform(double lo, double hi) { return lo + (hi - lo) * static_cast<double>(engine_() >> 11) * 0x1p-53; }
    size_t below(size_t n) { return std::min(n - 1, static_cast<size_t>(uniform(0.0, static_cast<double>(n)))); }
    glm::dvec3 direction() {
        const double z = uniform(-1.0, 1.0), angle = uniform(0.0, 6.283185307179586), r = std::sqrt(1.0 - z * z);
        return {r * std::cos(angle), r * std::sin(angle), z};
    }

private:
    std::mt19937_64 engine_;
};

/// Volatile: g++ 12 with -O2 drops the way through float where it does two numbers at a time.
double to_float(double x) {
    const volatile float rounded = static_cast<float>(x);
    return static_cast<double>(rounded);
}
glm::dvec3 to_floats(const glm::dvec3& v) {
    return {to_float(v.x), to_float(v.y), to_float(v.z)};
}
bool is_finite(const glm::dvec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

double area(const WorldTriangle& t) {
    return 0.5 * glm::length(glm::cross(t.b - t.a, t.c - t.a));
}

/// A point of a triangle and its normal's direction (zero where it has no area).
struct Target {
    glm::dvec3 point, normal;
};

/// An axis along which a ray meets the plane of the target at more than a grazing angle.
int random_axis(const glm::dvec3& normal, Random* random) {
    const glm::dvec3 size = glm::abs(normal);
    const int axis = static_cast<int>(random->below(3));
    if (size[axis] > 0.2 * glm::length(normal)) return axis;
    return size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
}

/// Picks points on triangles: half of them evenly over the area, half evenly over the triangles.
class Surface {
public:
    explicit Surface(std::span<const WorldTriangle> triangles) {
        glm::dvec3 lo(std::numeric_limits<double>::infinity()), hi(-lo);
        double sum = 0.0;
        for (const WorldTriangle& t : triangles) {
            if (!is_finite(t.a) || !is_finite(t.b) || !is_finite(t.c)) continue;
            lo = glm::min(lo, glm::min(t.a, glm::min(t.b, t.c)));
            hi = glm::max(hi, glm::max(t.a, glm::max(t.b, t.c)));
            triangles_.push_back(&t);
            areas_.push_back(sum += area(t));
        }
        if (is_empty()) return;
        centre = 0.5 * (lo + hi);
        radius = std::max(0.5 * glm::length(hi - lo), 1e-6);
    }
    bool is_empty() const { return triangles_.empty(); }
    Target point(Random* random) const {
        size_t i = random->below(triangles_.size());
        if (random->below(2) == 0) {
            const double at = random->uniform(0.0, areas_.back());
            i = static_cast<size_t>(std::upper_bound(areas_.begin(), areas_.end(), at) - areas_.begin());
            i = std::min(i, triangles_.size() - 1);
        }
        const double s = std::sqrt(random->uniform(0.0, 1.0)), r = random->uniform(0.0, 1.0);
        const WorldTriangle& t = *triangles_[i];
        return {(1.0 - s) * t.a + s * (1.0 - r) * t.b + s * r * t.c, glm::cross(t.b - t.a, t.c - t.a)};
    }

    glm::dvec3 centre{0.0};
    double radius = 0.0;

private:
    std::vector<const WorldTriangle*> triangles_;
    std::vector<double> areas_;  ///< Summed up.
};

}  // namespace

std::vector<OracleRay> rays_around(std::span<const WorldTriangle> triangles, size_t count, uint64_t seed) {
    const Surface surface(triangles);
    std::vector<OracleRay> rays;
    if (surface.is_empty()) return rays;
    Random random(seed);
    for (size_t i = 0; i < count; ++i) {
        OracleRay ray;
        double length = surface.radius;  // About how far what is hit may be.
        if (i % 4 == 3) {
            ray.origin = to_floats(surface.centre + random.uniform(0.0, 1.0) * surface.radius * random.direction());
            ray.direction = random.direction();
        } else if (i % 4 == 2) {
            const Target target = surface.point(&random);
            const int axis = random_axis(target.normal, &random);
            const double side = random.below(2) == 0 ? 1.0 : -1.0;
            ray.origin = target.point;
            ray.origin[axis] = surface.centre[axis] - side * random.uniform(1.1, 2.0) * surface.radius;
            ray.origin = to_floats(ray.origin);
            ray.direction = glm::dvec3(0.0);
            ray.direction[axis] = side;
        } else {
            ray.origin = to_floats(surface.centre + random.uniform(1.1, 3.0) * surface.radius * random.direction());
            const glm::dvec3 to_target = surface.point(&random).point - ray.origin;
            length = glm::length(to_target);
            ray.direction = to_target / length;
        }
        const double scale = random.below(2) == 0 ? 1.0 : std::exp2(random.uniform(-8.0, 8.0));
        ray.direction = to_floats(scale * ray.direction);
        if (random.below(8) == 0) {
            ray.t_min = to_float(random.uniform(0.0, 0.5) * length / scale);
            ray.t_max = to_float(ray.t_min + random.uniform(0.0, 1.5) * length / scale);
        }
        rays.push_back(ray);
    }
    return rays;
}

}  // namespace zoe::test
