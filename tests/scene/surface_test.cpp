// extras.subdivision: cages of subdivision surfaces in glTF files.

#include <array>
#include <set>

#include <gtest/gtest.h>

#include "engine/frame/frame.h"
#include "tests/scene/glb_builder.h"

namespace zoe::test {
namespace {

using nlohmann::json;

/// A cube of side 2 as exporters write it: each side has its own four vertices with their normals and texture coordinates,
/// and two triangles (0, 1, 2), (0, 2, 3) that begin at the same vertex.
struct CubeFile {
    std::vector<float> positions, normals, uvs;
    std::vector<uint16_t> indices;
    json primitive;
    GlbBuilder glb;

    /// Texture coordinates without a seam.
    std::vector<float> positions_xy() const {
        std::vector<float> xy;
        for (size_t i = 0; i < positions.size(); i += 3) xy.insert(xy.end(), {positions[i] + 0.0f, positions[i + 1] + 0.0f});
        return xy;
    }

    explicit CubeFile(json subdivision, bool is_encoded = true) {
        constexpr int kSides[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
        for (int side = 0; side < 6; ++side) {
            for (int k = 0; k < 4; ++k) {
                const int corner = kSides[side][k];
                for (int axis = 0; axis < 3; ++axis) {
                    // Half of the zeros of a mirrored file are negative.
                    positions.push_back(corner >> axis & 1 ? 2.0f : side % 2 ? -0.0f : 0.0f);
                    normals.push_back(axis == side / 2 ? 1.0f : 0.0f);
                }
                uvs.insert(uvs.end(), {float(k == 1 || k == 2), float(k / 2)});
            }
            for (const int k : {0, 1, 2, 0, 2, 3}) indices.push_back(static_cast<uint16_t>(4 * side + k));
        }
        primitive = {{"attributes",
                      {{"POSITION", glb.floats(positions, "VEC3")},
                       {"NORMAL", glb.floats(normals, "VEC3")},
                       {"TEXCOORD_0", glb.floats(uvs, "VEC2")},
                       {"TEXCOORD_3", glb.floats(positions_xy(), "VEC2")}}},
                     {"indices", glb.accessor(indices, kUshort, "SCALAR", indices.size())}};
        if (is_encoded) primitive["extensions"]["FB_ngon_encoding"] = json::object();
        glb.push("nodes", {{"mesh", glb.mesh(primitive)}});
        glb.json["meshes"][0]["extras"]["subdivision"] = std::move(subdivision);
        glb.json["extensionsUsed"] = {"FB_ngon_encoding"};
    }
};

constexpr const char* kPlace = "/meshes/0/extras/subdivision";

void expect_error(const GlbBuilder& glb, const std::string& place, const std::string& reason) {
    const std::string error = glb.error();
    EXPECT_NE(error.find(place), std::string::npos) << error;
    EXPECT_NE(error.find(reason), std::string::npos) << error;
}

TEST(SurfaceFile, SplitVerticesAreOneAndNgonsArePolygons) {
    Scene scene = CubeFile(json{{"level", 1}}).glb.load();
    EXPECT_TRUE(scene.warnings().empty()) << scene.warnings().begin()->first;
    const Mesh& mesh = scene.meshes[0];
    ASSERT_TRUE(mesh.surface.has_value());
    const Cage& cage = mesh.surface->cage;
    EXPECT_EQ(mesh.positions.size(), 8u);
    EXPECT_EQ(cage.face_sizes, std::vector<uint32_t>(6, 4));
    EXPECT_EQ(cage.scheme, SubdivisionScheme::kCatmullClark);
    EXPECT_EQ(mesh.surface->options.level, 1);
    ASSERT_EQ(cage.uvs[0].corners.size(), 24u);
    for (size_t k = 0; k < 24; ++k) {
        EXPECT_EQ(cage.uvs[0].values[cage.uvs[0].corners[k]], glm::vec2(float(k % 4 == 1 || k % 4 == 2), float(k % 4 / 2)));
    }
    EXPECT_LT(cage.uvs[0].values.size(), 24u) << "sides that meet with the same texture coordinates are no seam";
    const Tlas& tlas = advance(scene, 0.0);
    EXPECT_EQ(tlas.instances[0].mesh->corners.size(), 6u * 8);
    EXPECT_EQ(tlas.instances[0].normals.size(), tlas.instances[0].positions.size());
    // The limit of the middle of a side: 16 times the face's point at level 1, 4 times each edge's, once each corner's,
    // of 36.
    const Hit hit = closest_hit(tlas, {.origin = {1, 1, 5}, .direction = {0, 0, -1}});
    ASSERT_TRUE(hit);
    EXPECT_NEAR(5.0f - hit.t, (16 * 2.0f + 16 * 1.75f + 4 * 14.0f / 9) / 36, 1e-5f);
}

TEST(SurfaceFile, EverySetOfTextureCoordinatesIsRefined) {
    CubeFile file(json{{"level", 1}});
    file.glb.push("images", {{"uri", "missing.png"}});
    file.glb.push("textures", {{"source", 0}});
    file.glb.push("materials", {{"emissiveTexture", {{"index", 0}, {"texCoord", 3}}}});
    file.glb.json["meshes"][0]["primitives"][0]["material"] = 0;
    Scene scene = file.glb.load();
    EXPECT_EQ(scene.warnings().size(), 1u) << "the missing image";
    EXPECT_EQ(scene.meshes[0].surface->cage.uvs[3].values.size(), 8u) << "they are continuous";
    const Tlas& tlas = advance(scene, 0.0);
    const Instance& instance = tlas.instances[0];
    ASSERT_EQ(instance.mesh->uvs[0].size(), instance.positions.size());
    ASSERT_EQ(instance.mesh->uvs[3].size(), instance.positions.size());
    for (size_t v = 0; v < instance.positions.size(); ++v) {
        EXPECT_LT(glm::distance(instance.mesh->uvs[3][v], glm::vec2(instance.positions[v])), 1e-6f);
    }
}

TEST(SurfaceFile, WithoutTheEncodingFacesAreTriangles) {
    for (const char* const scheme : {"catmull-clark", "loop"}) {
        const Scene scene = CubeFile(json{{"scheme", scheme}}, false).glb.load();
        EXPECT_EQ(scene.meshes[0].surface->cage.face_sizes, std::vector<uint32_t>(12, 3));
        EXPECT_EQ(scene.meshes[0].corners.size(), 12u);
    }
    expect_error(CubeFile(json{{"scheme", "loop"}}).glb, kPlace, "face 0 has 4 vertices; Loop needs triangles");
}

TEST(SurfaceFile, CreasesAndCornersNameVerticesOfTheFile) {
    // 8 and 9 are an edge of the third side; 1 and 8 are in one place; 0 and 7 are across the cube; 99 is no vertex.
    const json rows = {{8, 9, 2.5}, {0, 7, 1}, {5, 99, 1}};
    const Scene scene = CubeFile(json{{"creases", rows}, {"corners", {{23, 10}, {24, 1}}}, {"boundary", "edge"}}).glb.load();
    const Mesh& mesh = scene.meshes[0];
    const Cage& cage = mesh.surface->cage;
    EXPECT_EQ(cage.boundary, BoundaryRule::kEdge);
    ASSERT_EQ(cage.crease_edges.size(), 1u);
    EXPECT_EQ(cage.crease_sharpness, std::vector<float>{2.5f});
    std::set<float> ends;
    for (const uint32_t v : cage.crease_edges[0]) {
        EXPECT_EQ(mesh.positions[v].y + mesh.positions[v].z, 0.0f);
        ends.insert(mesh.positions[v].x);
    }
    EXPECT_EQ(ends, (std::set<float>{0.0f, 2.0f}));
    ASSERT_EQ(cage.corner_vertices.size(), 1u);
    EXPECT_EQ(mesh.positions[cage.corner_vertices[0]], glm::vec3(0, 2, 2));
    EXPECT_EQ(scene.warnings().at("a crease of a subdivision cage on an edge that no face has: ignored"), 2u);
    EXPECT_EQ(scene.warnings().at("a corner of a subdivision cage at a vertex that no face has: ignored"), 1u);
}

TEST(SurfaceFile, NumbersThatAreNoneAreRefusedWithTheirPlace) {
    const auto error_at = [](const char* subdivision, const std::string& place, const std::string& reason) {
        expect_error(CubeFile(json::parse(subdivision)).glb, kPlace + place + ":", reason);
    };
    error_at(R"({"level": 0})", "/level", "out of range");
    error_at(R"({"level": 9})", "/level", "out of range");
    error_at(R"({"level": 1.5})", "/level", "integer");
    error_at(R"({"scheme": "bilinear"})", "/scheme", "none of");
    error_at(R"({"pixels": 0})", "/pixels", "above 0");
    error_at(R"({"pixels": "one"})", "/pixels", "number");
    error_at(R"({"boundary": 3})", "/boundary", "string");
    error_at(R"({"creases": 3})", "/creases", "array");
    error_at(R"({"creases": [[0, 1]]})", "/creases/0", "3 numbers");
    error_at(R"({"creases": [[0, 1, 1], [0, 1, -1]]})", "/creases/1", "sharpness");
    error_at(R"({"creases": [[0, 1, "sharp"]]})", "/creases/0", "sharpness");
    error_at(R"({"creases": [[0, -1, 1]]})", "/creases/0", "vertices");
    error_at(R"({"creases": [[0, 0.5, 1]]})", "/creases/0", "vertices");
    error_at(R"({"creases": [[0, "b", 1]]})", "/creases/0", "vertices");
    error_at(R"({"corners": [[0, 1, 1]]})", "/corners/0", "2 numbers");
    const Scene scene = CubeFile(json(3)).glb.load();
    EXPECT_FALSE(scene.meshes[0].surface.has_value());
    EXPECT_EQ(scene.warnings().at("extras.subdivision is not an object: ignored"), 1u);
}

/// A flat sheet of side * side quads, each two triangles, and more triangles behind them.
GlbBuilder sheet_file(uint32_t side, const std::vector<uint32_t>& more, int level) {
    GlbBuilder glb;
    std::vector<float> positions;
    std::vector<uint32_t> indices;
    for (uint32_t y = 0; y <= side; ++y) {
        for (uint32_t x = 0; x <= side; ++x) positions.insert(positions.end(), {float(x), float(y), 0.0f});
    }
    for (uint32_t y = 0; y < side; ++y) {
        for (uint32_t x = 0; x < side; ++x) {
            const uint32_t a = y * (side + 1) + x, b = a + side + 1;
            indices.insert(indices.end(), {a, a + 1, b + 1, a, b + 1, b});
        }
    }
    indices.insert(indices.end(), more.begin(), more.end());
    json primitive = {{"attributes", {{"POSITION", glb.floats(positions, "VEC3")}}},
                      {"indices", glb.accessor(indices, kUint, "SCALAR", indices.size())},
                      {"extensions", {{"FB_ngon_encoding", json::object()}}}};
    glb.push("nodes", {{"mesh", glb.mesh(primitive)}});
    glb.json["meshes"][0]["extras"]["subdivision"] = {{"level", level}};
    return glb;
}

TEST(SurfaceFile, WhatCannotBeSubdividedIsRefused) {
    EXPECT_EQ(sheet_file(2, {}, 1).error(), "");
    expect_error(sheet_file(2, {0, 1, 8}, 1), kPlace, "the same way: their windings differ");
    expect_error(sheet_file(2, {1, 0, 8, 0, 1, 7}, 1), kPlace, "more than two faces share edge (0, 1)");
    // 100 * 100 * 2 * 4^8.
    expect_error(sheet_file(100, {}, 8), kPlace, "level 8 would make 1310720000 triangles");
}

TEST(SurfaceFile, ManySmallSurfacesTogetherAreBounded) {
    GlbBuilder glb = sheet_file(8, {}, 8);  // 8 million triangles.
    for (int k = 0; k < 8; ++k) glb.push("nodes", {{"mesh", 0}});
    expect_error(glb, "", "the subdivision surfaces would have 75497472 triangles");
    // As many as are allowed, and one node more.
    GlbBuilder few = sheet_file(8, {}, 2);  // 2048 triangles.
    few.push("nodes", {{"mesh", 0}});
    EXPECT_EQ(few.load({.max_triangles = 4096}).nodes.size(), 2u);
    few.push("nodes", {{"mesh", 0}});
    try {
        few.load({.max_triangles = 4096});
        FAIL() << "a third surface loads";
    } catch (const SceneError& error) {
        EXPECT_NE(std::string(error.what()).find("would have 6144 triangles at their levels; 4096 are allowed"),
                  std::string::npos)
            << error.what();
    }
    expect_error(sheet_file(8, {}, 8), "", "would have 8388608 triangles at their levels; 4194304 are allowed");
}

TEST(SurfaceFile, FacesWithoutAnAreaAndVerticesWithoutAFaceAreLegal) {
    const Scene scene = sheet_file(2, {0, 0, 1, 4, 4, 4}, 1).load();
    EXPECT_EQ(scene.meshes[0].surface->cage.face_sizes.size(), 4u);
    EXPECT_EQ(scene.warnings().at("a face of a subdivision cage whose corners are in one place: left out"), 2u);
    GlbBuilder isolated = sheet_file(2, {}, 1);
    isolated.json["accessors"][1]["count"] = 6;  // One quad, and the sheet's other vertices.
    Scene one = isolated.load();
    EXPECT_EQ(advance(one, 0.0).instances[0].mesh->corners.size(), 8u);
}

TEST(SurfaceFile, BrokenPolygonsAreFacesOfTheirOwnWithAWarning) {
    const Scene scene = sheet_file(1, {}, 1).load();
    EXPECT_EQ(scene.meshes[0].surface->cage.face_sizes, std::vector<uint32_t>{4});
    GlbBuilder glb = sheet_file(2, {}, 1);
    // The first two begin at the same vertex, and share no edge.
    const std::vector<uint32_t> indices = {4, 0, 1, 4, 2, 5, 1, 2, 4};
    glb.json["meshes"][0]["primitives"][0]["indices"] = glb.accessor(indices, kUint, "SCALAR", indices.size());
    EXPECT_EQ(glb.load().warnings().count("FB_ngon_encoding: triangles of one polygon that share no edge: taken as faces of "
                                          "their own"),
              1u);
}

TEST(SurfaceFile, VerticesThatMoveApartStayApart) {
    CubeFile cube(json{{"level", 1}});
    std::vector<float> offsets(cube.positions.size(), 0.0f);
    for (int k = 0; k < 12; ++k) offsets[k] = -1.0f;  // The first side flies off.
    json target = {{"POSITION", cube.glb.floats(offsets, "VEC3")}};
    cube.glb.json["meshes"][0]["primitives"][0]["targets"] = {target};
    const Scene scene = cube.glb.load();
    const Mesh& mesh = scene.meshes[0];
    EXPECT_EQ(mesh.positions.size(), 12u);
    ASSERT_EQ(mesh.targets[0].positions.size(), 12u);
    int moved_count = 0;
    for (const glm::vec3& offset : mesh.targets[0].positions) moved_count += offset == glm::vec3(-1);
    EXPECT_EQ(moved_count, 4);
    EXPECT_TRUE(mesh.targets[0].normals.empty());
}

TEST(SurfaceFile, PrimitivesWeldIntoOneCageAndKeepTheirMaterials) {
    CubeFile cube(json{{"level", 2}});
    cube.glb.push("materials", {{"name", "front"}});
    cube.glb.push("materials", {{"name", "rest"}});
    json front = cube.primitive, rest = cube.primitive;
    const std::vector<uint16_t> first(cube.indices.begin(), cube.indices.begin() + 6);
    const std::vector<uint16_t> others(cube.indices.begin() + 6, cube.indices.end());
    front["indices"] = cube.glb.accessor(first, kUshort, "SCALAR", first.size());
    rest["indices"] = cube.glb.accessor(others, kUshort, "SCALAR", others.size());
    front["material"] = 0;
    rest["material"] = 1;
    cube.glb.json["meshes"][0]["primitives"] = {front, rest};
    Scene scene = cube.glb.load();
    EXPECT_EQ(scene.meshes[0].positions.size(), 8u);
    const Mesh& shown = *advance(scene, 0.0).instances[0].mesh;
    ASSERT_EQ(shown.materials.size(), 2u);
    EXPECT_EQ(shown.materials[0].end, 32u);
    EXPECT_EQ(shown.materials[0].material, MaterialId{0});
    EXPECT_EQ(shown.materials[1].end, 6u * 32);
}

}  // namespace
}  // namespace zoe::test
