// Nodes that never move: nested transforms, shear, mirrors, zero scale, channels that change nothing.

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "content/shapes.h"
#include "engine/frame/classify.h"
#include "tests/frame/motion_class.h"

namespace zoe::test {
namespace {

constexpr float kLength_s = 4.0f;

enum : uint32_t {
    kGround,
    kParent,
    kTurned,
    kMirrored,
    kSheared,
    kHidden,
    kStill,
    kCamera,
    kCameraArm,
    kFlat,
    kMorphed,
    kNodeCount
};

const glm::vec3 kParentPlace{0.5f, 1.0f, -0.25f}, kTurnedPlace{1.5f, 0.25f, 0.5f};
const glm::quat kParentTurn(0.8f, 0.0f, 0.6f, 0.0f);  // 2 atan2(0.6, 0.8) about Y.
const Affine kShear{glm::mat3(glm::vec3(1, 0.25f, 0), glm::vec3(0.5f, 1, 0), glm::vec3(0, -0.75f, 1.5f)), {-2, 1, 1}};

AffineDouble sheared() {
    return {{1, 0.25, 0}, {0.5, 1, 0}, {0, -0.75, 1.5}, {-2, 1, 1}};
}

Node shown(MeshId mesh, const glm::vec3& place) {
    Node node;
    node.mesh = mesh;
    node.local.translation = place;
    return node;
}

Content make() {
    Content content;
    Scene& scene = content.scene;
    const MeshId ground = scene.add(make_grid(3, 2, 8.0f, 6.0f)), ring = scene.add(make_torus(0.7f, 0.25f, 18, 9));
    Mesh morphed = make_box({-0.5f, -0.5f, -0.5f}, {0.5f, 0.5f, 0.5f});
    morphed.targets.push_back({morphed.positions, {}});  // Twice its size at weight 1.
    morphed.default_weights = {0.25f};
    const MeshId box = scene.add(std::move(morphed));

    scene.nodes.resize(kNodeCount);
    scene.nodes[kGround] = shown(ground, {0, -1, 0});
    scene.nodes[kParent].local = {kParentPlace, kParentTurn, {1.5f, 0.5f, 1.0f}};
    scene.nodes[kTurned] = shown(ring, kTurnedPlace);
    scene.nodes[kTurned].parent = NodeId{kParent};
    scene.nodes[kMirrored] = shown(ring, {-1.5f, 0.5f, -1.5f});
    scene.nodes[kMirrored].local.scale = {-1.0f, 2.0f, 0.5f};
    scene.nodes[kSheared] = shown(ring, {});
    scene.nodes[kSheared].matrix = kShear;
    scene.nodes[kHidden] = shown(ring, {0, 0.5f, 0});
    scene.nodes[kHidden].local.scale = glm::vec3(0.0f);
    scene.nodes[kStill] = shown(ring, {2.0f, 0.5f, -2.0f});
    scene.nodes[kCameraArm].local.translation = {0, 0, 3};
    scene.nodes[kCamera].parent = NodeId{kCameraArm};
    scene.nodes[kCamera].camera = CameraId{0};
    scene.nodes[kFlat] = shown(ring, {3, 1, 2});
    scene.nodes[kFlat].local.scale = {1, 0, 1};  // Flat: no inverse, so it is not shown.
    scene.nodes[kMorphed] = shown(box, {3, 0.5f, 0.5f});
    scene.cameras.resize(1);

    // The camera's arm swings; a node is given its own place again and again; a weight stays what it is.
    Clip clip;
    clip.duration_s = kLength_s;
    clip.samplers.resize(3);
    clip.samplers[0].times_s = clip.samplers[1].times_s = clip.samplers[2].times_s = {0.0f, kLength_s};
    clip.samplers[0].values = {0, 0, 3, 5, 0, 3};
    clip.samplers[1].values = {2.0f, 0.5f, -2.0f, 2.0f, 0.5f, -2.0f};
    clip.samplers[2].width = 1;
    clip.samplers[2].values = {0.5f, 0.5f};
    clip.channels = {{NodeId{kCameraArm}, ChannelPath::kTranslation, 0},
                     {NodeId{kStill}, ChannelPath::kTranslation, 1},
                     {NodeId{kMorphed}, ChannelPath::kWeights, 2}};
    scene.clips.push_back(clip);
    scene.playback.clips = {ClipId{0}};
    return content;
}

std::vector<WorldTriangle> truth(double) {
    const Mesh ground = make_grid(3, 2, 8.0f, 6.0f), ring = make_torus(0.7f, 0.25f, 18, 9);
    const Mesh box = make_box({-0.5f, -0.5f, -0.5f}, {0.5f, 0.5f, 0.5f});
    std::vector<WorldTriangle> triangles;
    const std::vector<glm::dvec3> ring_points = to_double(ring.positions);
    const auto add_ring = [&](uint32_t node, std::initializer_list<AffineDouble> above) {
        add_triangles(ring_points, ring.corners, node, above, &triangles);
    };
    add_triangles(to_double(ground.positions), ground.corners, kGround, {from_trs({0, -1, 0}, {}, {1, 1, 1})}, &triangles);
    add_ring(kTurned, {from_trs(glm::dvec3(kParentPlace), {0, 0.6, 0, 0.8}, {1.5, 0.5, 1}),
                       from_trs(glm::dvec3(kTurnedPlace), {}, {1, 1, 1})});
    add_ring(kMirrored, {from_trs({-1.5, 0.5, -1.5}, {}, {-1, 2, 0.5})});
    add_ring(kSheared, {sheared()});
    add_ring(kStill, {from_trs({2, 0.5, -2}, {}, {1, 1, 1})});
    std::vector<glm::dvec3> grown = to_double(box.positions);
    for (glm::dvec3& p : grown) p *= 1.5;
    add_triangles(grown, box.corners, kMorphed, {from_trs({3, 0.5, 0.5}, {}, {1, 1, 1})}, &triangles);
    return triangles;
}

Case scene() {
    return {make, truth, {0.0, 0.37, 1.0, 1.93, 2.5, 3.21, 4.0, 9.75}};
}

TEST(StaticNodes, HitsEqualTheOraclesAtEightTimes) {
    expect_hits_equal_the_oracle(scene(), 1);
}

TEST(StaticNodes, AreStaticWhateverAnimatesNothingOfThem) {
    Content content = make();
    play(content, 0.0);
    for (uint32_t k = 0; k < kNodeCount; ++k) {
        const bool is_moved = k == kCamera || k == kCameraArm;
        EXPECT_EQ(motion(content.scene, NodeId{k}), is_moved ? Motion::kRigid : Motion::kStatic) << "node " << k;
    }
}

TEST(StaticNodes, AreBuiltOnceAndKept) {
    Content content = make();
    FrameStats first;
    play(content, 0.0, &first);
    const uint32_t shown_count = 8;  // All with a mesh, shown or scaled to nothing.
    EXPECT_EQ(first.rebuilt + first.kept, shown_count);
    EXPECT_GT(first.rebuilt, 0u);
    EXPECT_EQ(first.refitted, 0u);
    for (const double time_s : {0.0, 1.3, 3.9, 0.2, 17.0}) {
        FrameStats stats;
        play(content, time_s, &stats);
        EXPECT_EQ(stats.kept, shown_count) << "at " << time_s;
        EXPECT_EQ(stats.refitted + stats.rebuilt, 0u) << "at " << time_s;
    }
}

TEST(StaticNodes, ThatShowOneMeshShareItsTree) {
    Content content = make();
    const Tlas& tlas = play(content, 0.0);
    EXPECT_EQ(tlas[NodeId{kTurned}].blas, tlas[NodeId{kMirrored}].blas);
    EXPECT_NE(tlas[NodeId{kTurned}].blas, tlas[NodeId{kGround}].blas);
}

TEST(StaticNodes, WithoutAnInverseAreLeftOutWithAWarning) {
    Content content = make();
    const Tlas& tlas = play(content, 0.0);
    EXPECT_EQ(tlas.instances.size(), 6u);
    EXPECT_EQ(tlas.instance_of_node[kHidden], 0xffffffffu);
    EXPECT_EQ(tlas.instance_of_node[kFlat], 0xffffffffu);
    EXPECT_FALSE(content.scene.warnings().empty());
}

TEST(StaticNodes, BoxesContainEveryVertex) {
    expect_boxes_contain_every_vertex(scene());
}

TEST(StaticNodes, JumpEqualsPlay) {
    expect_jump_equals_play(scene(), 2);
}

TEST(StaticNodes, ThreadsDoNotMatter) {
    expect_threads_do_not_matter(scene(), 3);
}

TEST(StaticNodes, MoreGeneralClassesChangeNothing) {
    expect_more_general_classes_change_nothing(scene(), 4);
}

TEST(StaticNodes, OrderOfNodesPermutesTheAnswer) {
    expect_order_of_nodes_permutes_the_answer(scene(), 5);
}

TEST(StaticNodes, AnEmptySceneIsMissedByEverything) {
    Content content;
    const Tlas& tlas = play(content, 1.0);
    EXPECT_TRUE(tlas.instances.empty());
    EXPECT_FALSE(closest_hit(tlas, Ray{}));
    EXPECT_FALSE(any_hit(tlas, Ray{}));
    Mesh nothing;
    Node node;
    node.mesh = content.scene.add(std::move(nothing));
    content.scene.add(std::move(node));
    content.scene.touch();
    EXPECT_FALSE(closest_hit(play(content, 1.0), Ray{}));
}

TEST(StaticNodes, TheMadeSceneIsStatic) {
    Content content = make_content("static", 3000);
    FrameStats first, second;
    play(content, 0.0, &first);
    play(content, 2.0, &second);
    EXPECT_EQ(second.kept,
              std::ranges::count_if(content.scene.nodes, [](const Node& n) { return n.mesh != kNone<MeshId>; }));
    for (uint32_t k = 0; k < content.scene.nodes.size(); ++k) EXPECT_EQ(motion(content.scene, NodeId{k}), Motion::kStatic);
}

}  // namespace
}  // namespace zoe::test
