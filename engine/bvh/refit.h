#pragma once

#include "engine/bvh/bvh.h"

namespace zoe {

/// Makes every box fit its primitives again, bottom up; the topology stays.
/// boxes      [primitive_count] same count and order as when built; empty boxes (non-finite primitives) add nothing.
/// Cost       O(nodes), one pass from the back, no allocation.
/// Source     Wald, Boulos, Shirley. Ray Tracing Deformable Scenes Using Dynamic Bounding Volume Hierarchies. TOG 2007.
void refit(Bvh& bvh, std::span<const Aabb> boxes);

}  // namespace zoe
