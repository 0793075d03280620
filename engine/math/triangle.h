#pragma once

#include <cmath>
#include <cstdint>
#include <utility>

#include "engine/math/aabb.h"
#include "engine/math/ray.h"

namespace zoe {

/// Three corners and the index of the triangle in its mesh, as kept in the leaves of a BLAS.
struct Triangle {
    glm::vec3 a, b, c;
    uint32_t primitive;
};

inline Aabb bounds(const Triangle& t) {
    Aabb box;
    box.extend(t.a);
    box.extend(t.b);
    box.extend(t.c);
    return box;
}

/// What a ray's box tests share: computed once a ray and space.
struct SlabRay {
    glm::vec3 origin;
    glm::vec3 inverse_direction;  ///< Infinite, with the sign of the zero, where a component is 0.
    bool is_negative[3];          ///< Sign of each component: which of a slab's planes is entered first.
    bool is_valid;  ///< False for a direction shorter than 1e-30, or anything not finite: such a ray hits nothing.

    SlabRay() = default;
    explicit SlabRay(const Ray& ray);
};

/// What its triangle tests share besides.
struct RayFrame : SlabRay {
    float shear_x, shear_y, shear_z;
    int kx, ky, kz;  ///< kz: the axis along which the direction is longest.

    RayFrame() = default;
    explicit RayFrame(const Ray& ray) : RayFrame(SlabRay(ray), ray.direction) {}
    RayFrame(const SlabRay& slabs, const glm::vec3& direction);
};

/// Below this a component's reciprocal may overflow although it matters beside the longest one.
inline constexpr float kShortestDirection = 1e-30f;

inline SlabRay::SlabRay(const Ray& ray) : origin(ray.origin), inverse_direction(1.0f / ray.direction) {
    constexpr float kMax = std::numeric_limits<float>::max();
    const glm::vec3 size = glm::abs(ray.direction), place = glm::abs(ray.origin);
    // Without branches, and false for NaN.
    is_valid = (size.x <= kMax) & (size.y <= kMax) & (size.z <= kMax) & (place.x <= kMax) & (place.y <= kMax) &
               (place.z <= kMax) & (ray.t_min >= 0.0f) &
               ((size.x >= kShortestDirection) | (size.y >= kShortestDirection) | (size.z >= kShortestDirection));
    for (int axis = 0; axis < 3; ++axis) is_negative[axis] = std::signbit(ray.direction[axis]);
}

inline RayFrame::RayFrame(const SlabRay& slabs, const glm::vec3& d) : SlabRay(slabs) {
    const glm::vec3 size = glm::abs(d);
    // By a table, as no branch on directions is foreseen: bit 0 is x > y, bit 1 x > z, bit 2 y > z.
    constexpr int kLongest[8] = {2, 2, 2, 0, 1, 2, 1, 0}, kNext[3] = {1, 2, 0}, kPrevious[3] = {2, 0, 1};
    kz = kLongest[int(size.x > size.y) | int(size.x > size.z) << 1 | int(size.y > size.z) << 2];
    // Keeps the winding.
    const bool is_backward = d[kz] < 0.0f;
    kx = is_backward ? kPrevious[kz] : kNext[kz];
    ky = is_backward ? kNext[kz] : kPrevious[kz];
    shear_x = d[kx] / d[kz];
    shear_y = d[ky] / d[kz];
    shear_z = inverse_direction[kz];
}

/// Slab test.
/// Returns    the entry `t` (at least 0), or +infinity on a miss. Monotone: a box that contains another is entered no
///            later, to the last bit, which is what makes hits independent of the tree.
/// Source     Ize. Robust BVH Ray Traversal. JCGT 2013. Deviation: both ends are padded, by kBoxPad.
inline float entry(const SlabRay& ray, const glm::vec3& lo, const glm::vec3& hi, float t_max);

struct TriangleHit {
    float t, u, v;  ///< The point is (1 - u - v) a + u b + v c.
};

/// Watertight ray-triangle test, both sides. Edges and vertices that triangles share are hit by at least one of them.
/// The corners are sheared in float; all that follows is double: t, u and v are right to an ulp of the sheared triangle, so
/// the point is on the triangle and off the ray by the rounding of its corners only, however thin the ray sees it.
/// t_floor    `t` is never below this nor below the entry into the triangle's own box (see `entry`).
/// Returns    false on a miss, for non-finite triangles, and for t outside [t_min, t_max]. A triangle whose corners are on
///            one line is hit where rounding gives it a width: it may be what seals the seam between two others.
/// Source     Woop, Benthin, Wald. Watertight Ray/Triangle Intersection. JCGT 2013. Deviation: t and weights in double; a
///            hit must also enter the triangle's box, and t is clamped to it, so that the same triangles are hit whatever
///            the tree.
bool intersect(const RayFrame& ray, const Triangle& triangle, float t_floor, float t_min, float t_max, TriangleHit* hit);

/// The corners of a triangle in a ray's sheared space, where the ray starts at 0 and runs along +z.
struct ShearedCorners {
    float x[3], y[3], z[3];
};

/// The part of `intersect` that is in double, where the products of floats are exact: signs, weights and t.
/// Returns    false where the ray passes by, the triangle has no area, or t is negative or not finite.
inline bool intersect_plane(const ShearedCorners& corners, float shear_z, TriangleHit* hit) {
    const double ax = corners.x[0], bx = corners.x[1], cx = corners.x[2];
    const double ay = corners.y[0], by = corners.y[1], cy = corners.y[2];
    // Twice the signed areas opposite to a, b, c. An edge is computed the same way from both of its triangles.
    const double u = cx * by - cy * bx, v = ax * cy - ay * cx, w = bx * ay - by * ax;
    // Without branches, as SIMD does it; false for NaN.
    const bool is_inside = ((u >= 0.0) & (v >= 0.0) & (w >= 0.0)) | ((u <= 0.0) & (v <= 0.0) & (w <= 0.0));
    const double determinant = u + v + w, inverse = 1.0 / determinant;
    const double t = (u * corners.z[0] + v * corners.z[1] + w * corners.z[2]) * inverse * shear_z;
    // No area makes an infinite inverse: t is NaN.
    if (!(is_inside & (t >= 0.0) & (t <= std::numeric_limits<float>::max()))) return false;
    *hit = {static_cast<float>(t), static_cast<float>(v * inverse), static_cast<float>(w * inverse)};
    return true;
}

/// Relative widening of a slab interval at each end: covers the rounding of both tests (6 ulp).
inline constexpr float kBoxPad = 6.0f * 1.1920929e-7f;

inline float entry(const SlabRay& ray, const glm::vec3& lo, const glm::vec3& hi, float t_max) {
    float t_in = 0.0f, t_out = std::numeric_limits<float>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
        const float first = ray.is_negative[axis] ? hi[axis] : lo[axis];
        const float last = ray.is_negative[axis] ? lo[axis] : hi[axis];
        const float t_first = (first - ray.origin[axis]) * ray.inverse_direction[axis];
        const float t_last = (last - ray.origin[axis]) * ray.inverse_direction[axis];
        // 0 * infinity is NaN: a ray that runs in the plane. Comparisons with NaN are false, and the slab does not limit it.
        t_in = t_first > t_in ? t_first : t_in;
        t_out = t_last < t_out ? t_last : t_out;
    }
    t_in *= 1.0f - kBoxPad;
    t_out *= 1.0f + kBoxPad;
    return t_in <= t_out && t_in <= t_max ? t_in : std::numeric_limits<float>::infinity();
}

}  // namespace zoe
