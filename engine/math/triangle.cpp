#include "engine/math/triangle.h"

#include <algorithm>
#include <limits>

namespace zoe {
namespace {

// As the SIMD kernels have them: the second operand where one is NaN.
float smaller(float a, float b) {
    return a < b ? a : b;
}
float larger(float a, float b) {
    return a > b ? a : b;
}

}  // namespace

bool intersect(const RayFrame& ray, const Triangle& triangle, float t_floor, float t_min, float t_max, TriangleHit* hit) {
    const glm::vec3* const corners[3] = {&triangle.a, &triangle.b, &triangle.c};
    ShearedCorners s;
    for (int k = 0; k < 3; ++k) {
        const glm::vec3 p = *corners[k] - ray.origin;
        s.x[k] = p[ray.kx] - ray.shear_x * p[ray.kz];
        s.y[k] = p[ray.ky] - ray.shear_y * p[ray.kz];
        s.z[k] = p[ray.kz];
    }
    // Areas in float first. Rounding is monotone: one that is not 0 has the sign of the exact value, so two of unlike signs
    // are a miss. Of corners more than 1.3e19 off the ray, to its side, products overflow: such a triangle may be missed, by
    // all kernels alike. With no coordinate above 3e18 there are none.
    const float u = s.x[2] * s.y[1] - s.y[2] * s.x[1];
    const float v = s.x[0] * s.y[2] - s.y[0] * s.x[2];
    const float w = s.x[1] * s.y[0] - s.y[1] * s.x[0];
    if (!(smaller(u, smaller(v, w)) >= 0.0f || larger(u, larger(v, w)) <= 0.0f)) return false;
    TriangleHit found;
    if (!intersect_plane(s, ray.shear_z, &found)) return false;
    const Aabb box = bounds(triangle);
    found.t = std::max({found.t, t_floor, entry(ray, box.lo, box.hi, t_max)});
    if (!(found.t >= t_min && found.t <= t_max && found.t < std::numeric_limits<float>::infinity()))
        return false;  // Also where the box is missed.
    *hit = found;
    return true;
}

}  // namespace zoe
