#include <gtest/gtest.h>

#include "engine/scene/sequence.h"
#include "tests/scene/glb_builder.h"

namespace zoe::test {
namespace {

std::string sequence_error(const std::string& pattern, double fps = 24.0) {
    try {
        load_sequence(pattern, fps);
    } catch (const SceneError& error) {
        return error.what();
    }
    return {};
}

TEST(Sequence, PatternsHoldOneIntegerField) {
    for (const char* yes : {"a_%d.glb", "a_%04d.glb", "%03d.gltf", "folder/a%d"})
        EXPECT_TRUE(is_sequence_pattern(yes)) << yes;
    for (const char* no : {"a.glb", "a%", "a_%s.glb", "a_%4d.glb", "a_%d_%d.glb", "%x", "a_%-4d", "%d/a.glb", ""}) {
        EXPECT_FALSE(is_sequence_pattern(no)) << no;
    }
}

TEST(Sequence, EachFileBecomesOneMeshInWorldSpace) {
    const TempFolder folder;
    GlbBuilder glb;
    glb.triangle();
    glb.json["nodes"][0]["translation"] = {10, 0, 0};
    glb.push("nodes", {{"mesh", 0}, {"scale", {-1, 1, 1}}});
    glb.push("materials", {{"name", "red"}});
    glb.json["meshes"][0]["primitives"][0]["material"] = 0;
    for (int i = 8; i <= 11; ++i) write_file(folder / ("wave_" + std::to_string(i) + ".glb"), glb.glb());
    write_file(folder / "wave_x.glb", "");
    const Scene scene = load_sequence((folder / "wave_%d.glb").string(), 12.0);
    ASSERT_EQ(scene.nodes.size(), 1u);
    ASSERT_TRUE(scene.nodes[0].sequence);
    EXPECT_EQ(scene.nodes[0].sequence->fps, 12.0);
    EXPECT_EQ(scene.nodes[0].sequence->meshes.size(), 4u);
    EXPECT_EQ(scene.materials.size(), 1u) << "the files' equal materials are one";
    const Mesh& mesh = scene.meshes[0];
    EXPECT_EQ(mesh.name, "wave_8.glb");
    EXPECT_EQ(scene.meshes[3].name, "wave_11.glb");
    ASSERT_EQ(mesh.positions.size(), 6u);
    EXPECT_EQ(mesh.positions[1], glm::vec3(11, 0, 0));
    EXPECT_EQ(mesh.positions[4], glm::vec3(-1, 0, 0));
    EXPECT_EQ(mesh.corners[1], glm::uvec3(3, 5, 4)) << "mirrored: turned back";
    EXPECT_EQ(check(scene), "");
}

TEST(Sequence, SkinsAndMorphTargetsStandAtRest) {
    const TempFolder folder;
    GlbBuilder glb = make_rich_glb();
    glb.json["nodes"][0]["weights"] = {0.5};
    write_file(folder / "a_1.glb", glb.glb());
    const Scene scene = load_sequence((folder / "a_%d.glb").string());
    // Vertex 3: morphed by half of (0, 0, 2); three quarters of it follow the joint at (0, 1, 0).
    EXPECT_NEAR(scene.meshes[0].positions[3].y, 1.75f, 1e-6f);
    EXPECT_NEAR(scene.meshes[0].positions[3].z, 1.0f, 1e-6f);
}

TEST(Sequence, MirrorsTurnTrianglesBackUnderSkinsAndAtAnyScale) {
    const TempFolder folder;
    GlbBuilder skinned = make_rich_glb();
    write_file(folder / "a_1.glb", skinned.glb());
    skinned.json["nodes"][0]["scale"] = {-1, 1, 1};
    write_file(folder / "b_1.glb", skinned.glb());
    const glm::uvec3 plain = load_sequence((folder / "a_%d.glb").string()).meshes[0].corners[0];
    EXPECT_EQ(load_sequence((folder / "b_%d.glb").string()).meshes[0].corners[0], glm::uvec3(plain.x, plain.z, plain.y));

    GlbBuilder tiny;  // The determinant is no float.
    tiny.triangle();
    tiny.json["nodes"][0]["scale"] = {-1e-16, 1e-16, 1e-16};
    write_file(folder / "c_1.glb", tiny.glb());
    EXPECT_EQ(load_sequence((folder / "c_%d.glb").string()).meshes[0].corners[0], glm::uvec3(0, 2, 1));
}

TEST(Sequence, GapsAndBrokenFilesAreRefused) {
    const TempFolder folder;
    GlbBuilder glb;
    glb.triangle();
    const std::string pattern = (folder / "a_%02d.glb").string();
    EXPECT_NE(sequence_error(pattern).find("no file matches"), std::string::npos);
    write_file(folder / "a_1.glb", glb.glb());
    EXPECT_NE(sequence_error(pattern).find("no file matches"), std::string::npos) << "one digit is not two";
    write_file(folder / "a_01.glb", glb.glb());
    write_file(folder / "a_03.glb", glb.glb());
    EXPECT_NE(sequence_error(pattern).find("number 2 is missing"), std::string::npos);
    write_file(folder / "a_02.glb", "broken");
    EXPECT_NE(sequence_error(pattern).find("a_02.glb"), std::string::npos);
    write_file(folder / "a_02.glb", glb.glb());
    EXPECT_EQ(sequence_error(pattern), "");
    EXPECT_NE(sequence_error(pattern, 0.0), "");
    EXPECT_NE(sequence_error((folder / "none/a_%d.glb").string()), "");
    EXPECT_NE(sequence_error((folder / "a.glb").string()), "");
}

TEST(Sequence, LimitsAreEachFiles) {
    const TempFolder folder;
    GlbBuilder zeros;
    zeros.mesh({{"attributes", {{"POSITION", zeros.accessor_of(-1, kFloat, "VEC3", 30000)}}}});
    zeros.push("nodes", {{"mesh", 0}});
    for (const char* name : {"a_1.glb", "a_2.glb"}) write_file(folder / name, zeros.glb());
    const std::string pattern = (folder / "a_%d.glb").string();
    EXPECT_EQ(load_sequence(pattern, 24.0, {.max_free_numbers = 150000}).nodes[0].sequence->meshes.size(), 2u);
    EXPECT_THROW(load_sequence(pattern, 24.0, {.max_free_numbers = 100000}), SceneError);
}

}  // namespace
}  // namespace zoe::test
