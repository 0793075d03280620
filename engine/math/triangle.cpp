#include "engine/math/triangle.h"

#include <cfloat>
#include <cmath>
#include <utility>

namespace zoe {

namespace {

// 1 / d, kept finite: for d = 0 a slab is entered at +-huge times the distance to it, and exactly at 0 on it.
float safe_inverse(float d) {
    const float inverse = 1.0f / d;
    return std::isfinite(inverse) ? inverse : std::copysign(FLT_MAX, d);
}

bool is_finite(const glm::vec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

}  // namespace

RayFrame::RayFrame(const Ray& ray) : origin(ray.origin) {
    const glm::vec3 d = ray.direction;
    const glm::vec3 size = glm::abs(d);
    inverse_direction = {safe_inverse(d.x), safe_inverse(d.y), safe_inverse(d.z)};
    kz = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
    kx = kz == 2 ? 0 : kz + 1;
    ky = kx == 2 ? 0 : kx + 1;
    if (d[kz] < 0.0f) std::swap(kx, ky);  // Keeps the winding.
    shear_x = d[kx] / d[kz];
    shear_y = d[ky] / d[kz];
    shear_z = 1.0f / d[kz];
    is_valid = is_finite(d) && is_finite(origin) && std::isfinite(shear_z) && ray.t_min >= 0.0f;
}

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
    if (u == 0.0f || v == 0.0f || w == 0.0f) {
        // On an edge in float: decide in double, where the products are exact.
        u = static_cast<float>(double(cx) * by - double(cy) * bx);
        v = static_cast<float>(double(ax) * cy - double(ay) * cx);
        w = static_cast<float>(double(bx) * ay - double(by) * ax);
    }
    if ((u < 0.0f || v < 0.0f || w < 0.0f) && (u > 0.0f || v > 0.0f || w > 0.0f)) return false;
    const float determinant = u + v + w;
    if (!(std::abs(determinant) > 0.0f)) return false;  // Zero area, or NaN.

    const float az = ray.shear_z * a[ray.kz], bz = ray.shear_z * b[ray.kz], cz = ray.shear_z * c[ray.kz];
    // Divided before they are multiplied: coordinates of 1e18 must not overflow.
    const float weight_a = u / determinant, weight_b = v / determinant, weight_c = w / determinant;
    float t = weight_a * az + weight_b * bz + weight_c * cz;
    const Aabb box = bounds(triangle);
    const float t_box = entry(ray, box.lo, box.hi, t_max);
    t = t < t_box ? t_box : t;
    t = t < t_floor ? t_floor : t;
    if (!(t >= t_min && t <= t_max)) return false;  // Also misses of the box (infinity) and NaN.
    if (!(t < std::numeric_limits<float>::infinity())) return false;
    hit->t = t;
    hit->u = weight_b;
    hit->v = weight_c;
    return true;
}

}  // namespace zoe
