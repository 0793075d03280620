// A tube that bends at its elbow as dual quaternions have it, from the formula: both joints turn about one axis through the
// elbow, so every vertex turns about it, by an angle between theirs.

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "content/shapes.h"
#include "tests/frame/motion_class.h"

namespace zoe::test {
namespace {

enum : uint32_t { kRig, kLow, kHigh, kTube, kTwin };

const glm::vec3 kPlace{0.5f, -0.5f, 0.25f}, kElbow{0.0f, 1.0f, 0.0f};

Mesh tube() {
    const glm::vec3 path[] = {{0, 0.1f, 0}, {0, 0.6f, 0}, {0, 0.9f, 0}, {0, 1.2f, 0}, {0, 1.5f, 0}, {0, 1.9f, 0}};
    const float radii[] = {0.3f, 0.25f, 0.2f, 0.2f, 0.25f, 0.3f};
    return make_tube(path, radii, 10);
}

float high_weight(const glm::vec3& p) {
    return std::clamp(p.y - 0.5f, 0.0f, 1.0f);
}

// The rig is mirrored, and twice as large as the file says; its joints are as they are.
Content make() {
    Content content;
    Scene& scene = content.scene;
    Mesh mesh = tube();
    mesh.binding.influence_count = 4;
    for (const glm::vec3& p : mesh.positions) {
        mesh.binding.joints.insert(mesh.binding.joints.end(), {0, 1, 0, 0});
        mesh.binding.weights.insert(mesh.binding.weights.end(), {1 - high_weight(p), high_weight(p), 0, 0});
    }
    const MeshId shown = scene.add(std::move(mesh));
    scene.nodes.resize(5);
    scene.nodes[kRig].local.translation = kPlace;
    scene.nodes[kRig].local.scale = glm::vec3(-2.0f, 2.0f, 2.0f);
    scene.nodes[kLow].parent = NodeId{kRig};
    scene.nodes[kHigh].parent = NodeId{kLow};
    scene.nodes[kHigh].local.translation = kElbow;
    scene.nodes[kTube].mesh = shown;
    scene.nodes[kTube].skin = SkinId{0};
    scene.nodes[kTwin].mesh = shown;  // It follows one joint only in the end: both are the lower one.
    scene.nodes[kTwin].skin = SkinId{1};
    scene.skins.push_back({"arm", {NodeId{kLow}, NodeId{kHigh}}, {Affine{}, at(-kElbow)}, Skinning::kDualQuaternion});
    scene.skins.push_back(
        {"stiff", {NodeId{kLow}, NodeId{kLow}}, {at({2, 0, 0}), at({2, 0, 0})}, Skinning::kDualQuaternion});

    Clip clip;
    clip.duration_s = 4.0;
    const float h = std::sqrt(0.5f);  // By 90 degrees at 1 s and 180 at 2 s.
    clip.samplers = {
        {.is_rotation = true, .width = 4, .times_s = {0, 1, 2, 3, 4}, .values = {0, 0, 0, 1, 0, 0, h, h, 0, 0,
                                                                                 1, 0, 0, 0, h, h, 0, 0, 0, 1}}};
    clip.channels = {{NodeId{kHigh}, ChannelPath::kRotation, 0}};
    scene.clips.push_back(clip);
    scene.playback.clips = {ClipId{0}};
    return content;
}

std::vector<WorldTriangle> truth(double time_s) {
    const double t = std::fmod(time_s, 4.0), angle = 90.0 * std::min(t, 4.0 - t);
    const double half = angle * M_PI / 360.0;
    const Mesh mesh = tube();
    const glm::dvec3 elbow(kElbow);
    std::vector<glm::dvec3> points, moved;
    for (const glm::vec3& p : mesh.positions) {
        const double high = high_weight(p);
        const double blended = 2.0 * std::atan2(high * std::sin(half), 1.0 - high + high * std::cos(half)) * 180.0 / M_PI;
        const AffineDouble turned = from_trs({}, turn({0, 0, 1}, blended), {1, 1, 1});
        points.push_back(elbow + turned.vector(glm::dvec3(p) - elbow));
        moved.push_back(glm::dvec3(p) + glm::dvec3(2, 0, 0));
    }
    std::vector<WorldTriangle> triangles;
    const AffineDouble rig = from_trs(glm::dvec3(kPlace), {}, {-2, 2, 2});
    add_triangles(points, mesh.corners, kTube, {rig}, &triangles);
    add_triangles(moved, mesh.corners, kTwin, {rig}, &triangles);
    return triangles;
}

Case scene() {
    return {make, truth, {0.0, 0.37, 1.0, 1.5, 1.99, 2.6, 3.3, 4.0}};
}

TEST(DualQuaternionNodes, AnswerLikeAllDeformingNodes) {
    expect_all(scene(), 41);
}

// Two triangles side by side, whose joints are scaled by 1e-3 and by 1e38: the former is where it belongs, though it lists
// the other joint without weight; the latter is dropped, and a warning says so.
TEST(DualQuaternionNodes, AJointThatOverflowsTakesItsOwnTrianglesOnly) {
    Scene scene;
    Mesh mesh;
    for (const float x : {0.0f, 3000.0f}) {
        mesh.positions.insert(mesh.positions.end(), {{x, 0, 0}, {x + 2000, 0, 0}, {x, 2000, 0}});
    }
    mesh.corners = {{0, 1, 2}, {3, 4, 5}};
    mesh.binding.influence_count = 4;
    for (const uint16_t own : {0, 0, 0, 1, 1, 1}) {
        mesh.binding.joints.insert(mesh.binding.joints.end(), {own, uint16_t(1 - own), 0, 0});
        mesh.binding.weights.insert(mesh.binding.weights.end(), {1, 0, 0, 0});
    }
    Node small, huge, shown;
    small.local.scale = glm::vec3(1e-3f);
    huge.local.scale = glm::vec3(1e38f);
    shown.mesh = scene.add(std::move(mesh));
    shown.skin = SkinId{0};
    const std::vector<NodeId> joints = {scene.add(small), scene.add(huge)};
    scene.skins.push_back({"apart", joints, {Affine{}, Affine{}}, Skinning::kDualQuaternion});
    const NodeId id = scene.add(shown);
    const Tlas& tlas = advance(scene, 0.0);
    const Hit hit = closest_hit(tlas, {.origin = {0.5f, 0.5f, 7}, .direction = {0, 0, -1}});
    ASSERT_TRUE(hit);
    EXPECT_EQ(hit.primitive, 0u);
    EXPECT_NEAR(hit.t, 7.0f, 1e-5f);
    for (size_t v = 0; v < 3; ++v) {
        const glm::vec3 expected = 1e-3f * scene[shown.mesh].positions[v];
        EXPECT_LT(glm::distance(tlas[id].positions[v], expected), 1e-5f) << "vertex " << v;
    }
    ASSERT_EQ(scene.warnings().size(), 1u);
    EXPECT_NE(scene.warnings().begin()->first.find("1 triangle with NaN or infinite corners"), std::string::npos);
}

}  // namespace
}  // namespace zoe::test
