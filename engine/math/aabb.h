#pragma once

#include <cmath>
#include <limits>

#include <glm/common.hpp>
#include <glm/vec3.hpp>

namespace zoe {

inline bool is_finite(const glm::vec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// Axis-aligned box, closed. Default: empty (lo > hi), the identity of `extend`.
struct Aabb {
    glm::vec3 lo{std::numeric_limits<float>::infinity()};
    glm::vec3 hi{-std::numeric_limits<float>::infinity()};

    void extend(const glm::vec3& point) {
        lo = glm::min(lo, point);
        hi = glm::max(hi, point);
    }
    void extend(const Aabb& box) {
        lo = glm::min(lo, box.lo);
        hi = glm::max(hi, box.hi);
    }
    bool is_empty() const { return !(lo.x <= hi.x && lo.y <= hi.y && lo.z <= hi.z); }
    bool is_finite() const { return zoe::is_finite(lo) && zoe::is_finite(hi); }
    /// Neither empty nor without end.
    bool is_proper() const { return is_finite() && !is_empty(); }
    bool contains(const glm::vec3& p) const {
        return lo.x <= p.x && p.x <= hi.x && lo.y <= p.y && p.y <= hi.y && lo.z <= p.z && p.z <= hi.z;
    }
    bool contains(const Aabb& box) const { return box.is_empty() || (contains(box.lo) && contains(box.hi)); }
    glm::vec3 centre() const { return 0.5f * lo + 0.5f * hi; }
    glm::vec3 extent() const { return hi - lo; }
    /// Half the surface area, in double so that no float box overflows; 0 for an empty box.
    double half_area() const {
        if (is_empty()) return 0.0;
        const double x = double(hi.x) - lo.x, y = double(hi.y) - lo.y, z = double(hi.z) - lo.z;
        return x * y + y * z + z * x;
    }
};

inline Aabb merge(Aabb a, const Aabb& b) {
    a.extend(b);
    return a;
}

}  // namespace zoe
