#pragma once

#include <algorithm>
#include <cmath>

#include <glm/ext/vector_double3.hpp>
#include <glm/geometric.hpp>

namespace zoe::test {

/// Distance of a point from a triangle.
inline double distance(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
    const glm::dvec3 normal = glm::cross(b - a, c - a);
    const double area2 = glm::dot(normal, normal);
    double nearest = 1e300;
    const glm::dvec3 corners[] = {a, b, c};
    bool is_inside = area2 > 0.0;
    for (int k = 0; k < 3; ++k) {
        const glm::dvec3 from = corners[k], along = corners[(k + 1) % 3] - from;
        const double length2 = glm::dot(along, along);
        const double t = length2 > 0.0 ? std::clamp(glm::dot(p - from, along) / length2, 0.0, 1.0) : 0.0;
        nearest = std::min(nearest, glm::length(p - from - t * along));
        is_inside = is_inside && glm::dot(glm::cross(along, p - from), normal) >= 0.0;
    }
    return is_inside ? std::min(nearest, std::abs(glm::dot(p - a, normal)) / std::sqrt(area2)) : nearest;
}

}  // namespace zoe::test
