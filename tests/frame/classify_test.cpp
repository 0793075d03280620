// What `classify` makes of the content: from channels, skins and morph targets alone.

#include "engine/frame/classify.h"

#include <gtest/gtest.h>

#include <string>

#include "engine/frame/frame.h"

namespace zoe {
namespace {

Mesh triangle() {
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.corners = {{0, 1, 2}};
    return mesh;
}

Mesh triangle_with_target() {
    Mesh mesh = triangle();
    mesh.targets = {{.positions = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}}, .normals = {}}};
    mesh.default_weights = {0.0f};
    return mesh;
}

// All of a triangle's corners follow joint 0, but the last, which follows `last_joint`.
Mesh skinned_triangle(uint16_t last_joint) {
    Mesh mesh = triangle();
    mesh.binding.influence_count = 4;
    mesh.binding.joints = {0, 0, 0, 0, 0, 0, 0, 0, last_joint, 0, 0, 0};
    mesh.binding.weights = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0};
    return mesh;
}

NodeId add_node(Scene& scene, NodeId parent = kNone<NodeId>, MeshId mesh = kNone<MeshId>) {
    Node node;
    node.parent = parent;
    node.mesh = mesh;
    return scene.add(node);
}

// A clip of its own with one channel.
void add_channel(Scene& scene, NodeId node, ChannelPath path, uint32_t width, std::vector<float> values,
                 Interpolation interpolation = Interpolation::kLinear) {
    Clip clip;
    Sampler sampler;
    sampler.interpolation = interpolation;
    sampler.is_rotation = path == ChannelPath::kRotation;
    sampler.width = width;
    const size_t per_key = width * (interpolation == Interpolation::kCubicSpline ? 3 : 1);
    for (size_t key = 0; key < values.size() / per_key; ++key) sampler.times_s.push_back(static_cast<float>(key));
    sampler.values = std::move(values);
    clip.duration_s = sampler.times_s.back();
    clip.samplers = {sampler};
    clip.channels = {{node, path, 0}};
    scene.clips.push_back(clip);
}

void add_motion(Scene& scene, NodeId node) {
    add_channel(scene, node, ChannelPath::kTranslation, 3, {0, 0, 0, 1, 0, 0});
}

Motion content(const Scene& scene, NodeId node) {
    return classify(scene)[index(node)].content;
}

TEST(Classify, NodesBelowAnAnimatedOneAreRigidAndOthersStatic) {
    Scene scene;
    const MeshId mesh = scene.add(triangle());
    const NodeId top = add_node(scene), below = add_node(scene, top), leaf = add_node(scene, below, mesh);
    const NodeId aside = add_node(scene, kNone<NodeId>, mesh);
    add_motion(scene, top);
    EXPECT_EQ(content(scene, top), Motion::kRigid);
    EXPECT_EQ(content(scene, leaf), Motion::kRigid);
    EXPECT_EQ(content(scene, aside), Motion::kStatic);
}

TEST(Classify, ClipsCountWhetherTheyPlayOrNot) {
    Scene scene;
    const NodeId node = add_node(scene, kNone<NodeId>, scene.add(triangle()));
    add_motion(scene, node);
    scene.playback.clips.clear();
    EXPECT_EQ(content(scene, node), Motion::kRigid);
}

TEST(Classify, AnAnimatedCameraMovesNoMesh) {
    Scene scene;
    const NodeId mesh = add_node(scene, kNone<NodeId>, scene.add(triangle())), camera = add_node(scene);
    scene.cameras.emplace_back();
    scene[camera].camera = CameraId{0};
    add_motion(scene, camera);
    EXPECT_EQ(content(scene, mesh), Motion::kStatic);
}

TEST(Classify, ChannelsWhoseKeysAreAllEqualAnimateNothing) {
    Scene scene;
    const NodeId node = add_node(scene, kNone<NodeId>, scene.add(triangle_with_target()));
    add_channel(scene, node, ChannelPath::kTranslation, 3, {1, 2, 3, 1, 2, 3, 1, 2, 3});
    add_channel(scene, node, ChannelPath::kScale, 3, {7, 7, 7});
    add_channel(scene, node, ChannelPath::kRotation, 4, {0, 0, 0, 1, 0, 0, 0, -1});  // One rotation, twice.
    add_channel(scene, node, ChannelPath::kWeights, 1, {0.5f, 0.5f});
    EXPECT_EQ(content(scene, node), Motion::kStatic);
    // Equal values with a slope between them do move.
    add_channel(scene, node, ChannelPath::kTranslation, 3, {0, 0, 0, 1, 2, 3, 1, 0, 0, 0, 0, 0, 1, 2, 3, 0, 0, 0},
                Interpolation::kCubicSpline);
    EXPECT_EQ(content(scene, node), Motion::kRigid);
}

TEST(Classify, WeightsThatChangeDeformAndOthersDoNot) {
    Scene scene;
    const MeshId morphed = scene.add(triangle_with_target()), plain = scene.add(triangle());
    const NodeId still = add_node(scene, kNone<NodeId>, morphed), changing = add_node(scene, kNone<NodeId>, morphed);
    const NodeId without_targets = add_node(scene, kNone<NodeId>, plain);
    add_channel(scene, changing, ChannelPath::kWeights, 1, {0, 1});
    add_channel(scene, without_targets, ChannelPath::kWeights, 1, {0, 1});
    EXPECT_EQ(content(scene, still), Motion::kStatic);
    EXPECT_EQ(content(scene, changing), Motion::kDeforming);
    EXPECT_EQ(content(scene, without_targets), Motion::kStatic);
}

