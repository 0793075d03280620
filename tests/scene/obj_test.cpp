#include <fstream>

#include <gtest/gtest.h>

#include "engine/frame/frame.h"
#include "engine/scene/obj.h"
#include "tests/support/assets.h"
#include "tests/support/temp_folder.h"

namespace zoe::test {
namespace {

Scene load(const std::string& text, const ObjOptions& options = {}) {
    const TempFolder folder;
    std::ofstream(folder.path() / "mesh.obj", std::ios::binary) << text;
    return load_obj(folder.path() / "mesh.obj", options);
}

std::string error_of(const std::string& text, const ObjOptions& options = {}) {
    try {
        load(text, options);
    } catch (const SceneError& error) {
        return error.what();
    }
    return "";
}

void expect_error(const std::string& text, const std::string& part) {
    const std::string error = error_of(text);
    EXPECT_NE(error.find(part), std::string::npos) << text << " gave: " << error;
}

const std::string kCorners = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

TEST(Obj, PolygonsAreSplitFromTheirFirstCorner) {
    const Scene scene = load("# a quad\r\no quad\n" + kCorners + "vt 0 0\nvt 1 0.25\nvn 0 0 1\n" +
                             "f 1/1/1 2/2/1 3/1/1 4//1  # the end\nf -4 -3 -2\n");
    EXPECT_TRUE(scene.warnings().empty());
    const Mesh& mesh = scene.meshes[0];
    ASSERT_EQ(mesh.corners.size(), 3u);
    const auto position = [&](size_t triangle, int k) { return mesh.positions[mesh.corners[triangle][k]]; };
    EXPECT_EQ(position(1, 0), glm::vec3(0, 0, 0));
    EXPECT_EQ(position(1, 1), glm::vec3(1, 1, 0));
    EXPECT_EQ(position(1, 2), glm::vec3(0, 1, 0));
    EXPECT_EQ(position(2, 1), glm::vec3(1, 0, 0));
    EXPECT_EQ(mesh.positions.size(), 7u) << "the second polygon's corners have no normals";
    EXPECT_EQ(mesh.normals[mesh.corners[0].x], glm::vec3(0, 0, 1));
    EXPECT_EQ(mesh.normals[mesh.corners[2].x], glm::vec3(0));
    EXPECT_EQ(mesh.uvs[0][mesh.corners[0].y], glm::vec2(1, 0.75f));
}

TEST(Obj, BecomesACageWhereALevelIsAskedFor) {
    Scene scene = load(kCorners + "vt 0 0\nvt 1 0\nvt 1 1\nf 1/1 2/2 3/3 4\n", {.subdivision_level = 2});
    const Cage& cage = scene.meshes[0].surface->cage;
    EXPECT_EQ(cage.face_sizes, std::vector<uint32_t>{4});
    EXPECT_EQ(cage.uvs[0].corners, (std::vector<uint32_t>{0, 1, 2, 3}));
    EXPECT_EQ(cage.uvs[0].values[3], glm::vec2(0)) << "of the corner that has none";
    EXPECT_EQ(advance(scene, 0.0).instances[0].mesh->corners.size(), 32u);
    EXPECT_NE(error_of(kCorners + "f 1 2 3\nf 1 2 4\n", {.subdivision_level = 2}).find("the same way"), std::string::npos);
    EXPECT_NE(error_of(kCorners + "f 1 2 3 4\n", {.subdivision_level = 99}).find("level 99"), std::string::npos);
}

TEST(Obj, ErrorsNameTheLine) {
    expect_error(kCorners + "f 1 2 5\n", "mesh.obj: line 5: index 5 of 4");
    expect_error(kCorners + "f 1 2 -5\n", "line 5: index -5 of 4");
    expect_error(kCorners + "f 1 2 0\n", "line 5: index 0 of 4");
    expect_error(kCorners + "f 1 2 99999999999999999999\n", "line 5: '99999999999999999999' is not an index");
    expect_error(kCorners + "f 1 2\n", "line 5: a polygon of 2 corners");
    expect_error(kCorners + "f 1/1 2 3\n", "line 5: index 1 of 0");
    expect_error(kCorners + "f 1/ 2/ 3/x\n", "'x' is not an index");
    expect_error(kCorners + "f 1///1 2 3\n", "is not a corner");
    expect_error(kCorners + "f // 2 3\n", "names no vertex");
    expect_error("v 0 0\n", "line 1: 2 numbers, where 3 are needed");
    expect_error("v 0 0 1e\n", "'1e' is not a number");
    expect_error("v 0 0 nan\n", "'nan' is not a number");
    expect_error("v 0 0 1e99\n", "'1e99' is not a number");
    expect_error("vn 0 0 1 2\n", "more than 3 numbers");
    expect_error(kCorners, "it has no polygons");
    expect_error("", "it has no polygons");
    EXPECT_NE(error_of(kCorners + "f 1 2 3 4\n", {.max_corners = 3}).find("more than 3 corners"), std::string::npos);
    EXPECT_THROW(load_obj("no such.obj"), SceneError);
}

TEST(Obj, ReadsNumbersAsExportersWriteThem) {
    const Scene scene = load(
        "v +1 -1e-50 +1e-400\nv 1. .5 1E+2\nv 0.00000000000000000000000000000000000000000000000000001 "
        "-0 123456789012345678901234567890e-29\nf +1 +2 3\n");
    EXPECT_TRUE(scene.warnings().empty());
    const std::vector<glm::vec3>& p = scene.meshes[0].positions;
    ASSERT_EQ(p.size(), 3u);
    EXPECT_EQ(p[0], glm::vec3(1, 0, 0));
    EXPECT_EQ(p[1], glm::vec3(1, 0.5f, 100));
    EXPECT_EQ(p[2], glm::vec3(0, 0, 1.2345679f));
    const std::string zeros(500, '0');
    EXPECT_EQ(load("v 0." + zeros + "1 0" + zeros + "2 1e-99999999999999999999\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
                  .meshes[0]
                  .positions[0],
              glm::vec3(0, 2, 0));
    for (const std::string number : {"++1", "+-1", "-+1", "+", "-", ".", "e5", "1e+", "0x10", "1,5", "1e-5x", "+inf", "1e39",
                                     "-1e400", "1e99999999999999999999"}) {
        expect_error("v 0 0 " + number + "\n", "line 1: '" + number + "' is not a number");
    }
    expect_error("v 0 0 1" + zeros + "e-9\n", "is not a number");
    expect_error(kCorners + "f +-1 2 3\n", "is not an index");
}

TEST(Obj, LinesEndAndGoOnAsExportersWriteThem) {
    const std::vector<glm::vec3> expected = load(kCorners + "f 1 2 3 4\n").meshes[0].positions;
    const auto with_ends = [](std::string text, const std::string& end) {
        for (size_t at = 0; (at = text.find('\n', at)) != text.npos; at += end.size()) text.replace(at, 1, end);
        return text;
    };
    for (const std::string end : {"\n", "\r\n", "\r"}) {
        for (const std::string mark : {"", "\xef\xbb\xbf"}) {
            const Scene scene = load(mark + with_ends("# C:\\models\\\n" + kCorners + "f 1 2 \\\n3 \\\n 4", end));
            EXPECT_TRUE(scene.warnings().empty()) << scene.warnings().begin()->first;
            EXPECT_EQ(scene.meshes[0].positions, expected);
            EXPECT_EQ(scene.meshes[0].corners.size(), 2u);
        }
    }
    // Wherever the file is cut into blocks, a CR LF is one end.
    for (size_t padding = 65520; padding < 65540; ++padding) {
        const std::string text = "#" + std::string(padding, ' ') + "\r\n" + kCorners + "f 1 2 9\r\n";
        expect_error(text, "line 6: index 9 of 4");
    }
    expect_error("v 0 0 \\\n0\nv 1 0 0 \\\n\\\n1 2 3 4 5 6\n", "line 3: more than 7 numbers");
    expect_error("v 0 0 \\", "line 1: 2 numbers");
}

TEST(Obj, LinesAndSurfacesHaveAnEnd) {
    const std::string text = kCorners + "#" + std::string(100, ' ') + "\nf 1 2 3 4\n";
    EXPECT_EQ(error_of(text, {.max_line_bytes = 101}), "");
    EXPECT_NE(error_of(text, {.max_line_bytes = 100}).find("line 5: a line of more than 100 bytes"), std::string::npos);
    EXPECT_NE(error_of(kCorners + "f 1 \\\n2 \\\n3 \\\n4\n", {.max_line_bytes = 9}).find("line 5: a line of more"),
              std::string::npos);
    const std::string quad = kCorners + "f 1 2 3 4\n";
    EXPECT_EQ(error_of(quad, {.subdivision_level = 3, .max_triangles = 128}), "");
    EXPECT_NE(error_of(quad, {.subdivision_level = 3, .max_triangles = 127}).find("would have 128 triangles"),
              std::string::npos);
    std::string many = quad;
    for (int k = 1; k < 40; ++k) many += "v 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\nf -4 -3 -2 -1\n";
    EXPECT_NE(error_of(many, {.subdivision_level = 8}).find("would have 5242880 triangles"), std::string::npos);
}

TEST(Obj, WhatIsNotReadIsCounted) {
    const Scene scene =
        load("mtllib a.mtl\nusemtl b\nl 1 2\nv 0 0 0 0.5 0.5 0.5\nv 1 0 0 1\nv 1 1 0\ng x\ns off\nf 1 2 3\n");
    EXPECT_EQ(scene.warnings().size(), 3u);
    EXPECT_EQ(scene.warnings().at("materials of an .obj file: ignored"), 2u);
    EXPECT_EQ(scene.warnings().at("colours of an .obj file's vertices: ignored"), 1u);
}

TEST(Obj, RealCagesLoadAndSubdivide) {
    const auto folder = assets_folder(ZOETROPE_SOURCE_DIR);
    if (!folder || !std::filesystem::exists(*folder / "subdiv")) GTEST_SKIP() << kNoAssets;
    for (const char* const name : {"spot_control_mesh.obj", "suzanne.obj"}) {
        for (const int level : {1, 3}) {
            Scene scene = load_obj(*folder / "subdiv" / name, {.subdivision_level = level});
            const Tlas& tlas = advance(scene, 0.0);
            EXPECT_EQ(tlas.instances[0].mesh->corners.size(), count_triangles(scene.meshes[0].surface->cage, level)) << name;
        }
        EXPECT_GT(load_obj(*folder / "subdiv" / name).meshes[0].corners.size(), 300u);
    }
}

}  // namespace
}  // namespace zoe::test
