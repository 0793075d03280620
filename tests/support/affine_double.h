#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace zoe::test {

/// A quaternion in glTF's order. Its arithmetic is written out here: nothing of the engine's or of GLM's is used.
struct Quaternion {
    double x = 0.0, y = 0.0, z = 0.0, w = 1.0;
};

inline double dot(const Quaternion& p, const Quaternion& q) {
    return p.x * q.x + p.y * q.y + p.z * q.z + p.w * q.w;
}

/// Returns    the quaternion with length 1; a zero one as it is.
inline Quaternion normalised(Quaternion q) {
    const double length = std::sqrt(dot(q, q));
    if (!(length > 0.0)) return q;
    return {q.x / length, q.y / length, q.z / length, q.w / length};
}

/// An affine map in double precision by columns: p -> p.x * x + p.y * y + p.z * z + t.
struct AffineDouble {
    glm::dvec3 x{1.0, 0.0, 0.0}, y{0.0, 1.0, 0.0}, z{0.0, 0.0, 1.0}, t{0.0};

    glm::dvec3 vector(const glm::dvec3& v) const { return v.x * x + v.y * y + v.z * z; }
    glm::dvec3 point(const glm::dvec3& p) const { return vector(p) + t; }
    /// By how much the map can lengthen a vector: an upper bound.
    double stretch() const { return std::sqrt(glm::dot(x, x) + glm::dot(y, y) + glm::dot(z, z)); }
};

inline AffineDouble operator*(const AffineDouble& a, const AffineDouble& b) {
    return {a.vector(b.x), a.vector(b.y), a.vector(b.z), a.point(b.t)};
}

/// Scales, then rotates, then moves.
inline AffineDouble from_trs(const glm::dvec3& translation, const Quaternion& rotation, const glm::dvec3& scale) {
    const Quaternion q = normalised(rotation);
    AffineDouble m;
    m.x = scale.x * glm::dvec3(1 - 2 * (q.y * q.y + q.z * q.z), 2 * (q.x * q.y + q.w * q.z), 2 * (q.x * q.z - q.w * q.y));
    m.y = scale.y * glm::dvec3(2 * (q.x * q.y - q.w * q.z), 1 - 2 * (q.x * q.x + q.z * q.z), 2 * (q.y * q.z + q.w * q.x));
    m.z = scale.z * glm::dvec3(2 * (q.x * q.z + q.w * q.y), 2 * (q.y * q.z - q.w * q.x), 1 - 2 * (q.x * q.x + q.y * q.y));
    m.t = translation;
    return m;
}

/// From glTF's 16 numbers, column by column.
inline AffineDouble from_columns(const std::array<double, 16>& m) {
    return {{m[0], m[1], m[2]}, {m[4], m[5], m[6]}, {m[8], m[9], m[10]}, {m[12], m[13], m[14]}};
}

}  // namespace zoe::test
