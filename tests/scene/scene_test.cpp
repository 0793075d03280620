#include <limits>

#include <gtest/gtest.h>

#include "tests/scene/glb_builder.h"

namespace zoe::test {
namespace {

Scene quad_scene() {
    Scene scene;
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
    mesh.uvs[0].resize(4);
    mesh.corners = {{0, 1, 2}, {1, 3, 2}};
    scene.add(Material{});
    mesh.materials = {{0, 1, kNone<MaterialId>}, {1, 2, MaterialId{0}}};
    scene.add(Node{.mesh = scene.add(std::move(mesh))});
    return scene;
}

TEST(SceneGraph, MotionNamesGoBothWays) {
    for (const Motion motion : {Motion::kStatic, Motion::kRigid, Motion::kDeforming, Motion::kArbitrary}) {
        EXPECT_EQ(motion_from_name(name(motion)), motion);
    }
    EXPECT_STREQ(name(Motion::kDeforming), "deforming");
    EXPECT_EQ(motion_from_name("Static"), std::nullopt);
    EXPECT_EQ(motion_from_name(""), std::nullopt);
}

TEST(SceneGraph, WriteMeshFitsMaterialsAndDropsWhatNoLongerFits) {
    Scene scene = quad_scene();
    const MeshId id{0};
    const std::vector<glm::vec3> four(4, glm::vec3(1)), three(3, glm::vec3(2));
    scene.write_mesh(id, four, {}, std::vector<glm::uvec3>{{0, 1, 2}, {1, 2, 3}, {0, 1, 3}});
    EXPECT_EQ(scene[id].version, 1u);
    EXPECT_EQ(scene[id].uvs[0].size(), 4u);
    EXPECT_EQ(scene[id].materials[1].end, 3u);
    EXPECT_EQ(check(scene), "");
    scene.write_mesh(id, three, three, std::vector<glm::uvec3>{{0, 1, 2}});
    EXPECT_EQ(scene[id].version, 2u);
    EXPECT_TRUE(scene[id].uvs[0].empty());
    EXPECT_EQ(scene[id].materials[0].end, 1u);
    EXPECT_EQ(scene[id].materials[1].begin, 1u);
    EXPECT_EQ(check(scene), "");
    scene.write_mesh(id, {}, {}, {});
    EXPECT_EQ(check(scene), "");
}

TEST(SceneGraph, WriteMeshRefusesWhatDoesNotFitAndChangesNothing) {
    Scene scene = quad_scene();
    const std::vector<glm::vec3> three(3), two(2);
    const std::vector<glm::uvec3> out{{0, 1, 3}}, in{{0, 1, 2}};
    EXPECT_THROW(scene.write_mesh(MeshId{0}, three, {}, out), SceneError);
    EXPECT_THROW(scene.write_mesh(MeshId{0}, three, two, in), SceneError);
    EXPECT_THROW(scene.write_mesh(MeshId{1}, three, {}, in), SceneError);
    EXPECT_EQ(scene.meshes[0].version, 0u);
    EXPECT_EQ(scene.meshes[0].positions.size(), 4u);
}

TEST(SceneGraph, ParentsComeFirst) {
    Scene scene;
    scene.add(Node{.parent = NodeId{2}});
    scene.add(Node{.parent = NodeId{0}});
    scene.add(Node{});
    EXPECT_EQ(scene.parents_first(), (std::vector<NodeId>{NodeId{2}, NodeId{0}, NodeId{1}}));
    scene.nodes[2].parent = NodeId{1};
    EXPECT_THROW(scene.parents_first(), SceneError);
    scene.nodes[2].parent = NodeId{7};
    EXPECT_THROW(scene.parents_first(), SceneError);
    scene.nodes[2].parent = NodeId{2};
    EXPECT_THROW(scene.parents_first(), SceneError);
}

TEST(SceneGraph, WarningsAreCounted) {
    Scene scene;
    scene.warn("a");
    scene.warn("b");
    scene.warn("a");
    EXPECT_EQ(scene.warnings().at("a"), 2u);
    EXPECT_EQ(scene.warnings().size(), 2u);
}

TEST(SceneGraph, CheckNamesWhatIsBroken) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const auto broken = [](auto&& change) {
        Scene scene = make_rich_glb().load();
        EXPECT_EQ(check(scene), "");
        change(scene);
        return check(scene);
    };
    EXPECT_EQ(broken([&](Scene& s) { s.meshes[0].positions[0].x = nan; }), "");
    EXPECT_NE(broken([&](Scene& s) { s.nodes[0].local.translation.x = nan; }), "");
    EXPECT_NE(broken([&](Scene& s) { s.nodes[0].local.rotation.w = 2.0f; }), "");
    EXPECT_NE(broken([](Scene& s) { s.nodes[0].mesh = MeshId{1}; }), "");
    EXPECT_NE(broken([](Scene& s) { s.nodes[0].skin = SkinId{1}; }), "");
    EXPECT_NE(broken([](Scene& s) { s.nodes[0].camera = CameraId{1}; }), "");
    EXPECT_NE(broken([](Scene& s) { s.nodes[0].light = LightId{1}; }), "");
    EXPECT_NE(broken([](Scene& s) { s.nodes[1].parent = NodeId{2}; }), "");
    EXPECT_NE(broken([](Scene& s) { s.nodes[0].weights = {1, 2}; }), "");
    EXPECT_NE(broken([](Scene& s) { s.nodes[0].sequence = MeshSequence{}; }), "");
    EXPECT_NE(broken([](Scene& s) { s.meshes[0].corners[0].x = 4; }), "");
    EXPECT_NE(broken([](Scene& s) { s.meshes[0].normals.pop_back(); }), "");
    EXPECT_NE(broken([](Scene& s) { s.meshes[0].uvs[7].resize(1); }), "");
    EXPECT_NE(broken([](Scene& s) { s.meshes[0].tangents.resize(1); }), "");
    EXPECT_EQ(broken([](Scene& s) {
                  s.meshes[0].tangents.resize(1);
                  s.meshes[0].tangent_corners.resize(s.meshes[0].corners.size(), glm::uvec3(0));
              }),
              "");
    EXPECT_NE(broken([](Scene& s) { s.meshes[0].tangent_corners.resize(s.meshes[0].corners.size(), glm::uvec3(0)); }), "");
    EXPECT_NE(broken([](Scene& s) { s.meshes[0].tangent_corners.resize(s.meshes[0].corners.size() + 1); }), "");
    EXPECT_NE(broken([](Scene& s) { s.meshes[0].default_weights.clear(); }), "");
    EXPECT_NE(broken([](Scene& s) { s.meshes[0].binding.joints[0] = 2; }), "");
    EXPECT_NE(broken([](Scene& s) { s.meshes[0].materials[0].end = 1; }), "");
    EXPECT_NE(broken([](Scene& s) { s.meshes[0].materials[0].material = MaterialId{5}; }), "");
    EXPECT_NE(broken([](Scene& s) { s.skins[0].joints[0] = NodeId{3}; }), "");
    EXPECT_NE(broken([](Scene& s) { s.skins[0].joint_from_mesh.clear(); }), "");
    EXPECT_NE(broken([](Scene& s) { s.clips[0].channels[0].sampler = 9; }), "");
    EXPECT_NE(broken([](Scene& s) { s.clips[0].channels[0].node = NodeId{9}; }), "");
    EXPECT_NE(broken([](Scene& s) { s.clips[0].samplers[0].times_s = {1, 0}; }), "");
    EXPECT_NE(broken([](Scene& s) { s.clips[0].samplers[0].values.pop_back(); }), "");
    EXPECT_NE(broken([](Scene& s) { s.nodes[2].matrix = Affine{}; }), "");
    EXPECT_NE(broken([](Scene& s) { s.playback.clips = {ClipId{3}}; }), "");
    EXPECT_NE(broken([](Scene& s) { s.materials[0].base_color_texture.image = ImageId{4}; }), "");
    EXPECT_EQ(broken([](Scene& s) { s.materials[0].base_color_texture.uv_set = 7; }), "");
    EXPECT_NE(broken([](Scene& s) { s.materials[0].base_color_texture.uv_set = 8; }), "");
}

}  // namespace
}  // namespace zoe::test
