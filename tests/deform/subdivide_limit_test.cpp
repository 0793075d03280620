// Limit positions, normals, and vertices that are there several times for their sake.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>

#include "tests/deform/subdivide_surface.h"

namespace zoe::test {
namespace {

TEST(SubdivideLimit, SharpCubeStaysACubeWithANormalEachSide) {
    PolygonMesh mesh = cube();
    for (const auto& [edge, sides] : mesh.edge_faces()) mesh.creases[edge] = 10.0;
    const Surface surface = surface_of(mesh, {.level = 3});
    EXPECT_TRUE(contains(surface.positions, {1, 1, 1}));
    // 6 sides of 9 x 9 vertices of their own.
    EXPECT_EQ(surface.positions.size(), 6u * 81);
    for (size_t v = 0; v < surface.positions.size(); ++v) {
        const glm::vec3 p = surface.positions[v], n = surface.normals[v];
        EXPECT_NEAR(glm::max(glm::max(std::abs(p.x), std::abs(p.y)), std::abs(p.z)), 1.0f, 1e-6f);
        EXPECT_NEAR(glm::dot(p, n), 1.0f, 1e-5f);
        EXPECT_NEAR(glm::max(glm::max(std::abs(n.x), std::abs(n.y)), std::abs(n.z)), 1.0f, 1e-5f);
    }
}

TEST(SubdivideLimit, LimitPointsAreThoseOfDeepRefinement) {
    // A vertex keeps its limit, at whatever level it is asked for; refinement comes nearer to it.
    const uint64_t seed = 604;
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Rng rng(seed);
    for (const SubdivisionScheme scheme : {SubdivisionScheme::kCatmullClark, SubdivisionScheme::kLoop}) {
        for (int round = 0; round < 6; ++round) {
            PolygonMesh mesh = random_closed(rng, 3, scheme == SubdivisionScheme::kLoop ? 3 : 0);
            // Creases in closed loops: at the end of one, the mask of a limit is an approximation.
            if (round % 2 == 1) {
                for (size_t k = 0; k < mesh.faces[0].size(); ++k)
                    mesh.creases[edge_of(mesh.faces[0][k], mesh.faces[0][(k + 1) % mesh.faces[0].size()])] = 10.0;
            }
            const Surface coarse = surface_of(mesh, {.level = 1}, scheme), fine = surface_of(mesh, {.level = 4}, scheme);
            const Surface deep = surface_of(mesh, refined_to(6), scheme);
            for (const glm::vec3& p : coarse.positions) {
                float exact = 1e30f, near = 1e30f;
                for (const glm::vec3& q : fine.positions) exact = std::min(exact, glm::length(p - q));
                for (const glm::vec3& q : deep.positions) near = std::min(near, glm::length(p - q));
                ASSERT_LT(exact, 2e-6f);
                ASSERT_LT(near, 2e-3f);
            }
        }
    }
}

TEST(SubdivideLimit, NormalsAreThoseOfFineFacets) {
    const uint64_t seed = 605;
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Rng rng(seed);
    for (int round = 0; round < 12; ++round) {
        const bool is_loop = round % 3 == 2;
        PolygonMesh mesh = random_closed(rng, 2, is_loop ? 3 : 0);
        for (const auto& [edge, sides] : mesh.edge_faces()) {
            if (round >= 6 && rng.below(4) == 0) mesh.creases[edge] = 10.0;
        }
        const Surface surface =
            surface_of(mesh, {.level = 6}, is_loop ? SubdivisionScheme::kLoop : SubdivisionScheme::kCatmullClark);
        std::vector<glm::dvec3> facets(surface.positions.size(), glm::dvec3(0.0));
        std::vector<int> facet_count(facets.size(), 0);
        for (const glm::uvec3& t : surface.topology.corners) {
            const glm::dvec3 a = surface.positions[t[0]], b = surface.positions[t[1]], c = surface.positions[t[2]];
            for (int k = 0; k < 3; ++k) facets[t[k]] += glm::normalize(glm::cross(b - a, c - a)), ++facet_count[t[k]];
        }
        size_t bent_count = 0;
        for (size_t v = 0; v < facets.size(); ++v) {
            ASSERT_NEAR(glm::length(surface.normals[v]), 1.0f, 1e-5f);
            // Where facets disagree (the surface folds, or bends without bound near a sharp corner) they say nothing.
            const bool is_bent = glm::length(facets[v]) < 0.99 * facet_count[v];
            bent_count += is_bent;
            if (is_bent) continue;
            ASSERT_GT(glm::dot(glm::normalize(facets[v]), glm::dvec3(surface.normals[v])), 0.98)
                << "round " << round << " vertex " << v;
        }
        EXPECT_LT(bent_count, facets.size() / 500) << "round " << round;
    }
}

/// A sheet of random heights, with a crease of two edges that ends at its middle.
constexpr uint32_t kMiddle = 12;
PolygonMesh creased_sheet(Rng& rng, double sharpness) {
    PolygonMesh mesh = sheet(4);
    for (glm::dvec3& p : mesh.points) p.z = rng.uniform(-1.0f, 1.0f);
    mesh.creases[edge_of(kMiddle, kMiddle - 1)] = mesh.creases[edge_of(kMiddle - 1, kMiddle - 2)] = sharpness;
    return mesh;
}

/// Where a vertex with four quads goes in the end: by the mask of a smooth one, on a mesh that was refined by the textbook.
glm::dvec3 smooth_limit(const PolygonMesh& mesh, uint32_t vertex) {
    glm::dvec3 sum = 16.0 * mesh.points[vertex];
    for (const std::vector<uint32_t>& face : mesh.faces) {
        const auto at = std::find(face.begin(), face.end(), vertex) - face.begin();
        if (at == 4) continue;
        for (const int next : {1, 3}) sum += 2.0 * mesh.points[face[(at + next) % 4]];  // Each is in two of the faces.
        sum += mesh.points[face[(at + 2) % 4]];
    }
    return sum / 36.0;
}

double distance_to(const Surface& surface, const glm::dvec3& place) {
    double least = 1e30;
    for (const glm::vec3& p : surface.positions) least = std::min(least, glm::distance(glm::dvec3(p), place));
    return least;
}

TEST(SubdivideLimit, EndsOfCreasesThatLevelsUseUpAreExact) {
    const uint64_t seed = 607;
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Rng rng(seed);
    for (const double sharpness : {0.5, 1.0, 1.5, 2.0}) {
        const PolygonMesh mesh = creased_sheet(rng, sharpness);
        const glm::dvec3 expected = smooth_limit(mesh.catmull_clark().catmull_clark(), kMiddle);
        for (const int level : {2, 3, 4}) {
            EXPECT_LT(distance_to(surface_of(mesh, {.level = level}), expected), 2e-6) << sharpness << ", level " << level;
        }
    }
}

/// Of infinite ones, the limit is an approximation: both it and the limit are weighted means of what is around the end,
/// which halves with each level.
TEST(SubdivideLimit, EndsOfSharpCreasesComeNearer) {
    const uint64_t seed = 608;
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Rng rng(seed);
    double worst = 0.0;
    for (int round = 0; round < 4; ++round) {
        const PolygonMesh mesh = creased_sheet(rng, 20.0);
        PolygonMesh deep = mesh;
        for (int level = 0; level < 5; ++level) deep = deep.catmull_clark();
        const glm::dvec3 expected = smooth_limit(deep, kMiddle);
        constexpr double kOfDeep = 1e-4;  // What is left of it after five levels.
        double error = 0.01;              // Of an edge's length, with one level.
        for (const int level : {1, 2, 3}) {
            const double found = distance_to(surface_of(mesh, {.level = level}), expected);
            EXPECT_LT(found, error + kOfDeep) << "round " << round << ", level " << level;
            error = 0.5 * found;
            worst = std::max(worst, found);
        }
    }
    EXPECT_GT(worst, 10.0 * 1e-4) << "nothing was compared";
}

TEST(SubdivideLimit, CopiesAtSeamsAndCreasesAreOnePoint) {
    const uint64_t seed = 606;
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Rng rng(seed);
    for (const bool is_limit : {false, true}) {
        PolygonMesh mesh = random_closed(rng, 10, 0);
        for (const auto& [edge, sides] : mesh.edge_faces()) {
            if (rng.below(3) == 0) mesh.creases[edge] = 10.0;
        }
        Cage cage = mesh.cage();
        for (size_t k = 0; k < cage.vertices.size(); ++k) {  // Every face has its own island.
            cage.uvs[0].corners.push_back(uint32_t(k));
            cage.uvs[0].values.push_back({rng.uniform(), rng.uniform()});
        }
        const Surface split = surface_of(cage, mesh.positions(), {.level = 2, .limit_positions = is_limit});
        const Surface whole = surface_of(mesh, {.level = 2, .limit_positions = is_limit, .normals = false});
        const auto bits_before = [](const glm::vec3& a, const glm::vec3& b) {
            return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
        };
        const std::set<glm::vec3, decltype(bits_before)> points(split.positions.begin(), split.positions.end(), bits_before);
        EXPECT_EQ(points.size(), whole.positions.size());
        EXPECT_GT(split.positions.size(), whole.positions.size() + 100);
        EXPECT_EQ(split.topology.uvs[0].size(), split.positions.size());
        for (const glm::vec2& uv : split.topology.uvs[0])
            EXPECT_TRUE(uv.x >= -0.01f && uv.x <= 1.01f && uv.y >= -0.01f && uv.y <= 1.01f);
    }
}

}  // namespace
}  // namespace zoe::test
