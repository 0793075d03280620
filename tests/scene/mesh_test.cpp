#include <gtest/gtest.h>

#include "tests/scene/glb_builder.h"

namespace zoe::test {
namespace {

using Corners = std::vector<glm::uvec3>;

/// Five vertices drawn in a mode, with or without indices.
GlbBuilder mode_glb(int mode, bool is_indexed) {
    GlbBuilder glb;
    const int positions = glb.floats({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 2, 1, 0}, "VEC3");
    nlohmann::json primitive = {{"attributes", {{"POSITION", positions}}}, {"mode", mode}};
    if (is_indexed) primitive["indices"] = glb.accessor(std::vector<uint8_t>{4, 3, 2, 1, 0}, kUbyte, "SCALAR", 5);
    glb.push("nodes", {{"mesh", glb.mesh(primitive)}});
    return glb;
}

TEST(Primitive, StripsAndFansUnrollAsGltfOrdersThem) {
    EXPECT_EQ(mode_glb(5, false).load().meshes[0].corners, (Corners{{0, 1, 2}, {1, 3, 2}, {2, 3, 4}}));
    EXPECT_EQ(mode_glb(6, false).load().meshes[0].corners, (Corners{{1, 2, 0}, {2, 3, 0}, {3, 4, 0}}));
    EXPECT_EQ(mode_glb(5, true).load().meshes[0].corners, (Corners{{4, 3, 2}, {3, 1, 2}, {2, 1, 0}}));
    EXPECT_EQ(mode_glb(6, true).load().meshes[0].corners, (Corners{{3, 2, 4}, {2, 1, 4}, {1, 0, 4}}));
}

TEST(Primitive, TrianglesLeaveOutAnIncompleteRest) {
    const Scene scene = mode_glb(4, false).load();
    EXPECT_EQ(scene.meshes[0].corners, (Corners{{0, 1, 2}}));
    EXPECT_EQ(scene.warnings().size(), 1u);
}

TEST(Primitive, PointsAndLinesAreCountedAndNotShown) {
    for (int mode = 0; mode < 4; ++mode) {
        const Scene scene = mode_glb(mode, true).load();
        EXPECT_TRUE(scene.meshes[0].corners.empty());
        EXPECT_EQ(scene.warnings().at("a primitive of points or lines: not shown"), 1u);
    }
    EXPECT_NE(mode_glb(7, false).error().find("/meshes/0/primitives/0/mode: 7"), std::string::npos);
}

TEST(Primitive, IndicesMustBeBelowTheVertexCount) {
    GlbBuilder glb = mode_glb(5, true);
    glb.binary.replace(60, 1, 1, '\x05');
    EXPECT_NE(glb.error().find("/meshes/0/primitives/0/indices: entry 0 is 5, not below 5"), std::string::npos);
    glb.binary.replace(60, 1, 1, '\xff');
    EXPECT_NE(glb.error().find("restart value 255"), std::string::npos);
}

TEST(Primitive, AttributesMustBeAsManyAsPositions) {
    GlbBuilder glb;
    glb.triangle();
    glb.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = glb.floats({0, 0, 1}, "VEC3");
    EXPECT_NE(glb.error().find("/meshes/0/primitives/0/attributes/NORMAL"), std::string::npos);
}

/// A triangle with three sets of texture coordinates, TEXCOORD_0, _2 and _7, and textures that look in `used`.
GlbBuilder textured_triangle(const std::vector<int>& used) {
    GlbBuilder glb;
    glb.triangle();
    nlohmann::json& primitive = glb.json["meshes"][0]["primitives"][0];
    for (const int set : {0, 2, 7}) {
        const float u = static_cast<float>(set);
        const std::string name = std::string("TEXCOORD_") + static_cast<char>('0' + set);
        primitive["attributes"][name] = glb.floats({u, 0, u, 1, u, 2}, "VEC2");
    }
    glb.push("images", {{"uri", "missing.png"}});
    glb.push("textures", {{"source", 0}});
    const char* const names[] = {"emissiveTexture", "normalTexture", "occlusionTexture"};
    nlohmann::json material;
    for (size_t k = 0; k < used.size(); ++k) material[names[k]] = {{"index", 0}, {"texCoord", used[k]}};
    primitive["material"] = glb.push("materials", material);
    return glb;
}

TEST(Mesh, TextureCoordinatesAreKeptWhereTexturesLookThere) {
    const Scene scene = textured_triangle({2, 7}).load();
    const Mesh& mesh = scene.meshes[0];
    for (size_t set = 0; set < kMaxUvSets; ++set) {
        ASSERT_EQ(mesh.uvs[set].size(), set == 0 || set == 2 || set == 7 ? 3u : 0u) << set;
        if (mesh.uvs[set].empty()) continue;
        EXPECT_EQ(mesh.uvs[set][2], glm::vec2(set, 2));
    }
    EXPECT_EQ(scene.materials[0].emission_texture.uv_set, 2);
    EXPECT_EQ(scene.materials[0].normal_texture.uv_set, 7);
    EXPECT_TRUE(textured_triangle({0}).load().meshes[0].uvs[2].empty());
    EXPECT_EQ(scene.warnings().size(), 1u) << "the missing image";
}

TEST(Mesh, TextureCoordinatesThatAreMissingAreToldOf) {
    const Scene scene = textured_triangle({1, 2}).load();
    EXPECT_TRUE(scene.meshes[0].uvs[1].empty());
    EXPECT_EQ(scene.warnings().at("a primitive with a texture but without its TEXCOORD_1: (0, 0) is taken"), 1u);
    EXPECT_EQ(scene.warnings().size(), 2u) << "and the missing image";
    const Scene beyond = textured_triangle({8}).load();
    EXPECT_EQ(beyond.materials[0].emission_texture.uv_set, 0);
    EXPECT_EQ(beyond.warnings().at("a texture that uses texture coordinates beyond TEXCOORD_7: TEXCOORD_0 is taken"), 1u);
}

TEST(Mesh, PrimitivesFollowOneAnotherAndMissingAttributesAreFilled) {
    GlbBuilder glb;
    const int positions = glb.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3");
    const int more = glb.floats({5, 0, 0, 6, 0, 0, 5, 1, 0}, "VEC3");
    const int normals = glb.floats({0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3");
    const int colors = glb.accessor(std::vector<uint8_t>(12, 51), kUbyte, "VEC4", 3, true);
    glb.push("materials", nlohmann::json::object());
    glb.push("meshes", {{"primitives",
                         {{{"attributes", {{"POSITION", positions}}}},
                          {{"attributes", {{"POSITION", more}, {"NORMAL", normals}, {"COLOR_0", colors}}}, {"material", 0}},
                          {{"attributes", {{"POSITION", positions}}}, {"mode", 0}},
                          {{"attributes", {{"POSITION", positions}}}}}}});
    const Scene scene = glb.load();
    const Mesh& mesh = scene.meshes[0];
    ASSERT_EQ(mesh.positions.size(), 6u) << "primitives with the same vertex data share it";
    EXPECT_EQ(mesh.corners, (Corners{{0, 1, 2}, {3, 4, 5}, {0, 1, 2}}));
    EXPECT_EQ(mesh.normals[0], glm::vec3(0));
    EXPECT_EQ(mesh.normals[3], glm::vec3(0, 0, 1));
    EXPECT_EQ(mesh.colors[0], glm::vec4(1));
    EXPECT_FLOAT_EQ(mesh.colors[4].y, 0.2f);
    ASSERT_EQ(mesh.materials.size(), 4u);
    EXPECT_EQ(mesh.materials[1].material, MaterialId{0});
    EXPECT_EQ(mesh.materials[2].begin, mesh.materials[2].end);
    EXPECT_EQ(mesh.materials[3].end, 3u);
}

TEST(Mesh, KeepsOnlyTheVerticesThatItsTrianglesSpan) {
    GlbBuilder glb;
    std::vector<float> many(300, 0.0f);
    many[150] = 7.0f;
    const int positions = glb.floats(many, "VEC3");
    const int indices = glb.accessor(std::vector<uint16_t>{50, 51, 52}, kUshort, "SCALAR", 3);
    glb.mesh({{"attributes", {{"POSITION", positions}}}, {"indices", indices}});
    const Scene scene = glb.load();
    ASSERT_EQ(scene.meshes[0].positions.size(), 3u);
    EXPECT_EQ(scene.meshes[0].positions[0].x, 7.0f);
    EXPECT_EQ(scene.meshes[0].corners[0], glm::uvec3(0, 1, 2));
}

TEST(Mesh, NonFinitePositionsLoad) {
    GlbBuilder glb;
    const float nan = std::numeric_limits<float>::quiet_NaN();
    glb.mesh({{"attributes", {{"POSITION", glb.floats({0, 0, 0, nan, 0, 0, 0, 1, 0}, "VEC3")}}}});
    EXPECT_EQ(check(glb.load()), "");
}

TEST(Mesh, SparseMorphTargetsAreDense) {
    const Scene scene = make_rich_glb().load();
    const Mesh& mesh = scene.meshes[0];
    ASSERT_EQ(mesh.targets.size(), 1u);
    EXPECT_EQ(mesh.targets[0].positions, (std::vector<glm::vec3>{{0, 0, 0}, {0, 0, 1}, {0, 0, 0}, {0, 0, 2}}));
    EXPECT_TRUE(mesh.targets[0].normals.empty());
    EXPECT_EQ(mesh.default_weights, std::vector<float>{0.0f});
}

TEST(Mesh, MorphTargetsMustBeAsManyInEveryPrimitive) {
    GlbBuilder glb = make_rich_glb();
    nlohmann::json& primitives = glb.json["meshes"][0]["primitives"];
    primitives.push_back(primitives[0]);
    primitives[1]["targets"].push_back(primitives[1]["targets"][0]);
    EXPECT_NE(glb.error().find("/meshes/0/primitives/1/targets"), std::string::npos);
}

TEST(SkinReader, MoreThanFourInfluencesAreKept) {
    GlbBuilder glb = make_rich_glb();
    nlohmann::json& attributes = glb.json["meshes"][0]["primitives"][0]["attributes"];
    attributes["JOINTS_1"] = attributes["JOINTS_0"];
    attributes["WEIGHTS_1"] = attributes["WEIGHTS_0"];
    const Scene scene = glb.load();
    const SkinBinding& binding = scene.meshes[0].binding;
    ASSERT_EQ(binding.influence_count, 8u);
    EXPECT_FLOAT_EQ(binding.weights[8 + 0], 0.25f);
    EXPECT_FLOAT_EQ(binding.weights[8 + 5], 0.25f);
    EXPECT_EQ(binding.joints[8 + 5], 1u);
    EXPECT_EQ(scene.warnings().at("a vertex whose joint weights do not sum to 1: normalised"), 4u);
}

TEST(SkinReader, MissingMatricesAreIdentitiesAndWeightlessVerticesFollowJointZero) {
    GlbBuilder glb = make_rich_glb();
    glb.json["meshes"][0]["primitives"][0]["attributes"]["WEIGHTS_0"] = glb.floats(std::vector<float>(16, 0.0f), "VEC4");
    const Scene scene = glb.load();
    EXPECT_EQ(scene.skins[0].joint_from_mesh[1], Affine{});
    EXPECT_EQ(scene.meshes[0].binding.weights[4], 1.0f);
    EXPECT_EQ(scene.meshes[0].binding.joints[4], 0u);
    EXPECT_EQ(scene.warnings().at("a vertex without joint weights: it follows joint 0"), 4u);
}

TEST(SkinReader, ExtrasPickDualQuaternions) {
    GlbBuilder glb = make_rich_glb();
    EXPECT_EQ(glb.load().skins[0].skinning, Skinning::kLinearBlend);
    nlohmann::json& extras = glb.json["skins"][0]["extras"];
    const std::string warning = "extras.skinning is none of linear_blend, dual_quaternion: ignored";
    extras = {{"skinning", "dual_quaternion"}, {"anything", {1, 2}}};
    EXPECT_EQ(glb.load().skins[0].skinning, Skinning::kDualQuaternion);
    EXPECT_EQ(glb.load().warnings().count(warning), 0u);
    extras = {{"skinning", "linear_blend"}};
    EXPECT_EQ(glb.load().skins[0].skinning, Skinning::kLinearBlend);
    EXPECT_EQ(glb.load().warnings().count(warning), 0u);
    for (const nlohmann::json& wrong : {nlohmann::json("spherical"), nlohmann::json(1), nlohmann::json({1, 2})}) {
        extras = {{"skinning", wrong}};
        EXPECT_EQ(glb.load().skins[0].skinning, Skinning::kLinearBlend);
        EXPECT_EQ(glb.load().warnings().count(warning), 1u) << wrong.dump();
    }
    extras = "not an object";
    EXPECT_EQ(glb.load().skins[0].skinning, Skinning::kLinearBlend);
}

TEST(SkinReader, JointsMustBeInTheSkin) {
    GlbBuilder glb = make_rich_glb();
    glb.json["skins"][0]["joints"] = {1};
    EXPECT_NE(glb.error().find("/nodes/0/skin: mesh 0 names joint 1, but the skin has 1 joints"), std::string::npos);
}

TEST(SkinReader, ByteWeightsAreNormalised) {
    GlbBuilder glb = make_rich_glb();
    const std::vector<uint8_t> weights{255, 0, 0, 0, 128, 127, 0, 0, 0, 255, 0, 0, 64, 191, 0, 0};
    glb.json["meshes"][0]["primitives"][0]["attributes"]["WEIGHTS_0"] = glb.accessor(weights, kUbyte, "VEC4", 4, true);
    const Scene scene = glb.load();
    EXPECT_FLOAT_EQ(scene.meshes[0].binding.weights[4], 128 / 255.0f);
    EXPECT_TRUE(scene.warnings().empty() || scene.warnings().begin()->first.find("/images") == 0);
}

}  // namespace
}  // namespace zoe::test
