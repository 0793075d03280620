#pragma once

#include <cstdint>

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

/// What a ray's box and triangle tests share: computed once a ray and space.
struct RayFrame {
    glm::vec3 origin;
    glm::vec3 inverse_direction;  ///< Infinite, with the sign of the zero, where a component is 0.
    bool is_negative[3];          ///< Sign of each component: which of a slab's planes is entered first.
    float shear_x, shear_y, shear_z;
    int kx, ky, kz;  ///< kz: the axis along which the direction is longest.
    bool is_valid;   ///< False for a direction shorter than 1e-30, or anything not finite: such a ray hits nothing.

    explicit RayFrame(const Ray& ray);
};

/// Slab test.
/// Returns    the entry `t` (at least 0), or +infinity on a miss. Monotone: a box that contains another is entered no
///            later, to the last bit, which is what makes hits independent of the tree.
/// Source     Ize. Robust BVH Ray Traversal. JCGT 2013. Deviation: both ends are padded, by kBoxPad.
inline float entry(const RayFrame& ray, const glm::vec3& lo, const glm::vec3& hi, float t_max);

struct TriangleHit {
    float t, u, v;  ///< The point is (1 - u - v) a + u b + v c.
};

/// Watertight ray-triangle test, both sides. Edges and vertices that triangles share are hit by at least one of them.
/// t_floor    `t` is never below this nor below the entry into the triangle's own box (see `entry`).
/// Returns    false on a miss, for non-finite triangles, and for t outside [t_min, t_max]. A triangle whose corners are on
///            one line is hit where rounding gives it a width: it may be what seals the seam between two others.
/// Source     Woop, Benthin, Wald. Watertight Ray/Triangle Intersection. JCGT 2013. Deviation: a hit must also enter the
///            triangle's box, and t is clamped to it, so that the same triangles are hit whatever the tree.
bool intersect(const RayFrame& ray, const Triangle& triangle, float t_floor, float t_min, float t_max, TriangleHit* hit);

/// Relative widening of a slab interval at each end: covers the rounding of both tests (6 ulp).
inline constexpr float kBoxPad = 6.0f * 1.1920929e-7f;

inline float entry(const RayFrame& ray, const glm::vec3& lo, const glm::vec3& hi, float t_max) {
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
