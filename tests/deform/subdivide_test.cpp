#include "engine/deform/subdivide.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "tests/deform/subdivide_surface.h"
#include "tests/math/random_inputs.h"

namespace zoe::test {
namespace {

/// Every vertex lies where the oracle has one, and both have the same faces.
void expect_same(const Surface& surface, const PolygonMesh& oracle, double tolerance) {
    ASSERT_EQ(surface.positions.size(), oracle.points.size());
    std::vector<uint32_t> partner(surface.positions.size());
    for (size_t v = 0; v < partner.size(); ++v) {
        double best = 1e30;
        for (uint32_t k = 0; k < oracle.points.size(); ++k) {
            const double distance = glm::length(glm::dvec3(surface.positions[v]) - oracle.points[k]);
            if (distance < best) best = distance, partner[v] = k;
        }
        ASSERT_LT(best, tolerance) << "vertex " << v;
    }
    const size_t size = oracle.faces[0].size(), parts = size - 2;
    ASSERT_EQ(surface.topology.corners.size(), parts * oracle.faces.size());
    std::multiset<std::vector<uint32_t>> expected, actual;
    // A face as its vertices counter-clockwise from the least.
    const auto canonical = [](std::vector<uint32_t> face) {
        std::rotate(face.begin(), std::min_element(face.begin(), face.end()), face.end());
        return face;
    };
    for (const std::vector<uint32_t>& face : oracle.faces) expected.insert(canonical(face));
    for (size_t k = 0; k < surface.topology.corners.size(); k += parts) {
        const glm::uvec3 first = surface.topology.corners[k];
        std::vector<uint32_t> face = {partner[first[0]], partner[first[1]], partner[first[2]]};
        if (parts == 2) {
            const glm::uvec3 second = surface.topology.corners[k + 1];
            ASSERT_EQ(second[0], first[0]);
            ASSERT_EQ(second[1], first[2]);
            face.push_back(partner[second[2]]);
        }
        actual.insert(canonical(face));
    }
    EXPECT_TRUE(expected == actual);
}

TEST(Subdivide, CubeByHand) {
    const Surface once = surface_of(cube(), refined_to(1));
    ASSERT_EQ(once.positions.size(), 26u);
    EXPECT_EQ(once.topology.corners.size(), 48u);
    EXPECT_TRUE(contains(once.positions, {0, 0, 1}));                                  // A face point.
    EXPECT_TRUE(contains(once.positions, {0.75f, -0.75f, 0}));                         // An edge point.
    EXPECT_TRUE(contains(once.positions, glm::vec3(5.0f / 9) * glm::vec3(1, 1, -1)));  // A vertex point.
    // (9 v + 4 (sum of edge points) + (sum of face points)) / 24, of the points above.
    const Surface limit = surface_of(cube(), {.level = 1});
    EXPECT_TRUE(contains(limit.positions, glm::vec3(0.5f)));
    ASSERT_EQ(limit.topology.cage_faces.size(), 48u);
    for (size_t k = 0; k < 48; ++k) EXPECT_EQ(limit.topology.cage_faces[k], k / 8);
}

TEST(Subdivide, RandomMeshesAgreeWithTheTextbookInDouble) {
    const uint64_t seed = 601;
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Rng rng(seed);
    for (int round = 0; round < 12; ++round) {
        for (const int kind : {0, 4}) {
            const PolygonMesh mesh = random_closed(rng, round / 2, kind);
            PolygonMesh oracle = mesh;
            for (int level = 1; level <= (round < 4 ? 3 : 1); ++level) {
                oracle = oracle.catmull_clark();
                expect_same(surface_of(mesh, refined_to(level)), oracle, 2e-6);
            }
        }
        const PolygonMesh mesh = random_closed(rng, round / 2, 3);
        PolygonMesh oracle = mesh;
        for (int level = 1; level <= (round < 4 ? 3 : 1); ++level) {
            oracle = oracle.loop();
            expect_same(surface_of(mesh, refined_to(level), SubdivisionScheme::kLoop), oracle, 2e-6);
        }
    }
}

TEST(Subdivide, CreasesAgreeWithTheTextbookInDouble) {
    const uint64_t seed = 602;
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Rng rng(seed);
    for (const double sharpness : {0.0, 0.5, 1.0, 3.0, 10.0}) {
        // A loop, a lone edge (a dart at both ends), and all edges of a corner.
        for (const std::vector<Edge>& edges :
             {std::vector<Edge>{{0, 1}, {1, 3}, {2, 3}, {0, 2}}, {{4, 5}}, {{0, 1}, {0, 2}, {0, 4}}}) {
            PolygonMesh mesh = cube();
            for (glm::dvec3& p : mesh.points) p = glm::dvec3(glm::vec3(p) + random_point(rng, 0.2f));
            for (const Edge& edge : edges) mesh.creases[edge] = sharpness;
            mesh.corners[7] = sharpness;
            PolygonMesh oracle = mesh;
            for (int level = 1; level <= 3; ++level) {
                SCOPED_TRACE(::testing::Message() << "sharpness " << sharpness << ", level " << level);
                oracle = oracle.catmull_clark();
                expect_same(surface_of(mesh, refined_to(level)), oracle, 2e-6);
            }
        }
    }
}

TEST(Subdivide, BoundaryRules) {
    // On a flat sheet everything stays in the plane; the rules differ at the rim.
    const PolygonMesh mesh = sheet(4);
    Cage cage = mesh.cage();
    const auto count_inside = [](const Surface& surface, float lo, float hi) {
        size_t count = 0;
        for (const glm::vec3& p : surface.positions) {
            EXPECT_EQ(p.z, 0.0f);
            count += p.x > lo - 1e-5f && p.x < hi + 1e-5f && p.y > lo - 1e-5f && p.y < hi + 1e-5f;
        }
        return count;
    };
    const Surface cornered = surface_of(cage, mesh.positions(), {.level = 2});
    EXPECT_EQ(count_inside(cornered, 0, 4), 17u * 17);
    for (const glm::vec3& corner : {glm::vec3(0, 0, 0), {4, 0, 0}, {0, 4, 0}, {4, 4, 0}})
        EXPECT_TRUE(contains(cornered.positions, corner));
    // A uniform grid reproduces linear functions: limit points lie at quarters.
    for (const glm::vec3& p : cornered.positions) {
        if (glm::min(p.x, p.y) < 1 || glm::max(p.x, p.y) > 3) continue;
        EXPECT_NEAR(p.x * 4, std::round(p.x * 4), 1e-5f);
        EXPECT_NEAR(p.y * 4, std::round(p.y * 4), 1e-5f);
    }
    for (const glm::vec3& n : cornered.normals) EXPECT_EQ(n, glm::vec3(0, 0, 1));
    cage.boundary = BoundaryRule::kEdge;
    const Surface rounded = surface_of(cage, mesh.positions(), {.level = 2});
    EXPECT_EQ(count_inside(rounded, 0, 4), 17u * 17);
    EXPECT_TRUE(contains(rounded.positions, {2, 0, 0}));
    EXPECT_FALSE(contains(rounded.positions, {0, 0, 0}));
    EXPECT_TRUE(contains(rounded.positions, {1.0f / 6, 1.0f / 6, 0}));  // A cubic B-spline's end: (1, 4, 1) / 6.
    for (const glm::vec3& n : rounded.normals) EXPECT_EQ(n, glm::vec3(0, 0, 1));
    cage.boundary = BoundaryRule::kNone;
    const Surface inner = surface_of(cage, mesh.positions(), {.level = 2});
    EXPECT_EQ(inner.positions.size(), 9u * 9);
    EXPECT_EQ(count_inside(inner, 1, 3), 9u * 9);
}

TEST(Subdivide, AffineMapsCommute) {
    const uint64_t seed = 603;
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Rng rng(seed);
    for (int round = 0; round < 20; ++round) {
        const PolygonMesh mesh = random_closed(rng, 8, 0);
        const Affine map = random_affine(rng, 0.5, 2.0, 3.0f);
        const Surface before = surface_of(mesh, {.level = 2});
        std::vector<glm::vec3> moved;
        for (const glm::vec3& p : mesh.positions()) moved.push_back(map.point(p));
        const Surface after = surface_of(mesh.cage(), moved, {.level = 2});
        for (size_t v = 0; v < before.positions.size(); ++v)
            ASSERT_LT(glm::length(after.positions[v] - map.point(before.positions[v])), 1e-5f) << "vertex " << v;
    }
}

TEST(Subdivide, SetsOfTextureCoordinatesAreAsEachIsAlone) {
    const uint64_t seed = 608;
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Rng rng(seed);
    const PolygonMesh mesh = sheet(3);
    Cage both = mesh.cage();
    // One set in one piece; one with an island a face.
    both.uvs[1].corners = both.vertices;
    for (size_t v = 0; v < mesh.points.size(); ++v) both.uvs[1].values.push_back({rng.uniform(), rng.uniform()});
    for (uint32_t k = 0; k < both.vertices.size(); ++k) {
        both.uvs[6].corners.push_back(k);
        both.uvs[6].values.push_back({rng.uniform(), rng.uniform()});
    }
    for (const bool is_limit : {false, true}) {
        const SubdivisionOptions options{.level = 2, .limit_positions = is_limit};
        const Subdivision together = make_subdivision(both, mesh.points.size(), options);
        for (size_t set = 0; set < kMaxUvSets; ++set) {
            Cage one = mesh.cage();
            one.uvs[set] = both.uvs[set];
            const Subdivision alone = make_subdivision(one, mesh.points.size(), options);
            ASSERT_EQ(together.uvs[set].empty(), set != 1 && set != 6);
            if (together.uvs[set].empty()) continue;
            ASSERT_EQ(together.corners.size(), alone.corners.size());
            for (size_t t = 0; t < alone.corners.size(); ++t) {
                for (int k = 0; k < 3; ++k) {
                    ASSERT_EQ(together.uvs[set][together.corners[t][k]], alone.uvs[set][alone.corners[t][k]]);
                }
            }
        }
    }
}

TEST(Subdivide, TextureCoordinateRules) {
    const uint64_t seed = 607;
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Rng rng(seed);
    PolygonMesh mesh = sheet(3);
    for (glm::dvec3& p : mesh.points) p += glm::dvec3(rng.uniform(-0.2f, 0.2f), rng.uniform(-0.2f, 0.2f), 0.0);
    // One island whose coordinates are the positions: those of the same rule stay together.
    for (const UvRule rule : {UvRule::kSmooth, UvRule::kCorners, UvRule::kBoundaries, UvRule::kLinear}) {
        Cage cage = mesh.cage();
        cage.uv_rule = rule;
        cage.boundary = rule == UvRule::kSmooth ? BoundaryRule::kEdge : BoundaryRule::kEdgeAndCorner;
        cage.uvs[0].corners = cage.vertices;
        for (const glm::dvec3& p : mesh.points) cage.uvs[0].values.push_back({p.x, p.y});
        for (const bool is_limit : {false, true}) {
            const Surface surface = surface_of(cage, mesh.positions(), {.level = 1, .limit_positions = is_limit});
            ASSERT_EQ(surface.topology.uvs[0].size(), surface.positions.size());
            size_t equal_count = 0;
            for (size_t v = 0; v < surface.positions.size(); ++v)
                equal_count += glm::length(glm::vec2(surface.positions[v]) - surface.topology.uvs[0][v]) < 1e-5f;
            SCOPED_TRACE(::testing::Message() << "rule " << int(rule) << ", limit " << is_limit);
            if (rule == UvRule::kSmooth || rule == UvRule::kCorners) {
                EXPECT_EQ(equal_count, 49u);
                continue;
            }
            EXPECT_LE(equal_count, 41u);
            size_t old_count = 0, middle_count = 0, rim_count = 0;
            for (const glm::vec2& uv : surface.topology.uvs[0]) {
                const auto is_at = [&](const glm::dvec3& p) { return glm::length(glm::vec2(p) - uv) < 1e-5f; };
                for (const glm::dvec3& p : mesh.points) old_count += is_at(p);
                for (const auto& [edge, sides] : mesh.edge_faces()) {
                    const bool is_middle = is_at(0.5 * (mesh.points[edge[0]] + mesh.points[edge[1]]));
                    middle_count += is_middle;
                    rim_count += is_middle && sides.size() == 1;
                }
            }
            EXPECT_EQ(rim_count, 12u);
            EXPECT_EQ(old_count, rule == UvRule::kLinear ? 16u : 12u);
            EXPECT_EQ(middle_count, rule == UvRule::kLinear ? 24u : 12u);
        }
    }
}

TEST(Subdivide, LoopOnAnIcosahedron) {
    PolygonMesh mesh;
    const double g = (1 + std::sqrt(5.0)) / 2;
    for (const double a : {-1.0, 1.0}) {
        for (const double b : {-g, g}) mesh.points.insert(mesh.points.end(), {{0, a, b}, {a, b, 0}, {b, 0, a}});
    }
    for (uint32_t a = 0; a < 12; ++a) {
        for (uint32_t b = a + 1; b < 12; ++b) {
            for (uint32_t c = b + 1; c < 12; ++c) {
                const glm::dvec3 p = mesh.points[a], q = mesh.points[b], r = mesh.points[c];
                if (std::max({glm::length(p - q), glm::length(q - r), glm::length(r - p)}) > 2.1) continue;
                const bool is_outward = glm::dot(glm::cross(q - p, r - p), p) > 0.0;
                mesh.faces.push_back({a, is_outward ? b : c, is_outward ? c : b});
            }
        }
    }
    ASSERT_EQ(mesh.faces.size(), 20u);
    expect_same(surface_of(mesh, refined_to(2), SubdivisionScheme::kLoop), mesh.loop().loop(), 2e-6);
    const Surface limit = surface_of(mesh, {.level = 3}, SubdivisionScheme::kLoop);
    float least = 1e30f, most = 0.0f;
    for (size_t v = 0; v < limit.positions.size(); ++v) {
        least = std::min(least, glm::length(limit.positions[v]));
        most = std::max(most, glm::length(limit.positions[v]));
        EXPECT_GT(glm::dot(glm::normalize(limit.positions[v]), limit.normals[v]), 0.999f);
    }
    EXPECT_LT(most / least, 1.02f);
    // On the axes of symmetry, the old vertices' limits: their normal is the direction they lie in.
    const glm::vec3 axis = glm::normalize(glm::vec3(mesh.points[0]));
    const auto on_axis = std::find_if(limit.positions.begin(), limit.positions.end(),
                                      [&](const glm::vec3& p) { return glm::dot(glm::normalize(p), axis) > 0.999999f; });
    ASSERT_NE(on_axis, limit.positions.end());
    EXPECT_GT(glm::dot(limit.normals[on_axis - limit.positions.begin()], axis), 0.999999f);
}

TEST(Subdivide, VerticesWithoutFacesAndPolesWork) {
    PolygonMesh mesh = cube();
    mesh.points.insert(mesh.points.begin(), {1e30, 0, 0});
    mesh.points.push_back({0, 1e30, 0});
    for (std::vector<uint32_t>& face : mesh.faces) {
        for (uint32_t& v : face) ++v;
    }
    expect_same(surface_of(mesh, refined_to(2)), cube().catmull_clark().catmull_clark(), 2e-6);
    PolygonMesh cone;
    cone.points = {{0, 0, 1}};
    for (uint32_t k = 0; k < 100; ++k) {
        cone.points.push_back({std::cos(k * 0.06283185), std::sin(k * 0.06283185), 0});
        cone.faces.push_back({0, 1 + k, 1 + (k + 1) % 100});
    }
    for (const SubdivisionScheme scheme : {SubdivisionScheme::kCatmullClark, SubdivisionScheme::kLoop}) {
        const Surface surface = surface_of(cone, {.level = 2}, scheme);
        for (size_t v = 0; v < surface.positions.size(); ++v) {
            EXPECT_TRUE(glm::length(surface.positions[v]) < 2.0f);
            EXPECT_NEAR(glm::length(surface.normals[v]), 1.0f, 1e-5f);
        }
    }
}

}  // namespace
}  // namespace zoe::test
