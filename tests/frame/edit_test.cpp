// Scenes that are edited between frames.

#include <gtest/gtest.h>

#include <stdexcept>
#include <vector>

#include "engine/frame/classify.h"
#include "engine/frame/frame.h"
#include "engine/math/parallel.h"

namespace zoe {
namespace {

// `count` triangles side by side along x, facing +z.
Mesh strip(int count) {
    Mesh mesh;
    for (int k = 0; k < count; ++k) {
        const float x = static_cast<float>(k);
        const uint32_t first = static_cast<uint32_t>(mesh.positions.size());
        mesh.positions.insert(mesh.positions.end(), {{x, 0, 0}, {x + 1, 0, 0}, {x, 1, 0}});
        mesh.corners.push_back({first, first + 1, first + 2});
    }
    return mesh;
}

void write(Scene& scene, MeshId id, int count) {
    const Mesh mesh = strip(count);
    scene.write_mesh(id, mesh.positions, {}, mesh.corners);
}

Hit shoot_down(const Tlas& tlas, float x) {
    return closest_hit(tlas, {.origin = {x, 0.25f, 5}, .direction = {0, 0, -1}});
}

// A skin and a morph target, both of which a write drops.
Scene deformed_scene() {
    Scene scene;
    Mesh mesh = strip(1);
    mesh.binding.influence_count = 4;
    mesh.binding.joints.assign(12, 0);
    mesh.binding.weights = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0};
    mesh.targets = {{.positions = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}}, .normals = {}}};
    mesh.default_weights = {0.5f};
    Node joint, node;
    node.mesh = scene.add(mesh);
    node.skin = SkinId{0};
    node.weights = {1.0f};
    const NodeId joint_id = scene.add(joint);
    scene.skins.push_back({"skin", {joint_id}, {Affine{}}});
    const NodeId shown = scene.add(node);
    Clip clip;
    clip.samplers = {{.interpolation = Interpolation::kLinear, .width = 1, .times_s = {0, 1}, .values = {0, 1}}};
    clip.channels = {{shown, ChannelPath::kWeights, 0}};
    clip.duration_s = 1.0;
    scene.clips = {clip};
    scene.playback.clips = {ClipId{0}};
    return scene;
}

TEST(Edit, WritesOfAnyCountReplaceSkinAndMorphTargets) {
    for (const bool is_played_first : {false, true}) {
        Scene scene = deformed_scene();
        if (is_played_first) advance(scene, 0.5);
        for (const int count : {1, 4, 5, 2}) {
            write(scene, MeshId{0}, count);
            const Tlas& tlas = advance(scene, 0.5);
            EXPECT_EQ(motion(scene, NodeId{1}), Motion::kArbitrary);
            for (int k = 0; k < 6; ++k) {
                const Hit hit = shoot_down(tlas, static_cast<float>(k) + 0.25f);
                EXPECT_EQ(static_cast<bool>(hit), k < count) << count << " triangles, at " << k;
                if (hit) {
                    EXPECT_EQ(hit.t, 5.0f);
                }
            }
        }
        EXPECT_EQ(scene.warnings().size(), 1u) << "what was dropped is said once";
    }
}

TEST(Edit, NodesAndMeshesAddedAfterAFrameAreShownInTheNext) {
    Scene scene;
    Node node;
    node.mesh = scene.add(strip(1));
    scene.add(node);
    advance(scene, 0.0);
    for (int k = 0; k < 2000; ++k) {
        node.local.translation.x = static_cast<float>(2 * k + 2);
        scene.add(node);
    }
    node.mesh = scene.add(strip(3));
    node.local.translation = {0, 3, 0};
    const NodeId last = scene.add(node);
    const Tlas& tlas = advance(scene, 0.0);
    EXPECT_EQ(tlas.instances.size(), 2002u);
    EXPECT_EQ(shoot_down(tlas, 4000.25f).node, NodeId{2000});
    EXPECT_EQ(tlas[last].mesh, &scene[node.mesh]);
}

TEST(Edit, WhatIsAskedTooEarlyOrOfNoOneThrows) {
    Scene scene;
    scene.add(Node{});
    EXPECT_THROW(motion(scene, NodeId{0}), std::logic_error);
    EXPECT_THROW(world_from_node(scene, NodeId{0}), std::logic_error);
    EXPECT_THROW(set_motion(scene, kNone<NodeId>, Motion::kRigid), std::out_of_range);
    advance(scene, 0.0);
    scene.playback.clips = {ClipId{7}};
    EXPECT_THROW(advance(scene, 0.0), SceneError);
}

// Each scene's loops run inside a task of the outer one: threads that wait must not take up another scene's frame.
TEST(Edit, ScenesMayAdvanceInParallel) {
    set_thread_count(4);
    std::vector<Scene> scenes(48);
    for (Scene& scene : scenes) {
        for (int k = 0; k < 6; ++k) {
            Node node;
            node.mesh = scene.add(strip(3000));
            node.motion = Motion::kArbitrary;
            scene.add(node);
        }
    }
    for (int round = 0; round < 4; ++round) {
        std::vector<size_t> shown(scenes.size());
        parallel_for(0, scenes.size(), 1, [&](size_t begin, size_t end) {
            for (size_t k = begin; k < end; ++k) {
                for (uint32_t mesh = 0; mesh < 6; ++mesh) write(scenes[k], MeshId{mesh}, 2000 + round);
                shown[k] = advance(scenes[k], 0.0).instances.size();
            }
        });
        for (size_t k = 0; k < scenes.size(); ++k) EXPECT_EQ(shown[k], 6u) << "scene " << k << ", round " << round;
    }
    set_thread_count(0);
}

// A channel that `classify` calls constant must also play as one, to the bit, or nodes that stand still are rebuilt.
TEST(Edit, ConstantChannelsKeepEveryTree) {
    Scene scene;
    Mesh mesh = strip(2);
    mesh.binding.influence_count = 4;
    mesh.binding.joints.assign(24, 0);
    mesh.binding.weights.assign(24, 0.25f);
    Node joint, node;
    node.mesh = scene.add(mesh);
    node.skin = SkinId{0};
    const NodeId joint_id = scene.add(joint);
    scene.skins.push_back({"skin", {joint_id}, {Affine{}}});
    const NodeId shown = scene.add(node);
    Clip clip;
    const std::vector<float> q = {0.1f, 0.7f, -0.3f, 0.64031242f};
    std::vector<float> keys(q), spline;
    for (const float x : q) keys.push_back(-x);
    for (int key = 0; key < 2; ++key) spline.insert(spline.end(), {0, 0, 0, 0.1f, 0.7f, 0.3f, 0, 0, 0});
    clip.samplers = {{.is_rotation = true, .width = 4, .times_s = {0, 1}, .values = keys},
                     {.interpolation = Interpolation::kCubicSpline, .width = 3, .times_s = {0, 1}, .values = spline}};
    clip.channels = {{joint_id, ChannelPath::kRotation, 0}, {joint_id, ChannelPath::kTranslation, 1}};
    clip.duration_s = 1.0;
    scene.clips = {clip};
    scene.playback.clips = {ClipId{0}};
    advance(scene, 0.0);
    EXPECT_EQ(motion(scene, shown), Motion::kStatic);
    for (int frame = 1; frame < 100; ++frame) {
        FrameStats stats;
        advance(scene, frame * 0.0101, &stats);
        EXPECT_EQ(stats.kept, 1u) << "frame " << frame;
    }
}

}  // namespace
}  // namespace zoe
