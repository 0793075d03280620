// Only nodes whose inputs changed are deformed.

#include <gtest/gtest.h>

#include "content/shapes.h"
#include "engine/frame/bounds_at.h"
#include "engine/frame/frame_state.h"
#include "tests/frame/motion_class.h"

namespace zoe::test {
namespace {

constexpr uint32_t kFigures = 50, kDriven = 17;
constexpr uint32_t kNodesEach = 5;
enum : uint32_t { kRoot, kArm, kHand, kProp, kBody };  // Of a figure.

NodeId node_of(uint32_t figure, uint32_t part) {
    return NodeId{figure * kNodesEach + part};
}

// Figures of three joints and a prop that moves no vertex. The clip bends one arm, turns all props, and holds everyone
// else's arm still.
Content make_crowd() {
    Content content;
    Scene& scene = content.scene;
    Mesh mesh = make_cylinder(0.2f, 0.0f, 2.0f, 8);
    mesh.binding.influence_count = 4;
    for (const glm::vec3& p : mesh.positions) {
        const bool is_high = p.y > 1.0f;
        mesh.binding.joints.insert(mesh.binding.joints.end(), {uint16_t(is_high ? 2 : 0), 1, 3, 0});
        mesh.binding.weights.insert(mesh.binding.weights.end(), {0.75f, 0.25f, 0, 0});
    }
    mesh.targets = {{.positions = std::vector<glm::vec3>(mesh.positions.size(), {0, 0.1f, 0}), .normals = {}}};
    mesh.default_weights = {0};
    const MeshId shown = scene.add(std::move(mesh));
    scene.nodes.resize(kFigures * kNodesEach);
    Clip clip;
    clip.duration_s = 4.0;
    // Bends for a second, then holds.
    clip.samplers = {{.is_rotation = true, .width = 4, .times_s = {0, 1, 4}, .values = {0, 0, 0, 1, 1, 0, 0, 0, 1, 0, 0, 0}},
                     {.is_rotation = true, .width = 4, .times_s = {0, 4}, .values = {0, 0, 0, 1, 0, 1, 0, 0}},
                     {.width = 1, .times_s = {0, 2, 3, 4}, .values = {0, 0, 1, 1}}};
    for (uint32_t f = 0; f < kFigures; ++f) {
        scene[node_of(f, kRoot)].local.translation = {float(f), 0, 0};
        scene[node_of(f, kArm)].parent = node_of(f, kRoot);
        scene[node_of(f, kHand)].parent = scene[node_of(f, kProp)].parent = node_of(f, kArm);
        Node& body = scene[node_of(f, kBody)];
        body.mesh = shown;
        body.skin = SkinId{f};
        Skin skin{"", {}, {}, f % 2 == 0 ? Skinning::kLinearBlend : Skinning::kDualQuaternion};
        for (const uint32_t part : {kRoot, kArm, kHand, kProp}) {
            skin.joints.push_back(node_of(f, part));
            skin.joint_from_mesh.emplace_back();
        }
        scene.skins.push_back(std::move(skin));
        clip.channels.push_back({node_of(f, kProp), ChannelPath::kRotation, 1});
    }
    clip.channels.push_back({node_of(kDriven, kArm), ChannelPath::kRotation, 0});
    clip.channels.push_back({node_of(kDriven, kBody), ChannelPath::kWeights, 2});
    scene.clips.push_back(clip);
    scene.playback.clips = {ClipId{0}};
    return content;
}

FrameStats stats_at(Content& content, double time_s) {
    FrameStats stats;
    advance(content.scene, time_s, &stats);
    return stats;
}

TEST(Deformed, OneArmOfFiftyFiguresIsOneNode) {
    Content content = make_crowd();
    content.scene.rebuild.frame_rays = 0.0;  // Trees are refitted only.
    EXPECT_EQ(stats_at(content, 0.0).deformed, kFigures);
    struct Step {
        double time_s;
        uint32_t deformed;
    };
    // The arm bends; time stands still; the pose is held while props turn; a morph weight changes; back to the start.
    for (const Step& step : {Step{0.5, 1}, {0.5, 0}, {1.0, 1}, {1.5, 0}, {2.0, 0}, {2.5, 1}, {3.0, 1}, {3.5, 0}, {0.0, 1}}) {
        const FrameStats stats = stats_at(content, step.time_s);
        EXPECT_EQ(stats.deformed, step.deformed) << "at " << step.time_s;
        EXPECT_EQ(stats.kept, kFigures - step.deformed) << "at " << step.time_s;
        EXPECT_EQ(stats.refitted, step.deformed) << "at " << step.time_s;
        EXPECT_EQ(stats.rebuilt, 0u) << "at " << step.time_s;
    }
}

TEST(Deformed, WithoutAClipNothingIsAfterTheFirstFrame) {
    Content content = make_crowd();
    content.scene.playback.clips.clear();
    EXPECT_EQ(stats_at(content, 0.0).deformed, kFigures);
    EXPECT_EQ(stats_at(content, 1.0).deformed, 0u);
}

// What is not worked out is what it would be: no frame depends on the frames before.
TEST(Deformed, WhatIsLeftOutIsWhatAFreshSceneHas) {
    Content played = make_crowd();
    for (const double time_s : {0.0, 0.7, 2.4, 1.2, 3.9, 0.3}) {
        const Tlas& tlas = play(played, time_s);
        Content fresh = make_crowd();
        const Tlas& expected = play(fresh, time_s);
        for (uint32_t f = 0; f < kFigures; ++f) {
            const NodeId body = node_of(f, kBody);
            EXPECT_TRUE(std::ranges::equal(tlas[body].positions, expected[body].positions)) << "figure " << f;
            EXPECT_TRUE(std::ranges::equal(tlas[body].normals, expected[body].normals)) << "figure " << f;
        }
    }
}

size_t own_count(const Content& content) {
    return content.scene.frame->own_shapes.size();
}

// Nodes that show their mesh as it is stand in a tree that they share, and keep nothing of their own. Counters count them.
TEST(Deformed, OnlyWhatMayDeformHasMemoryOfItsOwn) {
    struct Look {
        const char* name;
        size_t own;
    };
    for (const Look& look : {Look{"static-500", 0},
                             {"rigid-7", 0},
                             {"instances-300", 0},
                             {"deforming-5", 1},
                             {"skinned-3", 3},
                             {"mixed-1", 2}}) {
        SCOPED_TRACE(look.name);
        Content content = make_content(look.name);
        if (content.write) content.write(content.scene, 0.0);
        bounds_at(content.scene, 0.5);  // Makes no trees.
        for (const double time_s : {0.0, 0.1, 0.2}) {
            FrameStats stats;
            play(content, time_s, &stats);
            const size_t shape_count = content.scene.frame->shapes.size();
            EXPECT_EQ(own_count(content), look.own) << "after " << time_s;
            EXPECT_EQ(stats.kept + stats.refitted + stats.rebuilt, shape_count) << "at " << time_s;
            EXPECT_GE(time_s == 0.0 ? stats.rebuilt : stats.kept, shape_count - look.own) << "at " << time_s;
        }
    }
}

TEST(Deformed, WhatIsWrittenAfterAFrameIsLookedAtAgain) {
    Content content = make_content("rigid-7");
    play(content, 0.0);
    const Instance before = play(content, 0.0).instances[0];
    const Mesh ball = make_sphere(0.1f, 6, 4);
    for (uint32_t mesh = 0; mesh < content.scene.meshes.size(); ++mesh) {
        content.scene.write_mesh(MeshId{mesh}, ball.positions, ball.normals, ball.corners);
    }
    for (const double time_s : {0.0, 0.1}) {
        const Tlas& tlas = play(content, time_s);
        EXPECT_EQ(own_count(content), 7u);
        for (const Instance& instance : tlas.instances) {
            EXPECT_EQ(instance.positions.size(), ball.positions.size());
            EXPECT_EQ(instance.motion, Motion::kArbitrary);
        }
    }
    EXPECT_NE(before.positions.size(), ball.positions.size());
}

}  // namespace
}  // namespace zoe::test
