#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "engine/deform/subdivide.h"
#include "tests/bvh/inputs.h"
#include "tests/math/random_inputs.h"
#include "tests/support/leaks.h"

namespace zoe::test {
namespace {

/// A sphere of radius 1: an icosahedron, each triangle split in four, `levels` times.
TestMesh icosphere(int levels) {
    TestMesh mesh{"icosphere", {}, {}};
    const float g = 0.5f * (1.0f + std::sqrt(5.0f));
    for (const float one : {-1.0f, 1.0f}) {
        for (const float golden : {-g, g}) {
            mesh.positions.insert(mesh.positions.end(), {{one, golden, 0}, {0, one, golden}, {golden, 0, one}});
        }
    }
    // Its faces are the triples of corners that are all 2 apart.
    const auto is_edge = [&](uint32_t a, uint32_t b) {
        return std::abs(glm::length(mesh.positions[a] - mesh.positions[b]) - 2.0f) < 0.1f;
    };
    for (uint32_t a = 0; a < 12; ++a) {
        for (uint32_t b = a + 1; b < 12; ++b) {
            for (uint32_t c = b + 1; c < 12; ++c) {
                if (is_edge(a, b) && is_edge(b, c) && is_edge(c, a)) mesh.corners.push_back({a, b, c});
            }
        }
    }
    for (glm::vec3& p : mesh.positions) p = glm::normalize(p);
    for (int level = 0; level < levels; ++level) {
        std::map<std::pair<uint32_t, uint32_t>, uint32_t> middles;
        const auto middle = [&](uint32_t a, uint32_t b) {
            const auto [place, is_new] = middles.try_emplace(std::minmax(a, b), uint32_t(mesh.positions.size()));
            if (is_new) mesh.positions.push_back(glm::normalize(mesh.positions[a] + mesh.positions[b]));
            return place->second;
        };
        std::vector<glm::uvec3> finer;
        for (const glm::uvec3& t : mesh.corners) {
            const uint32_t ab = middle(t.x, t.y), bc = middle(t.y, t.z), ca = middle(t.z, t.x);
            finer.insert(finer.end(), {{t.x, ab, ca}, {ab, t.y, bc}, {ca, bc, t.z}, {ab, bc, ca}});
        }
        mesh.corners = finer;
    }
    return mesh;
}

/// Around y, radius 1, the tube 0.4.
TestMesh torus(uint32_t around, uint32_t across) {
    TestMesh mesh{"torus", {}, {}};
    for (uint32_t i = 0; i < around; ++i) {
        for (uint32_t j = 0; j < across; ++j) {
            const float u = 6.2831853f * float(i) / float(around), v = 6.2831853f * float(j) / float(across);
            const float r = 1.0f + 0.4f * std::cos(v);
            mesh.positions.push_back({r * std::cos(u), 0.4f * std::sin(v), r * std::sin(u)});
        }
    }
    const auto at = [&](uint32_t i, uint32_t j) { return i % around * across + j % across; };
    for (uint32_t i = 0; i < around; ++i) {
        for (uint32_t j = 0; j < across; ++j) {
            mesh.corners.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
            mesh.corners.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
        }
    }
    return mesh;
}

TestMesh displaced(TestMesh mesh, float amount, uint64_t seed) {
    Rng rng(seed);
    for (glm::vec3& p : mesh.positions) p *= 1.0f + amount * rng.uniform();
    return mesh;
}

glm::vec3 from_outside(Rng& rng) {
    return random_direction(rng) * rng.uniform(2.0f, 6.0f);
}
glm::vec3 from_inside(Rng& rng) {
    return random_point(rng, 0.3f);
}
glm::vec3 from_inside_the_tube(Rng& rng) {
    const float angle = rng.uniform(0.0f, 6.2831853f);
    return glm::vec3(std::cos(angle), 0.0f, std::sin(angle)) + random_point(rng, 0.1f);
}

void expect_closed(const Blas& blas, const TestMesh& mesh, const std::function<glm::vec3(Rng&)>& origin, uint64_t seed,
                   uint64_t ray_count = leak_ray_count()) {
    SCOPED_TRACE(mesh.name);
    expect_no_leaks(blas, mesh.positions, mesh.corners, origin, seed, ray_count);
}

Blas blas_of(const TestMesh& mesh, BlasBuilder builder) {
    Blas blas;
    build_blas(mesh.positions, mesh.corners, builder, &blas);
    return blas;
}

TEST(Leaks, NoneInASphereFromInside) {
    const TestMesh mesh = icosphere(5);
    ASSERT_EQ(mesh.corners.size(), 20480u);
    expect_closed(blas_of(mesh, BlasBuilder::kSweep), mesh, from_inside, 141);
}

TEST(Leaks, NoneInASphereFromOutside) {
    const TestMesh mesh = icosphere(5);
    expect_closed(blas_of(mesh, BlasBuilder::kBinned), mesh, from_outside, 142);
}

TEST(Leaks, NoneInASphereFromItsCentre) {
    const TestMesh mesh = icosphere(4);
    expect_closed(
        blas_of(mesh, BlasBuilder::kBinned), mesh, [](Rng&) { return glm::vec3(0.0f); }, 143);
}

TEST(Leaks, NoneInTreesOfPieces) {
    // Long thin triangles across each other's boxes: spatial splits pay.
    TestMesh mesh = torus(96, 64);
    for (glm::vec3& p : mesh.positions) p = glm::vec3(p.x + 40.0f * p.y, p.y, p.z + 25.0f * p.y);
    const Blas blas = blas_of(mesh, BlasBuilder::kSbvh);
    EXPECT_TRUE(blas.has_pieces);
    expect_closed(
        blas, mesh, [](Rng& rng) { return from_outside(rng) * 20.0f; }, 153);
    const TestMesh sphere = icosphere(5);
    expect_closed(blas_of(sphere, BlasBuilder::kSbvh), sphere, from_inside, 154);
}

TEST(Leaks, NoneInATorusFromInsideItsTube) {
    const TestMesh mesh = torus(96, 64);
    expect_closed(blas_of(mesh, BlasBuilder::kBinned), mesh, from_inside_the_tube, 144);
}

TEST(Leaks, NoneInATorusFromOutside) {
    const TestMesh mesh = torus(96, 64);
    expect_closed(blas_of(mesh, BlasBuilder::kSweep), mesh, from_outside, 145);
}

TEST(Leaks, NoneInARoughSphereFromInside) {
    const TestMesh mesh = displaced(icosphere(5), 0.05f, 146);
    expect_closed(blas_of(mesh, BlasBuilder::kSweep), mesh, from_inside, 147);
}

/// A cube that Catmull and Clark's rules make round, moved in and out along the way from its centre.
TestMesh displaced_subdivision(int level, float amount, uint64_t seed) {
    const std::vector<glm::vec3> cage_positions = {{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1},
                                                   {-1, -1, 1},  {1, -1, 1},  {1, 1, 1},  {-1, 1, 1}};
    Cage cage;
    cage.face_sizes.assign(6, 4);
    cage.vertices = {0, 3, 2, 1, 4, 5, 6, 7, 0, 1, 5, 4, 2, 3, 7, 6, 1, 2, 6, 5, 0, 4, 7, 3};
    const Subdivision surface = make_subdivision(cage, cage_positions.size(), {.level = level, .normals = false});
    TestMesh mesh{"displaced subdivision surface", std::vector<glm::vec3>(surface.stencils.vertex_count()), surface.corners};
    evaluate(surface.stencils, cage_positions, mesh.positions, {});
    return displaced(std::move(mesh), amount, seed);
}

TEST(Leaks, NoneInADisplacedSubdivisionSurface) {
    const TestMesh mesh = displaced_subdivision(5, 0.04f, 150);
    ASSERT_EQ(mesh.corners.size(), 6u * 2 * 1024);
    expect_closed(blas_of(mesh, BlasBuilder::kSweep), mesh, from_inside, 151, leak_ray_count() / 2);
    expect_closed(blas_of(mesh, BlasBuilder::kBinned), mesh, from_outside, 152, leak_ray_count() / 2);
}

TEST(Leaks, NoneInASphereThatWasRefittedFromATwistedOne) {
    // Built over one shape, refitted to another: boxes overlap and are far from where a build would put them.
    const TestMesh after = icosphere(5);
    TestMesh before = after;
    for (glm::vec3& p : before.positions) {
        const float angle = 1.5f * p.y;
        p = {p.x * std::cos(angle) - p.z * std::sin(angle), p.y, p.x * std::sin(angle) + p.z * std::cos(angle)};
    }
    Blas blas = blas_of(before, BlasBuilder::kSweep);
    refit_blas(after.positions, after.corners, &blas);
    expect_closed(blas, after, from_inside, 148);
}

TEST(Leaks, NoneInAStretchedSphereFarFromTheOrigin) {
    TestMesh mesh = icosphere(5);
    for (glm::vec3& p : mesh.positions) p = p * glm::vec3(1000.0f, 1.0f, 30.0f) + glm::vec3(5000.0f, -3000.0f, 7000.0f);
    const auto origin = [](Rng& rng) {
        return glm::vec3(5000.0f, -3000.0f, 7000.0f) + random_point(rng, 0.3f) * glm::vec3(1000.0f, 1.0f, 30.0f);
    };
    expect_closed(blas_of(mesh, BlasBuilder::kBinned), mesh, origin, 149, leak_ray_count() / 5);
}

/// The comparator can fail: a sphere with one triangle missing leaks.
TEST(Leaks, AreSeenWhereATriangleIsMissing) {
    const TestMesh mesh = icosphere(3);
    TestMesh holed = mesh;
    holed.corners.erase(holed.corners.begin() + 100);
    const Blas blas = blas_of(holed, BlasBuilder::kSweep);
    const glm::uvec3 missing = mesh.corners[100];
    const glm::vec3 centre = (mesh.positions[missing.x] + mesh.positions[missing.y] + mesh.positions[missing.z]) / 3.0f;
    EXPECT_EQ(closest_hit(blas, {glm::vec3(0.0f), centre}).primitive, 0xffffffffu);
}

}  // namespace
}  // namespace zoe::test
