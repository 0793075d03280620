#pragma once

#include "engine/math/triangle.h"

namespace zoe::test {

/// One ray at one triangle, with nothing around it.
inline bool shoot(const Ray& ray, const Triangle& triangle, TriangleHit* hit) {
    return intersect(RayFrame(ray), triangle, 0.0f, ray.t_min, ray.t_max, hit);
}

inline bool shoot(const Ray& ray, const Triangle& triangle) {
    TriangleHit hit;
    return shoot(ray, triangle, &hit);
}

}  // namespace zoe::test
