#include "engine/deform/cage.h"

#include <gtest/gtest.h>
#include <limits>

#include "tests/deform/subdivide_oracle.h"

namespace zoe::test {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

std::string fault_of(const PolygonMesh& mesh, SubdivisionScheme scheme = SubdivisionScheme::kCatmullClark) {
    return check(mesh.cage(scheme), mesh.points.size(), 2);
}

TEST(Cage, ProperOnesHaveNoFault) {
    const uint64_t seed = 611;
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Rng rng(seed);
    EXPECT_EQ(fault_of(cube()), "");
    EXPECT_EQ(fault_of(sheet(5)), "");
    EXPECT_EQ(fault_of(sheet(1)), "");
    for (int round = 0; round < 50; ++round) {
        EXPECT_EQ(fault_of(random_closed(rng, 20, 0)), "");
        EXPECT_EQ(fault_of(random_closed(rng, 20, 3), SubdivisionScheme::kLoop), "");
    }
    PolygonMesh isolated = cube();
    isolated.points.push_back({9, 9, 9});
    EXPECT_EQ(fault_of(isolated), "");
}

TEST(Cage, ShapesOfFacesAreChecked) {
    EXPECT_EQ(check({}, 8, 2), "the cage has no faces");
    PolygonMesh mesh = cube();
    mesh.faces[2] = {0, 1};
    EXPECT_EQ(fault_of(mesh), "face 2 has 2 vertices");
    EXPECT_EQ(fault_of(cube(), SubdivisionScheme::kLoop), "face 0 has 4 vertices; Loop needs triangles");
    mesh = cube();
    mesh.faces[3][1] = 8;
    EXPECT_EQ(fault_of(mesh), "vertex index 8 of 8");
    mesh.faces[3][1] = UINT32_MAX;
    EXPECT_EQ(fault_of(mesh), "vertex index 4294967295 of 8");
    mesh = cube();
    mesh.faces[1] = {1, 3, 1, 5};
    EXPECT_EQ(fault_of(mesh), "face 1 has vertex 1 twice");
    Cage cage = cube().cage();
    cage.vertices.pop_back();
    EXPECT_EQ(check(cage, 8, 2), "the faces have 24 corners, but there are 23 vertex indices");
    cage = cube().cage();
    cage.face_sizes.assign(6, UINT32_MAX);  // The sum does not fit 32 bits.
    EXPECT_EQ(check(cage, 8, 2), "the faces have 25769803770 corners, but there are 24 vertex indices");
}

TEST(Cage, NonManifoldOnesAreNamed) {
    PolygonMesh mesh = cube();
    mesh.points.push_back({3, 3, 3});
    mesh.faces.push_back({0, 4, 8});
    EXPECT_EQ(fault_of(mesh), "more than two faces share edge (0, 4)");
    mesh = cube();
    std::reverse(mesh.faces[4].begin(), mesh.faces[4].end());
    EXPECT_EQ(fault_of(mesh), "faces 2 and 4 run along edge (0, 1) the same way: their windings differ");
    // Two tetrahedra that share an apex, closed and open.
    mesh = {};
    mesh.points.resize(7);
    for (const uint32_t first : {1u, 4u}) {
        const uint32_t a = first, b = first + 1, c = first + 2;
        mesh.faces.insert(mesh.faces.end(), {{0, a, b}, {0, b, c}, {0, c, a}, {a, c, b}});
    }
    EXPECT_EQ(fault_of(mesh), "the faces at vertex 0 touch in that vertex only");
    mesh.faces = {{0, 1, 2}, {0, 2, 3}, {0, 4, 5}};
    EXPECT_EQ(fault_of(mesh), "the faces at vertex 0 touch in that vertex only");
}

TEST(Cage, SharpnessIsChecked) {
    PolygonMesh mesh = cube();
    mesh.creases[{0, 7}] = 2.0;
    EXPECT_EQ(fault_of(mesh), "crease 0: no face has an edge (0, 7)");
    mesh.creases = {{{0, 1}, 1.0}, {{0, 4}, double(kNan)}};
    EXPECT_EQ(fault_of(mesh), "crease 1: its sharpness is not a number of at least 0");
    mesh.creases = {{{0, 1}, -1.0}};
    EXPECT_EQ(fault_of(mesh), "crease 0: its sharpness is not a number of at least 0");
    mesh.creases = {{{0, 1}, std::numeric_limits<double>::infinity()}};
    EXPECT_EQ(fault_of(mesh), "");
    mesh.corners = {{8, 1.0}};
    EXPECT_EQ(fault_of(mesh), "corner 0: vertex index 8 of 8");
    mesh.corners = {{7, double(kNan)}};
    EXPECT_EQ(fault_of(mesh), "corner 0: its sharpness is not a number of at least 0");
    Cage cage = cube().cage();
    cage.crease_edges = {{4000000000u, 1u}};
    EXPECT_EQ(check(cage, 8, 2), "there are 0 sharpnesses for 1 creases");
    cage.crease_sharpness = {1.0f};
    EXPECT_EQ(check(cage, 8, 2), "crease 0: no face has an edge (4000000000, 1)");
    cage = cube().cage();
    cage.corner_sharpness = {1.0f};
    EXPECT_EQ(check(cage, 8, 2), "there are 1 sharpnesses for 0 corners");
}

TEST(Cage, TextureCoordinatesAreChecked) {
    Cage cage = cube().cage();
    CageUvs& uvs = cage.uvs[3];
    uvs.values = {{0, 0}, {1, 0}};
    EXPECT_EQ(check(cage, 8, 2), "there are 0 texture coordinate indices for 24 corners");
    uvs.corners.assign(24, 1);
    EXPECT_EQ(check(cage, 8, 2), "");
    uvs.corners[5] = 2;
    EXPECT_EQ(check(cage, 8, 2), "texture coordinate index 2 of 2");
    uvs.corners[5] = 0;
    uvs.values[0].x = kNan;
    EXPECT_EQ(check(cage, 8, 2), "a texture coordinate is not finite");
}

TEST(Cage, SizeIsBoundedWithoutOverflow) {
    const Cage small = cube().cage();
    for (const int level : {-1, 0, 9, 64, INT32_MAX, INT32_MIN})
        EXPECT_EQ(check(small, 8, level), "level " + std::to_string(level) + " is not 1 to 8");
    EXPECT_EQ(check(small, 8, 8), "");
    EXPECT_EQ(count_triangles(small, 0), 12u);
    EXPECT_EQ(count_triangles(small, 2), 6u * 16 * 2);
    EXPECT_EQ(count_triangles(small, 100), UINT64_MAX);
    const PolygonMesh large = sheet(200);
    EXPECT_EQ(check(large.cage(), large.points.size(), 8),
              "level 8 would make 5242880000 triangles: too many for their stencils");
    // A pole: each of its many faces follows all of the others.
    PolygonMesh pole;
    pole.points.resize(50001);
    for (uint32_t k = 0; k < 50000; ++k) pole.faces.push_back({0, 1 + k, 1 + (k + 1) % 50000});
    EXPECT_EQ(check(pole.cage(), pole.points.size(), 1), "level 1 would make 300000 triangles: too many for their stencils");
    PolygonMesh disc;
    disc.points.resize(50000);
    disc.faces.resize(1);
    for (uint32_t k = 0; k < 50000; ++k) disc.faces[0].push_back(k);
    EXPECT_EQ(check(disc.cage(), disc.points.size(), 1), "level 1 would make 100000 triangles: too many for their stencils");
}

}  // namespace
}  // namespace zoe::test
