#include "engine/math/triangle.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace zoe {

bool intersect(const RayFrame& ray, const Triangle& triangle, float t_floor, float t_min, float t_max, TriangleHit* hit) {
    // Sheared space: the ray starts at 0 and runs along +z, so the test is in 2D.
    const glm::vec3 a = triangle.a - ray.origin;
    const glm::vec3 b = triangle.b - ray.origin;
    const glm::vec3 c = triangle.c - ray.origin;
    const float ax = a[ray.kx] - ray.shear_x * a[ray.kz], ay = a[ray.ky] - ray.shear_y * a[ray.kz];
    const float bx = b[ray.kx] - ray.shear_x * b[ray.kz], by = b[ray.ky] - ray.shear_y * b[ray.kz];
    const float cx = c[ray.kx] - ray.shear_x * c[ray.kz], cy = c[ray.ky] - ray.shear_y * c[ray.kz];

    // Twice the signed areas opposite to a, b, c. An edge is computed the same way from both of its triangles.
    float u = cx * by - cy * bx;
    float v = ax * cy - ay * cx;
    float w = bx * ay - by * ax;
    // Rounding is monotone, so a float that is not 0 has the sign of the exact value: this needs no more precision.
    if ((u < 0.0f || v < 0.0f || w < 0.0f) && (u > 0.0f || v > 0.0f || w > 0.0f)) return false;
    if (u == 0.0f || v == 0.0f || w == 0.0f) {
        // On an edge in float: decide in double, where the products are exact.
        u = static_cast<float>(double(cx) * by - double(cy) * bx);
        v = static_cast<float>(double(ax) * cy - double(ay) * cx);
        w = static_cast<float>(double(bx) * ay - double(by) * ax);
        if ((u < 0.0f || v < 0.0f || w < 0.0f) && (u > 0.0f || v > 0.0f || w > 0.0f)) return false;
    }
    const float determinant = u + v + w;
    if (!(std::abs(determinant) > 0.0f)) return false;  // Zero area, or NaN.

    const float az = ray.shear_z * a[ray.kz], bz = ray.shear_z * b[ray.kz], cz = ray.shear_z * c[ray.kz];
    // Divided before they are multiplied: coordinates of 1e18 must not overflow.
    const float weight_a = u / determinant, weight_b = v / determinant, weight_c = w / determinant;
    float t = weight_a * az + weight_b * bz + weight_c * cz;
    if (!(t >= 0.0f)) return false;  // Behind, even where the box holds the origin; also NaN.
    const Aabb box = bounds(triangle);
    t = std::max({t, t_floor, entry(ray, box.lo, box.hi, t_max)});
    if (!(t >= t_min && t <= t_max && t < std::numeric_limits<float>::infinity()))
        return false;  // Also where the box is missed.
    hit->t = t;
    hit->u = weight_b;
    hit->v = weight_c;
    return true;
}

}  // namespace zoe
