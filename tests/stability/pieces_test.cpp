// Trees whose leaves bound pieces of triangles: nothing gets through where one piece ends and the next begins.

#include <cmath>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "engine/bvh/build_sbvh.h"
#include "tests/math/random_inputs.h"
#include "tests/stability/scenes.h"
#include "tests/support/leaks.h"

namespace zoe::test {
namespace {

/// Cut wherever that saves anything, down to single triangles.
Blas blas_of_pieces(const Mesh& mesh) {
    const StaticBvh bvh = build_sbvh(
        mesh.positions, mesh.corners,
        {.max_reference_growth = 4.0f, .min_overlap = 0.0f, .bin_count = 64, .max_leaf_size = 1, .node_cost = 0.0f});
    Blas blas;
    BlasScratch scratch;
    make_blas(bvh, mesh.positions, mesh.corners, &blas, &scratch);
    return blas;
}

/// A ball that leans: its triangles lie across each other's boxes.
Mesh leaning_ball(int slices) {
    Mesh mesh = ball(slices);
    for (glm::vec3& p : mesh.positions) p = {p.x + 5.0f * p.y, p.y, p.z + 3.0f * p.y};
    return mesh;
}

/// Shoots from within and from outside.
/// size       of the ball that leans.
void expect_closed(const Mesh& mesh, const glm::vec3& centre, float size, uint64_t seed) {
    const Blas blas = blas_of_pieces(mesh);
    EXPECT_TRUE(blas.has_pieces);
    const auto from_within = [&](Rng& rng) { return centre + random_point(rng, 0.1f * size); };
    const auto from_outside = [&](Rng& rng) { return centre + random_direction(rng) * (size * rng.uniform(8.0f, 20.0f)); };
    expect_no_leaks(blas, mesh.positions, mesh.corners, from_within, seed, leak_ray_count() / 8);
    expect_no_leaks(blas, mesh.positions, mesh.corners, from_outside, seed + 1, leak_ray_count() / 8);
}

TEST(Pieces, LetNothingThroughFromTinyToHuge) {
    uint64_t seed = 211;
    for (const float size : {1e-6f, 1.0f, 1e6f}) {
        SCOPED_TRACE(size);
        Mesh mesh = leaning_ball(48);
        for (glm::vec3& p : mesh.positions) p *= size;
        expect_closed(mesh, glm::vec3(0.0f), size, seed);
        seed += 2;
    }
}

TEST(Pieces, LetNothingThroughFarFromTheOrigin) {
    const glm::vec3 centre(500.0f, -300.0f, 700.0f);
    Mesh mesh = leaning_ball(48);
    for (glm::vec3& p : mesh.positions) p += centre;
    expect_closed(mesh, centre, 1.0f, 221);
}

TEST(Pieces, LetNothingThroughInNeedles) {
    // From pole to pole a hundred times as long as wide, and at an angle to every axis. Seen from near: what rounding moves
    // the outline by is a good deal less than a needle is wide at its ends.
    Mesh mesh = ball(64);
    const glm::vec3 along = glm::normalize(glm::vec3(3, 2, 1)), u = glm::normalize(glm::cross(along, glm::vec3(0, 1, 0))),
                    v = glm::cross(along, u);
    for (glm::vec3& p : mesh.positions) p = p.x * u + 100.0f * p.y * along + p.z * v;
    const Blas blas = blas_of_pieces(mesh);
    EXPECT_TRUE(blas.has_pieces);
    const auto from_beside = [&](Rng& rng) {
        const float angle = rng.uniform(0.0f, 6.2831853f);
        return along * rng.uniform(-90.0f, 90.0f) + (std::cos(angle) * u + std::sin(angle) * v) * rng.uniform(30.0f, 100.0f);
    };
    expect_no_leaks(blas, mesh.positions, mesh.corners, from_beside, 231, leak_ray_count() / 4);
}

}  // namespace
}  // namespace zoe::test
