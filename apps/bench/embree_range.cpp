#include "apps/bench/embree_range.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

namespace zoe {
namespace {

/// Embree's own limit, FLT_LARGE, is 1.844e18: room is left for how it rounds on the way into an instance.
constexpr double kLargest = 1.84e18;

/// NaN where either is.
double larger(double a, double b) {
    return b <= a || std::isnan(a) ? a : b;
}

double largest(const glm::vec3& v) {
    return larger(larger(std::abs(double{v.x}), std::abs(double{v.y})), std::abs(double{v.z}));
}

double largest(const Aabb& box) {
    return larger(largest(box.lo), largest(box.hi));
}

/// Refuses NaN, too.
void require(double size, const char* what) {
    if (size <= kLargest) return;
    throw std::runtime_error(fmt::format("--peer embree: Embree takes coordinates up to {:g}, and {} has {:g}: leave it out",
                                         kLargest, what, size));
}

/// The largest of all items; NaN where one is.
template <typename Items, typename Size>
double greatest(const Items& items, Size&& size) {
    double most = 0.0;
    for (const auto& item : items) most = larger(most, size(item));
    return most;
}

}  // namespace

EmbreeReach reach_into(const Tlas& tlas) {
    EmbreeReach reach;
    for (const Instance& instance : tlas.instances) {
        if (instance.is_identity) continue;
        const Affine& map = instance.local_from_world;
        for (int row = 0; row < 3; ++row) {
            double sum = 0.0;
            for (int column = 0; column < 3; ++column) sum += std::abs(double{map.linear[column][row]});
            reach.stretch = std::max(reach.stretch, sum);
        }
        reach.shift = std::max(reach.shift, largest(map.translation));
    }
    return reach;
}

void require_in_embree_range(const Tlas& tlas) {
    require(
        greatest(tlas.instances, [](const Instance& i) { return larger(largest(i.bounds_local), largest(i.bounds_world)); }),
        "a vertex");
}

void require_in_embree_range(std::span<const glm::vec3> positions) {
    // Triangles with NaN or infinite corners are nothing to Embree, nor to us.
    require(greatest(positions, [](const glm::vec3& p) { return is_finite(p) ? largest(p) : 0.0; }), "a vertex");
}

void require_in_embree_range(std::span<const Ray> rays, const EmbreeReach& reach) {
    const double origin = greatest(rays, [](const Ray& ray) { return largest(ray.origin); });
    const double direction = greatest(rays, [](const Ray& ray) { return largest(ray.direction); });
    require(origin, "a ray's origin");
    require(direction, "a ray's direction");
    require(reach.stretch * origin + reach.shift, "a ray's origin in the space of an instance");
    require(reach.stretch * direction, "a ray's direction in the space of an instance");
}

}  // namespace zoe
