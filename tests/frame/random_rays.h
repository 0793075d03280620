#pragma once

#include <vector>

#include "engine/frame/build_tlas.h"
#include "engine/math/ray.h"
#include "engine/math/rng.h"

namespace zoe::test {

/// Through the scene and past it.
inline std::vector<Ray> rays_at(const Tlas& tlas, size_t count, uint64_t seed) {
    Rng rng(seed);
    const auto random = [&] { return glm::vec3(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1)); };
    const Aabb bounds = tlas.bounds();
    const glm::vec3 middle = 0.5f * (bounds.lo + bounds.hi), half = 0.5f * (bounds.hi - bounds.lo);
    std::vector<Ray> rays;
    for (size_t k = 0; k < count; ++k) {
        const glm::vec3 origin = middle + 2.0f * half * random();
        rays.push_back({origin, middle + half * random() - origin});
    }
    return rays;
}

}  // namespace zoe::test
