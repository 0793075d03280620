#pragma once

#include "engine/math/triangle.h"

namespace zoe::chart {

/// Triangle tests that others use, for the engine's `intersect` to stand beside. Both sides of a triangle, t >= 0; `hit` is
/// written where there is one.

/// Source     Moeller, Trumbore. Fast, Minimum Storage Ray-Triangle Intersection. JGT 1997.
bool intersect_moeller_trumbore(const Ray& ray, const Triangle& triangle, TriangleHit* hit);

/// All in float, but for edge functions that are exactly 0, which are worked out in double.
/// Source     Woop, Benthin, Wald. Watertight Ray/Triangle Intersection. JCGT 2013.
bool intersect_woop(const RayFrame& ray, const Triangle& triangle, TriangleHit* hit);

}  // namespace zoe::chart
