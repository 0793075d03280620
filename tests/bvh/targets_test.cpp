// Every instruction set, every call: the hits of the loop over all triangles, bit for bit.

#include <bit>

#include <gtest/gtest.h>

#include "engine/bvh/traverse.h"
#include "tests/bvh/each_target.h"
#include "tests/bvh/inputs.h"
#include "tests/math/random_inputs.h"

namespace zoe::test {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();

bool is_same_hit(const RawHit& hit, const BlasHit& expected) {
    const auto bits = [](float x) { return std::bit_cast<uint32_t>(x); };
    return bits(hit.t) == bits(expected.t) && bits(hit.u) == bits(expected.u) && bits(hit.v) == bits(expected.v) &&
           hit.primitive == expected.primitive;
}

/// A scene of one tree, as it is.
struct OneTree {
    explicit OneTree(const Blas& blas) {
        const Aabb box = blas.tree.bounds();
        Bvh bvh;
        bvh.nodes.push_back({box.lo, 0, box.hi, 1});
        bvh.primitives.push_back(0);
        std::vector<uint32_t> slots;
        CollapseScratch scratch;
        collapse(bvh, {.block_size = 1, .max_leaf_blocks = 1}, &top, &slots, &scratch);
        placed = {.bounds_world = box, .blas = &blas, .id = 3, .is_identity = true};
        levels = {&top, &placed, top.stack_size() + blas.tree.stack_size() + 1};
    }
    WideBvh top;
    PlacedBlas placed;
    TwoLevels levels;
};

/// Sixteen rays and more from near one point to a corner, an edge or the inside of a triangle and close by.
std::vector<Ray> coherent_rays(const TestMesh& mesh, int packet_count, uint64_t seed) {
    std::vector<Ray> rays;
    Rng rng(seed);
    for (const Ray& ray : rays_at(mesh, packet_count, seed)) {
        const glm::vec3 target = ray.origin + ray.direction;
        const float size = glm::length(ray.direction);
        for (int k = 0; k < 16; ++k) {
            Ray near = ray;
            if (rng.below(2)) near.origin += 0.01f * size * random_direction(rng);
            near.direction = target + (k % 4 == 0 ? 0.0f : 0.03f * size) * random_direction(rng) - near.origin;
            rays.push_back(near);
        }
    }
    return rays;
}

void expect_batches_right(const TestMesh& mesh, const Blas& blas, const std::vector<Ray>& rays) {
    const OneTree scene(blas);
    std::vector<RawHit> hits(rays.size());
    std::vector<uint8_t> is_hit(rays.size(), 2);
    closest_hits(scene.levels, rays, hits.data(), nullptr);
    any_hits(scene.levels, rays, is_hit.data(), nullptr);
    for (size_t k = 0; k < rays.size(); ++k) {
        const BlasHit expected = brute_force(mesh, rays[k]);
        ASSERT_TRUE(is_same_hit(hits[k], expected)) << mesh.name << ", ray " << k << ": " << to_string(expected);
        ASSERT_EQ(is_hit[k], expected.primitive != kEmptyChild) << mesh.name << ", ray " << k;
        ASSERT_EQ(hits[k].id, expected.primitive == kEmptyChild ? kEmptyChild : 3u);
    }
}

TEST(Targets, SingleRaysGiveTheHitsOfTheLoopOverAllTriangles) {
    for (const TestMesh& mesh : nasty_meshes()) {
        if (mesh.corners.size() > 5000) continue;
        Blas blas;
        build_blas(mesh.positions, mesh.corners, BlasBuilder::kBinned, &blas);
        const std::vector<Ray> rays = rays_at(mesh, 160, 141);
        on_each_target([&] {
            for (size_t k = 0; k < rays.size(); ++k) {
                const BlasHit expected = brute_force(mesh, rays[k]);
                ASSERT_TRUE(is_same(closest_hit(blas, rays[k]), expected)) << mesh.name << ", ray " << k;
                ASSERT_EQ(any_hit(blas, rays[k]), expected.primitive != kEmptyChild) << mesh.name << ", ray " << k;
            }
        });
    }
}

TEST(Targets, BatchesOfAnyRaysDo) {
    for (const TestMesh& mesh : nasty_meshes()) {
        if (mesh.corners.size() > 5000) continue;
        Blas blas;
        build_blas(mesh.positions, mesh.corners, BlasBuilder::kSweep, &blas);
        const std::vector<Ray> rays = rays_at(mesh, 163, 142);
        on_each_target([&] { expect_batches_right(mesh, blas, rays); });
    }
}

TEST(Targets, BatchesOfCoherentRaysDo) {
    for (const TestMesh& mesh : nasty_meshes()) {
        if (mesh.corners.size() > 5000) continue;
        Blas blas;
        build_blas(mesh.positions, mesh.corners, BlasBuilder::kSweep, &blas);
        const std::vector<Ray> rays = coherent_rays(mesh, 24, 143);
        on_each_target([&] { expect_batches_right(mesh, blas, rays); });
    }
}

TEST(Targets, CoherentRaysMayHaveEndsAndBeNoRaysAmongThem) {
    const TestMesh mesh = random_soup(2000, 1.0f, 144);
    Blas blas;
    build_blas(mesh.positions, mesh.corners, BlasBuilder::kSweep, &blas);
    Rng rng(145);
    std::vector<Ray> rays = coherent_rays(mesh, 200, 146);
    const float nan = std::nanf("");
    for (Ray& ray : rays) {
        if (rng.below(3) == 0) ray.t_min = rng.uniform(0.0f, 1.2f);
        if (rng.below(3) == 0) ray.t_max = rng.uniform(0.0f, 1.5f);
        if (rng.below(100) == 0) ray.direction[int(rng.below(3))] = rng.below(2) ? nan : 0.0f;
        if (rng.below(100) == 0) ray.origin[int(rng.below(3))] = rng.below(2) ? nan : kInf;
        if (rng.below(100) == 0) (rng.below(2) ? ray.t_min : ray.t_max) = nan;
    }
    on_each_target([&] { expect_batches_right(mesh, blas, rays); });
}

}  // namespace
}  // namespace zoe::test
