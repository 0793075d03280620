#include "apps/chart/triangle_tests.h"

#include <glm/geometric.hpp>

namespace zoe::chart {

bool intersect_moeller_trumbore(const Ray& ray, const Triangle& triangle, TriangleHit* hit) {
    const glm::vec3 ab = triangle.b - triangle.a, ac = triangle.c - triangle.a;
    const glm::vec3 p = glm::cross(ray.direction, ac);
    const float determinant = glm::dot(ab, p);
    if (determinant == 0.0f) return false;
    const float inverse = 1.0f / determinant;
    const glm::vec3 from_a = ray.origin - triangle.a;
    const float u = glm::dot(from_a, p) * inverse;
    if (!(u >= 0.0f && u <= 1.0f)) return false;
    const glm::vec3 q = glm::cross(from_a, ab);
    const float v = glm::dot(ray.direction, q) * inverse;
    if (!(v >= 0.0f && u + v <= 1.0f)) return false;
    const float t = glm::dot(ac, q) * inverse;
    if (!(t >= 0.0f)) return false;
    *hit = {t, u, v};
    return true;
}

bool intersect_woop(const RayFrame& ray, const Triangle& triangle, TriangleHit* hit) {
    const glm::vec3 corners[3] = {triangle.a - ray.origin, triangle.b - ray.origin, triangle.c - ray.origin};
    float x[3], y[3], z[3];
    for (int k = 0; k < 3; ++k) {
        x[k] = corners[k][ray.kx] - ray.shear_x * corners[k][ray.kz];
        y[k] = corners[k][ray.ky] - ray.shear_y * corners[k][ray.kz];
        z[k] = ray.shear_z * corners[k][ray.kz];
    }
    float u = x[2] * y[1] - y[2] * x[1], v = x[0] * y[2] - y[0] * x[2], w = x[1] * y[0] - y[1] * x[0];
    if (u == 0.0f || v == 0.0f || w == 0.0f) {
        u = static_cast<float>(double(x[2]) * y[1] - double(y[2]) * x[1]);
        v = static_cast<float>(double(x[0]) * y[2] - double(y[0]) * x[2]);
        w = static_cast<float>(double(x[1]) * y[0] - double(y[1]) * x[0]);
    }
    if ((u < 0.0f || v < 0.0f || w < 0.0f) && (u > 0.0f || v > 0.0f || w > 0.0f)) return false;
    const float determinant = u + v + w;
    if (determinant == 0.0f) return false;
    const float inverse = 1.0f / determinant, t = (u * z[0] + v * z[1] + w * z[2]) * inverse;
    if (!(t >= 0.0f)) return false;
    *hit = {t, v * inverse, w * inverse};
    return true;
}

}  // namespace zoe::chart
