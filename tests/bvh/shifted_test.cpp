// Copies that are moved and not turned: their rays take what follows from directions from the world's.

#include <gtest/gtest.h>

#include <limits>

#include "tests/bvh/copies.h"
#include "tests/bvh/inputs.h"
#include "tests/math/random_inputs.h"

namespace zoe {
namespace {

using namespace test;

constexpr float kSmallest = std::numeric_limits<float>::denorm_min();

// By nothing, by next to nothing, far, along single axes, and into each other; and one that is turned.
std::vector<Affine> shifts(uint64_t seed) {
    Rng rng(seed);
    std::vector<Affine> maps = random_affines(1, 0.5, 2.0, 20.0f, seed);
    const glm::vec3 odd[] = {{},
                             {kSmallest, -kSmallest, 0.0f},
                             {0.0f, -0.0f, 1e-7f},
                             {5.0f, 0.0f, 0.0f},
                             {-0.0f, -5.0f, -0.0f},
                             {1e4f, -1e4f, 1e4f}};
    for (const glm::vec3& shift : odd) maps.push_back({glm::mat3(1.0f), shift});
    for (int k = 0; k < 12; ++k) maps.push_back({glm::mat3(1.0f), random_point(rng, 15.0f)});
    // Numbers that compare equal to those of the identity.
    maps.push_back({glm::mat3(1.0f), random_point(rng, 5.0f)});
    maps.back().linear[0].y = maps.back().linear[2].x = -0.0f;
    return maps;
}

// Sixteen at a time from about one point, to triangles of one copy.
std::vector<Ray> rays_to(const Copies& copies, const std::vector<Affine>& maps, int packet_count, uint64_t seed) {
    Rng rng(seed);
    std::vector<Ray> rays;
    for (int packet = 0; packet < packet_count; ++packet) {
        const Affine& map = maps[rng.below(static_cast<uint32_t>(maps.size()))];
        const glm::vec3 from = map.point(random_point(rng, 10.0f));
        for (int k = 0; k < 16; ++k) {
            const auto& corners = copies.mesh().corners[rng.below(static_cast<uint32_t>(copies.mesh().corners.size()))];
            Ray ray{.origin = from + random_point(rng, 0.05f)};
            ray.direction = map.point(copies.mesh().positions[corners[k % 3]]) + random_point(rng, 0.2f) - ray.origin;
            rays.push_back(ray);
        }
    }
    return rays;
}

TEST(ShiftedCopies, AreHitAsByTheWholeMap) {
    for (const uint64_t seed : {311, 312, 313}) {
        SCOPED_TRACE(::testing::Message() << "seed " << seed);
        const std::vector<Affine> maps = shifts(seed);
        const Copies copies(random_soup(120, 2.0f, seed + 10), maps);
        EXPECT_GT(expect_batches_right(copies, rays_to(copies, maps, 150, seed + 20)), 600);
    }
}

// Where the products with an identity change the sign of a 0, or make a NaN of what is not finite.
TEST(ShiftedCopies, TakeRaysWithZerosAndWorse) {
    for (const uint64_t seed : {321, 322}) {
        SCOPED_TRACE(::testing::Message() << "seed " << seed);
        Rng rng(seed);
        const std::vector<Affine> maps = shifts(seed);
        const Copies copies(random_soup(120, 2.0f, seed + 10), maps);
        std::vector<Ray> rays = rays_to(copies, maps, 120, seed + 20);
        const float odd[] = {0.0f, -0.0f, 0.0f, -0.0f, kSmallest, 1e38f, std::numeric_limits<float>::infinity(), NAN};
        for (Ray& ray : rays) {
            const uint32_t most = rng.below(4) == 0 ? 8 : 4;  // One in four is beyond use.
            for (uint32_t n = rng.below(3); n != 0; --n) {
                (rng.below(2) ? ray.origin : ray.direction)[static_cast<int>(rng.below(3))] = odd[rng.below(most)];
            }
        }
        EXPECT_GT(expect_batches_right(copies, rays), 100);
    }
}

}  // namespace
}  // namespace zoe
