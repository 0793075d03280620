// Packets through instances: the hits of the loop over all triangles of all instances, bit for bit, and less work than the
// rays have one by one.

#include <gtest/gtest.h>
#include <glm/gtc/matrix_transform.hpp>

#include "tests/bvh/copies.h"
#include "tests/bvh/each_target.h"
#include "tests/math/random_inputs.h"

namespace zoe::test {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();

/// Packets of rays from near one point to near another, in a copy or beside it.
std::vector<Ray> coherent_rays(const Copies& copies, int packet_count, uint64_t seed) {
    std::vector<Ray> rays;
    Rng rng(seed);
    const auto count = static_cast<uint32_t>(copies.placed().size());
    const Aabb all = copies.levels().top->bounds();
    for (int packet = 0; packet < packet_count; ++packet) {
        const Aabb& box = copies.bounds()[rng.below(count)];
        const float size = 0.3f * glm::length(box.extent());
        const glm::vec3 eye = all.centre() + random_direction(rng) * all.extent();
        const glm::vec3 target = box.centre() + rng.uniform(0.0f, 1.5f) * size * random_direction(rng);
        const float origin_spread = rng.below(2) ? 0.0f : 0.01f * glm::length(all.extent());
        const float target_spread = rng.below(3) ? 0.2f * size : 3.0f * size;
        for (int k = 0; k < 16; ++k) {
            Ray ray{.origin = eye + origin_spread * random_direction(rng)};
            ray.direction = target + target_spread * random_direction(rng) - ray.origin;
            rays.push_back(ray);
        }
    }
    return rays;
}

TEST(Packets, GoThroughTurnedMirroredShearedAndScaledCopies) {
    for (const uint64_t seed : {151, 152, 153, 154}) {
        SCOPED_TRACE(::testing::Message() << "seed " << seed);
        // Of sizes that are alike, then of all sizes, a third of them overlapping.
        const double spread = seed % 2 == 0 ? 2.0 : 100.0;
        std::vector<Affine> maps = random_affines(20, 1.0 / spread, spread, 30.0f, seed);
        maps.push_back(Affine{});
        const Copies copies(random_soup(150, 2.0f, seed + 100), maps);
        const std::vector<Ray> rays = coherent_rays(copies, 150, seed + 200);
        const int hits = expect_batches_right(copies, rays);
        EXPECT_GT(hits, int(rays.size()) / 10);
        EXPECT_LT(hits, int(rays.size()));
    }
}

// Rotations and shears of little spread, as TwoLevels asks for; axes of any size.
std::vector<Affine> gentle_affines(int count, float translation, uint64_t seed) {
    Rng rng(seed);
    std::vector<Affine> maps;
    for (int k = 0; k < count; ++k) {
        Affine map{glm::mat3_cast(random_rotation(rng)), random_point(rng, translation)};
        for (int axis = 0; axis < 3; ++axis) map.linear[axis] *= random_sign(rng) * log_uniform(rng, 0.3, 3.0);
        maps.push_back(map);
    }
    return maps;
}

TEST(Packets, PartsOfCopiesGiveTheHitsOfTheWhole) {
    for (const uint64_t seed : {211, 212, 213}) {
        SCOPED_TRACE(::testing::Message() << "seed " << seed);
        std::vector<Affine> maps = gentle_affines(15, 15.0f, seed);
        maps.push_back(Affine{});
        for (const int triangle_count : {3, 150, 2000}) {
            const Copies copies(random_soup(triangle_count, 2.0f, seed + 10), maps, 1.0f, Top::kParts);
            const std::vector<Ray> rays = coherent_rays(copies, triangle_count > 1000 ? 20 : 80, seed + 20);
            EXPECT_GT(expect_batches_right(copies, rays), 10) << triangle_count << " triangles";
        }
    }
}

// Rays that graze a copy where it reaches farthest: from afar, transforms round by more than its size times an ulp.
TEST(Packets, TightBoxesCutNothingOff) {
    for (const uint64_t seed : {221, 222, 223}) {
        for (const float distance : {3.0f, 100.0f, 1e4f, 1e6f}) {
            SCOPED_TRACE(::testing::Message() << "seed " << seed << ", distance " << distance);
            const std::vector<Affine> maps = gentle_affines(12, 20.0f, seed);
            const Copies copies(random_soup(60, 2.0f, seed + 10), maps, 1.0f, Top::kTightBoxes);
            Rng rng(seed + 20);
            std::vector<Ray> rays;
            for (const Affine& map : maps) {
                for (int side = 0; side < 6; ++side) {
                    const int axis = side % 3, along = (axis + 1 + int(rng.below(2))) % 3;
                    glm::vec3 farthest(0.0f);
                    float most = -kInf;
                    for (const glm::uvec3& corners : copies.mesh().corners) {
                        for (int k = 0; k < 3; ++k) {
                            const glm::vec3 p = map.point(copies.mesh().positions[corners[k]]);
                            const float reach = side < 3 ? p[axis] : -p[axis];
                            if (reach > most) most = reach, farthest = p;
                        }
                    }
                    for (int k = 0; k < 16; ++k) {
                        Ray ray{.origin = farthest};
                        const float size = std::max(std::abs(farthest[axis]), 0.1f * distance);
                        ray.origin[axis] += 1e-7f * size * rng.uniform(-2.0f, 1.0f) * (side < 3 ? 1.0f : -1.0f);
                        ray.origin[along] += distance;
                        ray.direction = glm::vec3(0.0f);
                        ray.direction[along] = -1.0f;
                        if (k % 2 == 0) ray.direction += 1e-8f * random_direction(rng);
                        rays.push_back(ray);
                    }
                }
            }
            EXPECT_GT(expect_batches_right(copies, rays), 10);
        }
    }
}

TEST(Packets, FindNothingInFrontOfACopysBoxNorBesideIt) {
    const Copies copies(random_soup(150, 2.0f, 155), random_affines(20, 0.5, 2.0, 30.0f, 156), 0.4f);
    const std::vector<Ray> rays = coherent_rays(copies, 200, 157);
    EXPECT_GT(expect_batches_right(copies, rays), int(rays.size()) / 10);
}

// Half of the rays end in one copy, the others in the other.
TEST(Packets, GoOnWhenAllThatAreInACopyAreDone) {
    Affine left = random_affines(1, 0.9, 1.1, 0.0f, 158)[0], right = left;
    left.translation.x = -25.0f;
    right.translation.x = 25.0f;
    const Copies copies(random_soup(1500, 3.0f, 159), {left, right});
    Rng rng(160);
    std::vector<Ray> rays;
    const glm::vec3 eye(300.0f, 280.0f, 600.0f);
    for (int k = 0; k < 16 * 60; ++k) {
        const glm::vec3 target = (k % 2 == 0 ? left : right).translation + random_point(rng, 2.0f);
        rays.push_back({.origin = eye, .direction = target - eye});
    }
    EXPECT_GT(expect_batches_right(copies, rays), 16 * 50);
}

TEST(Packets, CopiesInOnePlaceAreToldApartByTheirIds) {
    const Affine map = random_affines(1, 0.5, 2.0, 5.0f, 161)[0];
    const Copies copies(random_soup(150, 2.0f, 162), {map, map, map, map});
    const std::vector<Ray> rays = coherent_rays(copies, 100, 163);
    EXPECT_GT(expect_batches_right(copies, rays), 100);
    for (const Ray& ray : rays) {
        const RawHit hit = copies.brute_force(ray);
        ASSERT_TRUE(hit.id == 1 || hit.id == kEmptyChild);
    }
}

// Rays along (1, 1, z) have no x in a space where x is the world's x - y; others there change signs or their longest axis.
TEST(Packets, MayHaveZeroAndMixedSignsInsideOfACopy) {
    Affine local_from_world;
    local_from_world.linear = glm::mat3({1, 0, 0}, {-1, 1, 0}, {0, 0, 1});
    Affine first, turned;
    ASSERT_TRUE(invert(local_from_world, &first));
    local_from_world.linear = glm::mat3({1, 0, 1}, {-1, 1, 0}, {0, 0, -1});
    ASSERT_TRUE(invert(local_from_world, &turned));
    turned.translation = {0, 0, -12};
    const Copies copies(random_soup(400, 2.0f, 171), {first, turned});
    Rng rng(172);
    std::vector<Ray> rays;
    for (int packet = 0; packet < 200; ++packet) {
        const glm::vec3 target = random_point(rng, 6.0f);
        const bool is_exact = rng.below(2);
        for (int k = 0; k < 16; ++k) {
            glm::vec3 direction{1.0f, 1.0f, 1.0f + rng.uniform(0.0f, 0.1f)};
            if (!is_exact) direction.y += rng.uniform(-0.05f, 0.05f);
            rays.push_back({.origin = target - 32.0f * glm::vec3(1, 1, 1), .direction = direction});
        }
    }
    EXPECT_GT(expect_batches_right(copies, rays), 300);
}

TEST(Packets, MayHaveEndsAndBeNoRaysAmongThem) {
    std::vector<Affine> maps = random_affines(12, 0.3, 3.0, 15.0f, 181);
    const Copies copies(random_soup(150, 2.0f, 182), maps);
    std::vector<Ray> rays = coherent_rays(copies, 300, 183);
    Rng rng(184);
    const float nan = std::nanf("");
    for (size_t packet = 0; packet < rays.size(); packet += 16) {
        const bool has_bad = rng.below(3) == 0, has_ends = rng.below(2);
        for (size_t k = packet; k < packet + 16; ++k) {
            Ray& ray = rays[k];
            if (has_ends && rng.below(2)) ray.t_min = rng.uniform(0.0f, 1.2f);
            if (has_ends && rng.below(2)) ray.t_max = rng.uniform(0.0f, 1.5f);
            if (!has_bad || rng.below(10) != 0) continue;
            ray.direction[int(rng.below(3))] = rng.below(2) ? nan : 0.0f;
            if (rng.below(3) == 0) ray.origin[int(rng.below(3))] = rng.below(2) ? nan : kInf;
            if (rng.below(3) == 0) (rng.below(2) ? ray.t_min : ray.t_max) = nan;
        }
    }
    expect_batches_right(copies, rays);
}

// In such a space the products of a packet's tests may not be finite, or rays be no rays at all.
TEST(Packets, MayMeetCopiesOfAnySize) {
    std::vector<Affine> maps;
    for (const float scale : {1e-18f, 1e-12f, 1e-3f, 1.0f, 1e3f, 1e12f, 1e18f}) {
        Affine map = random_affines(1, 0.5, 2.0, 0.0f, 191)[0];
        map.linear *= scale;
        maps.push_back(map);
    }
    const Copies copies(random_soup(150, 2.0f, 192), maps);
    Rng rng(193);
    std::vector<Ray> rays;
    for (int packet = 0; packet < 200; ++packet) {
        const float size = log_uniform(rng, 1e-18, 1e14);
        const glm::vec3 eye = 20.0f * size * random_direction(rng), target = random_point(rng, 5.0f * size);
        for (int k = 0; k < 16; ++k) {
            rays.push_back({.origin = eye, .direction = target + random_point(rng, size) - eye});
        }
    }
    EXPECT_GT(expect_batches_right(copies, rays), 100);
}

// Narrower than the triangles: wider ones are followed by streams, whose rays count one by one.
TEST(Packets, ShareTheirWayThroughCopies) {
    std::vector<Affine> maps = random_affines(30, 0.7, 1.4, 60.0f, 201);
    const Copies copies(random_soup(600, 1.0f, 202), maps);
    Rng rng(203);
    std::vector<Ray> rays;
    for (int packet = 0; packet < 300; ++packet) {
        const glm::vec3 eye = 150.0f * random_direction(rng), target = random_point(rng, 60.0f);
        for (int k = 0; k < 16; ++k) {
            rays.push_back({.origin = eye, .direction = target + 0.05f * random_direction(rng) - eye});
        }
    }
    on_each_target([&] {
        TraverseCounts together, alone;
        std::vector<RawHit> hits(rays.size());
        closest_hits(copies.levels(), rays, hits.data(), &together);
        for (size_t k = 0; k < rays.size(); ++k) closest_hits(copies.levels(), {&rays[k], 1}, &hits[k], &alone);
        EXPECT_LT(together.nodes, alone.nodes / 5);
        EXPECT_LT(together.triangles, alone.triangles / 3);
        TraverseCounts any_together, any_alone;
        std::vector<uint8_t> is_hit(rays.size());
        any_hits(copies.levels(), rays, is_hit.data(), &any_together);
        for (size_t k = 0; k < rays.size(); ++k) any_hits(copies.levels(), {&rays[k], 1}, &is_hit[k], &any_alone);
        EXPECT_LT(any_together.nodes, any_alone.nodes / 3);
    });
}

}  // namespace
}  // namespace zoe::test