struct SkinScene {
    Scene scene;
    NodeId hip, knee, tail, skinned;

    explicit SkinScene(uint16_t last_joint) {
        hip = add_node(scene);
        knee = add_node(scene, hip);
        tail = add_node(scene);
        scene.skins.push_back({"skin", {hip, knee, tail}, {Affine{}, Affine{}, Affine{}}});
        skinned = add_node(scene, kNone<NodeId>, scene.add(skinned_triangle(last_joint)));
        scene[skinned].skin = SkinId{0};
    }
};

TEST(Classify, SkinsOfJointsThatNeverMoveAreStatic) {
    SkinScene s(1);
    EXPECT_EQ(content(s.scene, s.skinned), Motion::kStatic);
    // Its own transform does not move a skinned mesh.
    add_motion(s.scene, s.skinned);
    EXPECT_EQ(content(s.scene, s.skinned), Motion::kStatic);
}

TEST(Classify, SkinsOfJointsThatMoveTogetherAreRigid) {
    SkinScene s(1);
    add_motion(s.scene, s.hip);
    EXPECT_EQ(content(s.scene, s.skinned), Motion::kRigid);
    EXPECT_EQ(classify(s.scene)[index(s.skinned)].frame, s.hip);
}

TEST(Classify, SkinsOfJointsThatMoveAgainstEachOtherDeform) {
    SkinScene s(1);
    add_motion(s.scene, s.knee);
    EXPECT_EQ(content(s.scene, s.skinned), Motion::kDeforming);
}

TEST(Classify, JointsThatNoVertexFollowsDoNotCount) {
    SkinScene s(1);  // The tail moves no vertex.
    add_motion(s.scene, s.tail);
    EXPECT_EQ(content(s.scene, s.skinned), Motion::kStatic);
    SkinScene with_tail(2);
    add_motion(with_tail.scene, with_tail.tail);
    EXPECT_EQ(content(with_tail.scene, with_tail.skinned), Motion::kDeforming);
}

// The same vertices, whether a skin is carried by its frame node or skinned into the world.
TEST(Classify, ARigidSkinIsWhereTheDeformedOneWouldBe) {
    SkinScene rigid(1), deforming(1);
    for (SkinScene* s : {&rigid, &deforming}) {
        s->scene[s->hip].local.translation = {0.5f, 0.25f, -2.0f};
        s->scene[s->knee].local.rotation = glm::angleAxis(0.7f, glm::vec3(0, 0, 1));
        s->scene.skins[0].joint_from_mesh[1].translation = {0.1f, -0.2f, 0.3f};
        add_motion(s->scene, s->hip);
        s->scene.playback.clips = {ClipId{0}};
    }
    add_channel(deforming.scene, deforming.knee, ChannelPath::kScale, 3, {1, 1, 1, 2, 2, 2});  // Does not play.
    for (const double time_s : {0.0, 0.3, 0.99}) {
        const Instance& a = advance(rigid.scene, time_s)[rigid.skinned];
        const Instance& b = advance(deforming.scene, time_s)[deforming.skinned];
        EXPECT_EQ(a.motion, Motion::kRigid);
        EXPECT_EQ(b.motion, Motion::kDeforming);
        for (size_t v = 0; v < a.positions.size(); ++v) {
            const glm::vec3 in_world = a.world_from_local.point(a.positions[v]);
            EXPECT_LT(glm::length(in_world - b.positions[v]), 1e-6f) << "vertex " << v << " at " << time_s << " s";
        }
    }
}

TEST(Classify, SequencesAndWrittenMeshesAreArbitrary) {
    Scene scene;
    const MeshId first = scene.add(triangle()), second = scene.add(triangle());
    const NodeId sequence = add_node(scene, kNone<NodeId>, first), one = add_node(scene, kNone<NodeId>, first);
    scene[sequence].sequence = MeshSequence{{first, second}, 24.0};
    scene[one].sequence = MeshSequence{{first}, 24.0};
    EXPECT_EQ(content(scene, sequence), Motion::kArbitrary);
    EXPECT_EQ(content(scene, one), Motion::kStatic) << "a sequence of one mesh never changes";
    const Mesh& mesh = scene[first];
    scene.write_mesh(first, std::vector(mesh.positions), {}, std::vector(mesh.corners));
    EXPECT_EQ(content(scene, one), Motion::kArbitrary);
}

TEST(Classify, ObeysAMoreGeneralClassAndRefusesALessGeneralOneWithTheReason) {
    Scene scene;
    const NodeId node = add_node(scene, kNone<NodeId>, scene.add(triangle()));
    add_motion(scene, node);
    set_motion(scene, node, Motion::kArbitrary);
    advance(scene, 0.0);
    EXPECT_EQ(motion(scene, node), Motion::kArbitrary);
    try {
        set_motion(scene, node, Motion::kStatic);
        FAIL() << "a moving node was made static";
    } catch (const SceneError& error) {
        EXPECT_NE(std::string(error.what()).find("/nodes/0: cannot be static: its content is rigid"), std::string::npos)
            << error.what();
    }
    // Asked for by a file: refused with a warning, and the content's class holds.
    scene[node].motion = Motion::kStatic;
    scene.touch();
    advance(scene, 0.0);
    EXPECT_EQ(motion(scene, node), Motion::kRigid);
    ASSERT_EQ(scene.warnings().size(), 1u);
    EXPECT_NE(scene.warnings().begin()->first.find("/nodes/0/extras/motion"), std::string::npos);
}

}  // namespace
}  // namespace zoe
