// Nodes that move as a whole: LINEAR, STEP and CUBICSPLINE on all of TRS, mirrors, zero scale, and the skins and morph
// targets that move nothing of their own.

#include <cmath>

#include <gtest/gtest.h>

#include "content/shapes.h"
#include "engine/frame/classify.h"
#include "tests/frame/motion_class.h"

namespace zoe::test {
namespace {

constexpr float kLength_s = 4.0f;
const glm::dvec3 kAxis(1.0 / 3.0, 2.0 / 3.0, 2.0 / 3.0);
const glm::vec3 kPivotPlace{0.25f, 1.0f, -0.5f}, kArmPlace{1.25f, 0.0f, 0.25f}, kArmScale{-1.0f, 1.0f, 0.5f};
const glm::vec3 kLowJoint{0.0f, 0.5f, 0.0f}, kHighJoint{0.25f, 0.75f, 0.0f};
const glm::vec3 kLowBind{0.0f, -0.25f, 0.0f}, kHighBind{0.5f, -1.0f, 0.125f};

enum : uint32_t { kFloor, kPivot, kArm, kSlider, kBlinker, kSkinned, kLow, kHigh, kSpline, kMorphed, kNodeCount };

Mesh ring() {
    return make_torus(0.5f, 0.2f, 16, 8);
}
Mesh cube() {
    return make_box({-0.4f, -0.4f, -0.4f}, {0.4f, 0.4f, 0.4f});
}
Mesh pole() {
    return make_cylinder(0.15f, 0.0f, 1.5f, 9);
}
float high_weight(const glm::vec3& p) {
    return p.y > 0.75f ? 1.0f : 0.25f;
}

Node shown(MeshId mesh, NodeId parent = kNone<NodeId>) {
    Node node;
    node.mesh = mesh;
    node.parent = parent;
    return node;
}

Content make() {
    Content content;
    Scene& scene = content.scene;
    const MeshId floor = scene.add(make_grid(2, 2, 7.0f, 7.0f)), torus = scene.add(ring()), box = scene.add(cube());
    Mesh skinned = pole();
    skinned.binding.influence_count = 4;
    for (const glm::vec3& p : skinned.positions) {
        const float high = high_weight(p);
        skinned.binding.joints.insert(skinned.binding.joints.end(), {0, 1, 0, 0});
        skinned.binding.weights.insert(skinned.binding.weights.end(), {1 - high, high, 0, 0});
    }
    Mesh morphed = cube();
    morphed.targets.push_back({morphed.positions, {}});
    morphed.default_weights = {0.0f};

    scene.nodes.resize(kNodeCount);
    scene.nodes[kFloor] = shown(floor);
    scene.nodes[kFloor].local.translation = {0, -1, 0};
    scene.nodes[kPivot].local.translation = kPivotPlace;
    scene.nodes[kArm] = shown(torus, NodeId{kPivot});
    scene.nodes[kArm].local = {kArmPlace, glm::quat(1, 0, 0, 0), kArmScale};
    scene.nodes[kSlider] = shown(torus);
    scene.nodes[kBlinker] = shown(box);
    scene.nodes[kBlinker].local.translation = {-2, 0.5f, 2};
    scene.nodes[kSkinned] = shown(scene.add(std::move(skinned)));
    scene.nodes[kSkinned].local.translation = {100, 100, 100};  // A skin's own place does not matter.
    scene.nodes[kSkinned].skin = SkinId{0};
    scene.nodes[kLow].parent = NodeId{kPivot};
    scene.nodes[kLow].local.translation = kLowJoint;
    scene.nodes[kHigh].parent = NodeId{kLow};
    scene.nodes[kHigh].local.translation = kHighJoint;
    scene.nodes[kSpline] = shown(box);
    scene.nodes[kMorphed] = shown(scene.add(std::move(morphed)), NodeId{kPivot});
    scene.nodes[kMorphed].local.translation = {-1.5f, 0, 0};
    scene.nodes[kMorphed].weights = {0.5f};
    scene.skins.push_back({"pole", {NodeId{kLow}, NodeId{kHigh}}, {at(kLowBind), at(kHighBind)}});

    Clip clip;
    clip.duration_s = kLength_s;
    Sampler turning{.is_rotation = true, .width = 4};
    for (int k = 0; k <= 4; ++k) {
        const Quaternion q = turn(kAxis, 90.0 * k);
        turning.times_s.push_back(static_cast<float>(k));
        for (const double x : {q.x, q.y, q.z, q.w}) turning.values.push_back(static_cast<float>(x));
    }
    const Sampler sliding{.times_s = {0, 4}, .values = {-2, 0, 0, 2, 1, -1}};
    const Sampler blinking{
        .interpolation = Interpolation::kStep, .times_s = {0, 1.5f, 3}, .values = {1, 1, 1, 0, 0, 0, -2, -2, -2}};
    // In-tangent, value, out-tangent.
    const Sampler bending{.interpolation = Interpolation::kCubicSpline,
                          .times_s = {0, 4},
                          .values = {9, 9, 9, 2, 0, 2, 0, 1, -1, 0.5f, 0, 0, 2, 2, -1, 9, 9, 9}};
    clip.samplers = {turning, sliding, blinking, bending};
    clip.channels = {{NodeId{kPivot}, ChannelPath::kRotation, 0},
                     {NodeId{kSlider}, ChannelPath::kTranslation, 1},
                     {NodeId{kBlinker}, ChannelPath::kScale, 2},
                     {NodeId{kSpline}, ChannelPath::kTranslation, 3}};
    scene.clips.push_back(clip);
    scene.playback.clips = {ClipId{0}};
    return content;
}

AffineDouble moved(const glm::dvec3& place) {
    return from_trs(place, {}, {1, 1, 1});
}

// The frame at a time within the clip.
std::vector<WorldTriangle> truth_in_clip(double t) {
    std::vector<WorldTriangle> triangles;
    const auto add = [&](const Mesh& mesh, uint32_t node, std::initializer_list<AffineDouble> above) {
        add_triangles(to_double(mesh.positions), mesh.corners, node, above, &triangles);
    };
    add(make_grid(2, 2, 7.0f, 7.0f), kFloor, {moved({0, -1, 0})});
    const AffineDouble pivot = from_trs(glm::dvec3(kPivotPlace), turn(kAxis, 90.0 * t), {1, 1, 1});
    add(ring(), kArm, {pivot, from_trs(glm::dvec3(kArmPlace), {}, glm::dvec3(kArmScale))});
    add(ring(), kSlider, {moved({-2 + t, 0.25 * t, -0.25 * t})});
    if (t < 1.5) add(cube(), kBlinker, {moved({-2, 0.5, 2})});
    if (t >= 3.0) add(cube(), kBlinker, {from_trs({-2, 0.5, 2}, {}, {-2, -2, -2})});

    const Mesh skin = pole();
    std::vector<glm::dvec3> posed;
    for (const glm::vec3& p : skin.positions) {
        const double high = high_weight(p);
        const glm::dvec3 by_low = glm::dvec3(p) + glm::dvec3(kLowBind) + glm::dvec3(kLowJoint);
        const glm::dvec3 by_high = glm::dvec3(p) + glm::dvec3(kHighBind) + glm::dvec3(kHighJoint) + glm::dvec3(kLowJoint);
        posed.push_back((1 - high) * by_low + high * by_high);
    }
    add_triangles(posed, skin.corners, kSkinned, {pivot}, &triangles);

    const double s = t / 4.0, s2 = s * s, s3 = s2 * s;
    const glm::dvec3 bent = (2 * s3 - 3 * s2 + 1) * glm::dvec3(2, 0, 2) + (s3 - 2 * s2 + s) * 4.0 * glm::dvec3(0, 1, -1) +
                            (3 * s2 - 2 * s3) * glm::dvec3(2, 2, -1) + (s3 - s2) * 4.0 * glm::dvec3(0.5, 0, 0);
    add(cube(), kSpline, {moved(bent)});
    std::vector<glm::dvec3> grown = to_double(cube().positions);
    for (glm::dvec3& p : grown) p *= 1.5;
    add_triangles(grown, cube().corners, kMorphed, {pivot, moved({-1.5, 0, 0})}, &triangles);
    return triangles;
}

std::vector<WorldTriangle> truth(double time_s) {
    return truth_in_clip(std::fmod(time_s, 4.0));
}

// Keys and what lies between, a mirror, a frame where a node has no size, the loop's end, and a later round.
Case scene() {
    return {make, truth, {0.0, 0.4, 1.0, 1.5, 2.77, 3.0, 4.0, 7.9}};
}

TEST(RigidNodes, HitsEqualTheOraclesAtEightTimes) {
    expect_hits_equal_the_oracle(scene(), 11);
}

TEST(RigidNodes, AreRigidAndNoMore) {
    Content content = make();
    play(content, 0.0);
    for (const uint32_t k : {kPivot, kArm, kSlider, kBlinker, kSkinned, kLow, kHigh, kSpline, kMorphed}) {
        EXPECT_EQ(motion(content.scene, NodeId{k}), Motion::kRigid) << "node " << k;
    }
    EXPECT_EQ(motion(content.scene, NodeId{kFloor}), Motion::kStatic);
}

TEST(RigidNodes, AreBuiltOnceAndKept) {
    Content content = make();
    FrameStats first;
    play(content, 0.0, &first);
    EXPECT_EQ(first.refitted, 0u);
    EXPECT_GT(first.rebuilt, 0u);
    for (const double time_s : {0.1, 1.6, 3.3, 3.3, 0.0, 12.5}) {
        FrameStats stats;
        play(content, time_s, &stats);
        EXPECT_EQ(stats.kept, 7u) << "at " << time_s;
        EXPECT_EQ(stats.refitted + stats.rebuilt, 0u) << "at " << time_s;
    }
}

TEST(RigidNodes, ThatShowOneMeshShareItsTree) {
    Content content = make();
    const Tlas& tlas = play(content, 0.5);
    EXPECT_EQ(tlas[NodeId{kArm}].blas, tlas[NodeId{kSlider}].blas);
    EXPECT_EQ(tlas[NodeId{kBlinker}].blas, tlas[NodeId{kSpline}].blas);
}

TEST(RigidNodes, OfNoSizeAreLeftOutAndComeBack) {
    Content content = make();
    EXPECT_NE(play(content, 1.49).instance_of_node[kBlinker], 0xffffffffu);
    EXPECT_EQ(play(content, 1.5).instance_of_node[kBlinker], 0xffffffffu);
    EXPECT_NE(play(content, 3.0).instance_of_node[kBlinker], 0xffffffffu);
}

TEST(RigidNodes, HoldTheirLastKeyWhereClipsDoNotLoop) {
    const Case held{[] {
                        Content content = make();
                        content.scene.playback.is_looping = false;
                        return content;
                    },
                    [](double time_s) { return truth_in_clip(std::clamp(time_s, 0.0, 4.0)); },
                    {-3.0, 0.0, 0.7, 2.0, 3.999, 4.0, 4.1, 1000.0}};
    expect_hits_equal_the_oracle(held, 12);
}

TEST(RigidNodes, BoxesContainEveryVertex) {
    expect_boxes_contain_every_vertex(scene());
}

TEST(RigidNodes, JumpEqualsPlay) {
    expect_jump_equals_play(scene(), 13);
}

TEST(RigidNodes, ThreadsDoNotMatter) {
    expect_threads_do_not_matter(scene(), 14);
}

TEST(RigidNodes, MoreGeneralClassesChangeNothing) {
    expect_more_general_classes_change_nothing(scene(), 15);
}

TEST(RigidNodes, OrderOfNodesPermutesTheAnswer) {
    expect_order_of_nodes_permutes_the_answer(scene(), 16);
}

TEST(RigidNodes, TheMadeScenesAreRigid) {
    for (const char* name : {"rigid", "instances"}) {
        Content content = make_content(name, 30);
        play(content, 0.0);
        FrameStats stats;
        play(content, 1.7, &stats);
        EXPECT_EQ(stats.kept, 30u) << name;
        EXPECT_EQ(stats.refitted + stats.rebuilt, 0u) << name;
        for (const Instance& instance : play(content, 1.7).instances) EXPECT_EQ(instance.motion, Motion::kRigid) << name;
    }
}

}  // namespace
}  // namespace zoe::test
