// Meshes that another program's hand writes each frame, and a mesh a frame: the number of triangles may change, too.

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "content/shapes.h"
#include "engine/frame/classify.h"
#include "engine/scene/sequence.h"
#include "tests/frame/motion_class.h"

namespace zoe::test {
namespace {

enum : uint32_t { kFloor, kPivot, kWritten, kSequence, kEmpty, kNodeCount };

const glm::vec3 kWrittenPlace{-1.0f, 0.5f, 0.0f}, kSequencePlace{1.5f, 0.0f, -0.5f};
constexpr double kFps = 4.0;

// A fan of loose triangles; how many there are, and where, depends on the time.
struct Shards {
    std::vector<glm::vec3> positions;
    std::vector<glm::uvec3> corners;
};

Shards shards_at(double time_s) {
    Shards shards;
    const bool is_gone = time_s >= 1.5 && time_s < 1.75;  // An empty mesh in these frames.
    const auto count =
        is_gone ? 0u : 8u + static_cast<uint32_t>(std::floor((time_s - 4.0 * std::floor(time_s / 4.0)) * 12.0));
    const auto away = static_cast<float>(0.25 * time_s);
    for (uint32_t i = 0; i < count; ++i) {
        const float angle = 2.39996f * static_cast<float>(i), height = 0.05f * static_cast<float>(i) - 1.0f;
        const glm::vec3 middle((0.6f + away) * std::cos(angle), height, (0.6f + away) * std::sin(angle));
        shards.positions.push_back(middle + glm::vec3(0.5f, 0.1f, 0));
        shards.positions.push_back(middle + glm::vec3(-0.3f, 0.4f, 0.1f * away));
        shards.positions.push_back(middle + glm::vec3(0, -0.2f, 0.5f));
        shards.corners.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    return shards;
}

// The meshes of the sequence: one of them is empty.
Mesh sequence_mesh(int frame) {
    if (frame == 3) return {};
    return frame % 2 ? make_torus(0.6f, 0.2f + 0.02f * static_cast<float>(frame), 9 + frame, 6)
                     : make_sphere(0.5f + 0.05f * static_cast<float>(frame), 8 + frame, 5);
}

Content make() {
    Content content;
    Scene& scene = content.scene;
    scene.nodes.resize(kNodeCount);
    scene.nodes[kFloor].mesh = scene.add(make_grid(2, 2, 8.0f, 8.0f));
    scene.nodes[kFloor].local.translation = {0, -1.5f, 0};
    scene.nodes[kPivot].local.translation = {0, 0.25f, 0};
    const MeshId written = scene.add(Mesh{});
    scene.nodes[kWritten].mesh = written;
    scene.nodes[kWritten].parent = NodeId{kPivot};
    scene.nodes[kWritten].local = {kWrittenPlace, glm::quat(1, 0, 0, 0), {1.0f, 1.5f, -0.75f}};
    MeshSequence sequence{.meshes = {}, .fps = kFps};
    for (int frame = 0; frame < 6; ++frame) sequence.meshes.push_back(scene.add(sequence_mesh(frame)));
    scene.nodes[kSequence].mesh = sequence.meshes.front();
    scene.nodes[kSequence].sequence = sequence;
    scene.nodes[kSequence].local.translation = kSequencePlace;
    const MeshId empty = scene.add(Mesh{});
    scene.nodes[kEmpty].mesh = empty;
    Clip clip;
    clip.duration_s = 4.0;
    const float h = std::sqrt(0.5f);
    clip.samplers = {{.is_rotation = true, .width = 4, .times_s = {0, 4}, .values = {0, 0, 0, 1, 0, h, 0, h}}};
    clip.channels = {{NodeId{kPivot}, ChannelPath::kRotation, 0}};
    scene.clips.push_back(clip);
    scene.playback.clips = {ClipId{0}};
    content.write = [written, empty](Scene& s, double time_s) {
        const Shards shards = shards_at(time_s);
        s.write_mesh(written, shards.positions, {}, shards.corners);
        s.write_mesh(empty, {}, {}, {});
    };
    return content;
}

std::vector<WorldTriangle> truth(double time_s) {
    std::vector<WorldTriangle> triangles;
    const Mesh floor = make_grid(2, 2, 8.0f, 8.0f);
    add_triangles(to_double(floor.positions), floor.corners, kFloor, {from_trs({0, -1.5, 0}, {}, {1, 1, 1})}, &triangles);
    const Shards shards = shards_at(time_s);
    const double degrees = 90.0 * std::fmod(time_s, 4.0) / 4.0;
    add_triangles(to_double(shards.positions), shards.corners, kWritten,
                  {from_trs({0, 0.25, 0}, turn({0, 1, 0}, degrees), {1, 1, 1}),
                   from_trs(glm::dvec3(kWrittenPlace), {}, {1, 1.5, -0.75})},
                  &triangles);
    const Mesh shown = sequence_mesh(static_cast<int>(std::floor(time_s * kFps)) % 6);
    add_triangles(to_double(shown.positions), shown.corners, kSequence,
                  {from_trs(glm::dvec3(kSequencePlace), {}, {1, 1, 1})}, &triangles);
    return triangles;
}

// The sequence lasts 1.5 s; at 0.8 s its mesh is the empty one, at 1.5 s the written one is empty.
Case scene() {
    return {make, truth, {0.0, 0.25, 0.8, 1.5, 1.75, 2.9, 4.0, 5.3}};
}

TEST(ArbitraryNodes, HitsEqualTheOraclesAtEightTimes) {
    expect_hits_equal_the_oracle(scene(), 31);
}

TEST(ArbitraryNodes, AreArbitraryAndNothingElseIs) {
    Content content = make();
    play(content, 0.0);
    for (const uint32_t k : {kWritten, kSequence, kEmpty}) {
        EXPECT_EQ(motion(content.scene, NodeId{k}), Motion::kArbitrary) << "node " << k;
    }
    EXPECT_EQ(motion(content.scene, NodeId{kFloor}), Motion::kStatic);
}

TEST(ArbitraryNodes, AreRebuiltWhereTheyWereWrittenOnly) {
    Content content = make();
    play(content, 0.0);
    FrameStats written;
    play(content, 0.1, &written);
    EXPECT_EQ(written.rebuilt, 2u);  // Both written meshes; the sequence still shows its first.
    EXPECT_EQ(written.kept, 2u);
    EXPECT_EQ(written.refitted, 0u);
    FrameStats paused;
    advance(content.scene, 0.1, &paused);
    EXPECT_EQ(paused.kept, 4u);
    FrameStats turned;
    advance(content.scene, 0.2, &turned);  // The pivot turns, nothing is written.
    EXPECT_EQ(turned.kept, 4u);
    FrameStats next;
    advance(content.scene, 0.3, &next);  // The sequence goes on.
    EXPECT_EQ(next.rebuilt, 1u);
    EXPECT_EQ(next.kept, 3u);
}

TEST(ArbitraryNodes, BecomeSoWithTheFirstWrite) {
    Content content = make();
    advance(content.scene, 0.0);
    EXPECT_EQ(motion(content.scene, NodeId{kWritten}), Motion::kRigid);
    EXPECT_EQ(motion(content.scene, NodeId{kEmpty}), Motion::kStatic);
    play(content, 0.0);
    EXPECT_EQ(motion(content.scene, NodeId{kWritten}), Motion::kArbitrary);
    EXPECT_EQ(motion(content.scene, NodeId{kEmpty}), Motion::kArbitrary);
}

TEST(ArbitraryNodes, AreNotHitWhereTheyAreEmpty) {
    Content content = make();
    EXPECT_NE(play(content, 1.4).instance_of_node[kWritten], 0xffffffffu);
    EXPECT_EQ(play(content, 1.6).instance_of_node[kWritten], 0xffffffffu);
    EXPECT_NE(play(content, 1.8).instance_of_node[kWritten], 0xffffffffu);
    EXPECT_EQ(play(content, 0.75).instance_of_node[kSequence], 0xffffffffu);
}

TEST(ArbitraryNodes, HoldTheSequencesLastMeshWhereClipsDoNotLoop) {
    Content content = make();
    content.scene.playback.is_looping = false;
    EXPECT_EQ(play(content, 77.0)[NodeId{kSequence}].positions.size(), sequence_mesh(5).positions.size());
    EXPECT_EQ(play(content, -1.0)[NodeId{kSequence}].positions.size(), sequence_mesh(0).positions.size());
}

TEST(ArbitraryNodes, ShowTheMeshOfEachFrameNumberExactly) {
    // frame / fps * fps may round to just below the frame: 96 frames of 24 a second, and other rates.
    for (const double fps : {24.0, 25.0, 29.97, 30.0, 60.0, 7.0}) {
        Content content;
        MeshSequence sequence{.meshes = {}, .fps = fps};
        for (int frame = 0; frame < 96; ++frame) {
            Mesh mesh = make_box({0, 0, 0}, glm::vec3(1.0f + static_cast<float>(frame)));
            sequence.meshes.push_back(content.scene.add(std::move(mesh)));
        }
        Node node;
        node.sequence = sequence;
        const NodeId id = content.scene.add(std::move(node));
        for (int frame = 0; frame < 200; ++frame) {
            const Tlas& tlas = play(content, frame / fps);
            EXPECT_EQ(tlas[id].bounds_world.hi.x, 1.0f + static_cast<float>(frame % 96))
                << "frame " << frame << " at " << fps;
        }
    }
}

TEST(ArbitraryNodes, AreNeverHitWhereTheyAreNotFinite) {
    Content content = make();
    const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
    const glm::vec3 positions[] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {nan, 0, 0}, {0, infinity, 0}};
    const glm::uvec3 corners[] = {{0, 1, 3}, {0, 1, 2}, {0, 4, 2}};
    const MeshId mesh = content.scene[NodeId{kEmpty}].mesh;
    content.scene.write_mesh(mesh, positions, {}, corners);
    const Tlas& tlas = advance(content.scene, 0.5);
    const Hit hit = closest_hit(tlas, {.origin = {0.2f, 0.2f, 4.0f}, .direction = {0, 0, -1}});
    EXPECT_EQ(hit.node, NodeId{kEmpty});
    EXPECT_EQ(hit.primitive, 1u);
    EXPECT_FLOAT_EQ(hit.t, 4.0f);
    EXPECT_FALSE(content.scene.warnings().empty());
}

TEST(ArbitraryNodes, AreRefusedWithCornersThatAreNotThere) {
    Content content = make();
    const glm::vec3 positions[] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    const glm::uvec3 corners[] = {{0, 1, 3}};
    const glm::vec3 normal{0, 0, 1};
    const MeshId mesh = content.scene[NodeId{kEmpty}].mesh;
    EXPECT_THROW(content.scene.write_mesh(mesh, positions, {}, corners), SceneError);
    EXPECT_THROW(content.scene.write_mesh(mesh, positions, {&normal, 1}, {}), SceneError);
    EXPECT_THROW(content.scene.write_mesh(kNone<MeshId>, positions, {}, {}), SceneError);
    EXPECT_TRUE(content.scene[mesh].positions.empty());
}

TEST(ArbitraryNodes, BoxesContainEveryVertex) {
    expect_boxes_contain_every_vertex(scene());
}

TEST(ArbitraryNodes, JumpEqualsPlay) {
    expect_jump_equals_play(scene(), 32);
}

TEST(ArbitraryNodes, ThreadsDoNotMatter) {
    expect_threads_do_not_matter(scene(), 33);
}

TEST(ArbitraryNodes, MoreGeneralClassesChangeNothing) {
    expect_more_general_classes_change_nothing(scene(), 34);
}

TEST(ArbitraryNodes, OrderOfNodesPermutesTheAnswer) {
    expect_order_of_nodes_permutes_the_answer(scene(), 35);
}

TEST(ArbitraryNodes, TheMadeScenesAreArbitraryAndChange) {
    for (const char* name : {"arbitrary", "topology"}) {
        Content content = make_content(name, 20);
        const Tlas& tlas = play(content, 0.0);
        EXPECT_EQ(motion(content.scene, NodeId{0}), Motion::kArbitrary) << name;
        const size_t count = tlas[NodeId{0}].mesh->corners.size();
        EXPECT_GT(count, 10u) << name;
        FrameStats stats;
        play(content, 1.1, &stats);
        EXPECT_EQ(stats.rebuilt, 1u) << name;
        if (name != std::string("topology")) continue;
        EXPECT_NE(play(content, 1.1)[NodeId{0}].mesh->corners.size(), count);
    }
}

TEST(ArbitraryNodes, TheMadeMixedSceneShowsEveryClass) {
    for (const char* name : {"mixed", "default"}) {
        Content content = make_content(name, name == std::string("mixed") ? 1 : 0);
        uint32_t counts[kMotionCount] = {};
        for (const Instance& instance : play(content, 0.4).instances) ++counts[static_cast<int>(instance.motion)];
        for (int m = 0; m < kMotionCount; ++m) EXPECT_GT(counts[m], 0u) << name << " " << zoe::name(static_cast<Motion>(m));
        const Case made{[&] { return make_content(name, name == std::string("mixed") ? 1 : 0); }, {}, {0.0, 1.0, 2.3, 4.0}};
        expect_boxes_contain_every_vertex(made);
    }
}

}  // namespace
}  // namespace zoe::test
