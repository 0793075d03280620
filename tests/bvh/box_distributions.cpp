#include "tests/bvh/box_distributions.h"

#include <cmath>
#include <limits>

#include "tests/math/random_inputs.h"

namespace zoe::test {

namespace {

Aabb about(Rng& rng, const glm::vec3& place, float size) {
    Aabb box;
    box.extend(place + random_point(rng, size));
    box.extend(place + random_point(rng, size));
    return box;
}

glm::vec3 random_corner(Rng& rng, uint32_t size) {
    const auto x = float(rng.below(size)), y = float(rng.below(size)), z = float(rng.below(size));
    return {x, y, z};
}

}  // namespace

const std::vector<BoxDistribution>& distributions() {
    static const std::vector<BoxDistribution> list = {
        {"spread", [](Rng& rng, uint32_t, uint32_t) { return about(rng, random_point(rng, 10), 0.5f); }},
        {"overlapping", [](Rng& rng, uint32_t, uint32_t) { return about(rng, random_point(rng, 10), 10); }},
        {"many sizes",
         [](Rng& rng, uint32_t, uint32_t) { return about(rng, random_point(rng, 10), log_uniform(rng, 1e-6, 1e3)); }},
        {"many scales",
         [](Rng& rng, uint32_t, uint32_t) {
             const float scale = log_uniform(rng, 1e-30, 1e30);
             return about(rng, random_point(rng, scale), scale);
         }},
        {"integer boxes",
         [](Rng& rng, uint32_t, uint32_t) {
             const glm::vec3 lo = random_corner(rng, 6);
             return Aabb{lo, lo + random_corner(rng, 3)};
         }},
        {"integer boxes, negative zeros",
         [](Rng& rng, uint32_t, uint32_t) {
             const glm::vec3 lo = random_corner(rng, 3) - 1.0f;
             Aabb box{lo, lo + random_corner(rng, 2)};
             for (int axis = 0; axis < 3; ++axis) {
                 if (box.lo[axis] == 0.0f && rng.below(2)) box.lo[axis] = -0.0f;
                 if (box.hi[axis] == 0.0f && rng.below(2)) box.hi[axis] = -0.0f;
             }
             return box;
         }},
        {"integer points",
         [](Rng& rng, uint32_t, uint32_t) {
             const glm::vec3 p = random_corner(rng, 7);
             return Aabb{p, p};
         }},
        {"a grid",
         [](Rng&, uint32_t k, uint32_t) {
             const glm::vec3 p(k % 8, k / 8 % 8, k / 64);
             return Aabb{p, p + 1.0f};
         }},
        {"coincident",
         [](Rng&, uint32_t, uint32_t) {
             return Aabb{{-1, 0, 2}, {1, 3, 5}};
         }},
        {"one of three",
         [](Rng& rng, uint32_t, uint32_t) {
             const auto s = float(rng.below(3));
             return Aabb{glm::vec3(-s), glm::vec3(s)};
         }},
        {"concentric",
         [](Rng& rng, uint32_t, uint32_t) {
             const float s = rng.uniform(0.1f, 10.0f);
             return Aabb{glm::vec3(-s), glm::vec3(s)};
         }},
        {"points", [](Rng& rng, uint32_t, uint32_t) { return about(rng, random_point(rng, 10), 0); }},
        {"points on a line",
         [](Rng& rng, uint32_t, uint32_t) {
             return about(rng, {rng.uniform(), 0, 0}, 0);
         }},
        {"points in a plane",
         [](Rng& rng, uint32_t, uint32_t) {
             return about(rng, {rng.uniform(), 1, rng.uniform()}, 0);
         }},
        {"boxes on a line",
         [](Rng&, uint32_t k, uint32_t) {
             return Aabb{glm::vec3(k, 0, 0), glm::vec3(k + 1, 1, 1)};
         }},
        {"ever wider apart",
         [](Rng&, uint32_t k, uint32_t) {
             const float x = std::ldexp(1.0f, int(k % 200) - 100);
             return Aabb{{x, 0, 0}, {1.5f * x, 0.1f * x, float(k / 200)}};
         }},
        {"sticks",
         [](Rng& rng, uint32_t k, uint32_t) {
             const glm::vec3 place = random_point(rng, 10);
             glm::vec3 half(0.01f);
             half[int(k % 3)] = 10.0f;
             return Aabb{place - half, place + half};
         }},
        {"one huge box over small ones",
         [](Rng& rng, uint32_t k, uint32_t count) {
             if (k == count / 2) return Aabb{glm::vec3(-100), glm::vec3(100)};
             return about(rng, random_point(rng, 10), 0.1f);
         }},
        {"16 places far apart",
         [](Rng& rng, uint32_t k, uint32_t) {
             return about(rng, glm::vec3(1e6f * float(k % 4), 1e6f * float(k / 4 % 4), 0) + random_point(rng, 10), 0.5f);
         }},
        {"half of them at 1e18",
         [](Rng& rng, uint32_t k, uint32_t) { return about(rng, random_point(rng, 10) + (k % 2 ? 1e18f : 0.0f), 0.5f); }},
        {"as huge as floats go",
         [](Rng& rng, uint32_t k, uint32_t) {
             const float s = std::numeric_limits<float>::max() * rng.uniform(0.5f, 1.0f);
             if (k % 3 == 0) return Aabb{glm::vec3(-s), glm::vec3(s)};
             if (k % 3 == 1) return Aabb{glm::vec3(-s, 0, 0), glm::vec3(s, 0, 0)};
             return Aabb{glm::vec3(s, s, 0), glm::vec3(s, s, 0)};
         }},
        {"denormal", [](Rng& rng, uint32_t, uint32_t) { return about(rng, random_point(rng, 1e-40f), 1e-41f); }},
    };
    return list;
}

std::vector<Aabb> boxes_of(const BoxDistribution& distribution, uint32_t count, uint64_t seed) {
    Rng rng(seed);
    std::vector<Aabb> boxes;
    for (uint32_t k = 0; k < count; ++k) boxes.push_back(distribution.box(rng, k, count));
    return boxes;
}

}  // namespace zoe::test
