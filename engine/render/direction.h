#pragma once

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace zoe {

/// The largest magnitude among the coordinates.
inline float largest(const glm::vec3& v) {
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

/// Unit length at any scale; the fallback for zero and non-finite vectors.
inline glm::vec3 unit_or(const glm::vec3& v, const glm::vec3& fallback) {
    const float size = largest(v);
    const bool is_finite = std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
    return size > 0.0f && is_finite ? glm::normalize(v / size) : fallback;
}

/// Two vectors that make an orthonormal, right-handed frame with a unit vector: x, y, z = (tangent, bitangent, normal).
/// Source     Duff et al. Building an Orthonormal Basis, Revisited. JCGT 2017.
inline void make_frame(const glm::vec3& normal, glm::vec3* tangent, glm::vec3* bitangent) {
    const float sign = std::copysign(1.0f, normal.z);
    const float a = -1.0f / (sign + normal.z);
    const float b = normal.x * normal.y * a;
    *tangent = {1.0f + sign * normal.x * normal.x * a, sign * b, -sign * normal.x};
    *bitangent = {b, sign + normal.y * normal.y * a, -normal.y};
}

/// The direction mirrored at the plane across a unit normal.
inline glm::vec3 mirror(const glm::vec3& direction, const glm::vec3& normal) {
    return direction - 2.0f * glm::dot(direction, normal) * normal;
}

}  // namespace zoe
