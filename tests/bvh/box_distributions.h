#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "engine/math/aabb.h"
#include "engine/math/rng.h"

namespace zoe::test {

/// Where boxes are, from ordinary to nasty.
struct BoxDistribution {
    const char* name;
    std::function<Aabb(Rng&, uint32_t k, uint32_t count)> box;
};

const std::vector<BoxDistribution>& distributions();

std::vector<Aabb> boxes_of(const BoxDistribution& distribution, uint32_t count, uint64_t seed);

}  // namespace zoe::test
