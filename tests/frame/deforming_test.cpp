// Nodes whose vertices move while their triangles stay: skins, morph targets, and both.

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "content/shapes.h"
#include "engine/frame/classify.h"
#include "tests/frame/motion_class.h"

namespace zoe::test {
namespace {

enum : uint32_t { kFloor, kBump, kRig, kLow, kHigh, kTube, kBoth, kPump, kPiston, kBellows, kNodeCount };

const glm::vec3 kRigPlace{1.5f, -0.5f, 0.5f}, kBumpPlace{-2.0f, 0.25f, -0.5f}, kElbow{0.0f, 1.0f, 0.0f};
const glm::vec3 kPumpPlace{-1.0f, 0.0f, 2.0f};

Mesh bump() {
    return make_sphere(0.9f, 14, 8);
}
Mesh tube() {
    return make_cylinder(0.25f, 0.0f, 2.0f, 12);
}
// In four steps, so that more than the ends of the tube bend.
Mesh long_tube() {
    const glm::vec3 path[] = {{0, 0.1f, 0}, {0, 0.6f, 0}, {0, 1.0f, 0}, {0, 1.4f, 0}, {0, 1.9f, 0}};
    const float radii[] = {0.3f, 0.25f, 0.2f, 0.25f, 0.3f};
    return make_tube(path, radii, 10);
}
float high_weight(const glm::vec3& p) {
    return std::clamp(p.y - 0.5f, 0.0f, 1.0f);
}
// What the two targets of a mesh add.
glm::vec3 first_offset(const glm::vec3& p) {
    return {0.5f * p.y, 0.0f, 0.25f * p.x};
}
glm::vec3 second_offset(const glm::vec3& p) {
    return 0.5f * p;
}

void add_targets(Mesh* mesh) {
    mesh->targets.resize(2);
    for (const glm::vec3& p : mesh->positions) {
        mesh->targets[0].positions.push_back(first_offset(p));
        mesh->targets[1].positions.push_back(second_offset(p));
    }
    mesh->default_weights = {0, 0};
}

void bind(Mesh* mesh) {
    mesh->binding.influence_count = 4;
    for (const glm::vec3& p : mesh->positions) {
        const float high = high_weight(p);
        mesh->binding.joints.insert(mesh->binding.joints.end(), {0, 1, 0, 0});
        mesh->binding.weights.insert(mesh->binding.weights.end(), {1 - high, high, 0, 0});
    }
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
    Mesh morphed = bump(), bent = tube(), both = long_tube(), bellows = tube();
    add_targets(&morphed);
    add_targets(&both);
    bind(&bent);
    bind(&both);
    bind(&bellows);
    const MeshId floor = scene.add(make_grid(2, 2, 8.0f, 8.0f));

    scene.nodes.resize(kNodeCount);
    scene.nodes[kFloor] = shown(floor, {0, -1.25f, 0});
    scene.nodes[kBump] = shown(scene.add(std::move(morphed)), kBumpPlace);
    scene.nodes[kBump].local.scale = {1.0f, -1.5f, 0.75f};
    scene.nodes[kTube] = shown(scene.add(std::move(bent)), {50, 0, 0});
    scene.nodes[kTube].skin = SkinId{0};
    scene.nodes[kBoth] = shown(scene.add(std::move(both)), {0, 50, 0});
    scene.nodes[kBoth].skin = SkinId{0};
    scene.nodes[kBellows] = shown(scene.add(std::move(bellows)), {0, 0, 50});
    scene.nodes[kBellows].skin = SkinId{1};
    scene.nodes[kRig].local.translation = kRigPlace;
    scene.nodes[kLow].parent = NodeId{kRig};
    scene.nodes[kHigh].parent = NodeId{kLow};
    scene.nodes[kHigh].local.translation = kElbow;
    scene.nodes[kPump].local.translation = kPumpPlace;
    scene.nodes[kPiston].parent = NodeId{kPump};
    scene.nodes[kPiston].local.translation = kElbow;
    scene.skins.push_back({"arm", {NodeId{kLow}, NodeId{kHigh}}, {Affine{}, at(-kElbow)}});
    scene.skins.push_back({"pump", {NodeId{kPump}, NodeId{kPiston}}, {Affine{}, at(-kElbow)}});

    Clip clip;
    clip.duration_s = 4.0;
    const Sampler weights{.width = 2, .times_s = {0, 1, 3, 4}, .values = {0, 0, 1, -0.5f, 0.5f, 2, 0, 0}};
    const float h = std::sqrt(0.5f);
    const Sampler elbow{
        .is_rotation = true, .width = 4, .times_s = {0, 2, 4}, .values = {0, 0, 0, 1, 0, 0, h, h, 0, 0, 0, 1}};
    // The piston: full size, nothing, then mirrored.
    const Sampler piston{
        .interpolation = Interpolation::kStep, .times_s = {0, 1.5f, 2.5f}, .values = {1, 1, 1, 0, 0, 0, -1, -1, -1}};
    clip.samplers = {weights, elbow, piston};
    clip.channels = {{NodeId{kBump}, ChannelPath::kWeights, 0},
                     {NodeId{kBoth}, ChannelPath::kWeights, 0},
                     {NodeId{kHigh}, ChannelPath::kRotation, 1},
                     {NodeId{kPiston}, ChannelPath::kScale, 2}};
    scene.clips.push_back(clip);
    scene.playback.clips = {ClipId{0}};
    return content;
}

glm::dvec2 weights_at(double t) {
    if (t < 1) return {t, -0.5 * t};
    if (t < 3) return glm::mix(glm::dvec2(1, -0.5), glm::dvec2(0.5, 2), 0.5 * (t - 1));
    return glm::mix(glm::dvec2(0.5, 2), glm::dvec2(0), t - 3);
}

std::vector<glm::dvec3> morphed_at(const Mesh& mesh, double t) {
    const glm::dvec2 w = weights_at(t);
    std::vector<glm::dvec3> out;
    for (const glm::vec3& p : mesh.positions) {
        out.push_back(glm::dvec3(p) + w.x * glm::dvec3(first_offset(p)) + w.y * glm::dvec3(second_offset(p)));
    }
    return out;
}

// Blends what the low joint (which rests) and the high one make of each point. rest: before morphs; it has the weights.
std::vector<glm::dvec3> skinned(const Mesh& rest, std::vector<glm::dvec3> points, const AffineDouble& about_elbow) {
    const glm::dvec3 elbow(kElbow);
    for (size_t v = 0; v < points.size(); ++v) {
        const double high = high_weight(rest.positions[v]);
        points[v] = (1 - high) * points[v] + high * (elbow + about_elbow.vector(points[v] - elbow));
    }
    return points;
}

std::vector<WorldTriangle> truth(double time_s) {
    const double t = std::fmod(time_s, 4.0);
    std::vector<WorldTriangle> triangles;
    const auto moved = [](const glm::vec3& place) { return from_trs(glm::dvec3(place), {}, {1, 1, 1}); };
    const Mesh floor = make_grid(2, 2, 8.0f, 8.0f);
    add_triangles(to_double(floor.positions), floor.corners, kFloor, {moved({0, -1.25f, 0})}, &triangles);
    add_triangles(morphed_at(bump(), t), bump().corners, kBump, {from_trs(glm::dvec3(kBumpPlace), {}, {1, -1.5, 0.75})},
                  &triangles);

    const AffineDouble bent = from_trs({}, turn({0, 0, 1}, 45.0 * std::min(t, 4 - t)), {1, 1, 1});
    add_triangles(skinned(tube(), to_double(tube().positions), bent), tube().corners, kTube, {moved(kRigPlace)}, &triangles);
    const Mesh both = long_tube();
    add_triangles(skinned(both, morphed_at(both, t), bent), both.corners, kBoth, {moved(kRigPlace)}, &triangles);
    const double size = t < 1.5 ? 1 : t < 2.5 ? 0 : -1;
    const AffineDouble scaled = from_trs({}, {}, glm::dvec3(size));
    add_triangles(skinned(tube(), to_double(tube().positions), scaled), tube().corners, kBellows, {moved(kPumpPlace)},
                  &triangles);
    return triangles;
}

// Zero weights at both ends of the loop, exact keys, a joint of no size and a mirrored one.
Case scene() {
    return {make, truth, {0.0, 0.63, 1.0, 1.5, 2.2, 3.0, 4.0, 6.5}};
}

TEST(DeformingNodes, HitsEqualTheOraclesAtEightTimes) {
    expect_hits_equal_the_oracle(scene(), 21);
}

TEST(DeformingNodes, AreDeformingAndNothingElseIs) {
    Content content = make();
    play(content, 0.0);
    for (const uint32_t k : {kBump, kTube, kBoth, kBellows}) {
        EXPECT_EQ(motion(content.scene, NodeId{k}), Motion::kDeforming) << "node " << k;
    }
    EXPECT_EQ(motion(content.scene, NodeId{kFloor}), Motion::kStatic);
}

TEST(DeformingNodes, AreRefittedWhereTheyChangedAndNotRebuilt) {
    Content content = make();
    content.scene.rebuild.frame_rays = 0.0;  // Nothing is lost by refitting.
    FrameStats first;
    play(content, 0.0, &first);
    EXPECT_EQ(first.rebuilt, 5u);
    EXPECT_EQ(first.refitted, 0u);
    struct Step {
        double time_s;
        uint32_t refitted;  // The bellows change at 1.5 s and 2.5 s only.
    };
    for (const Step& step : {Step{0.1, 3}, {0.1, 0}, {1.2, 3}, {1.6, 4}, {1.9, 3}, {2.6, 4}, {2.6, 0}, {0.0, 4}, {4.0, 0}}) {
        FrameStats stats;
        play(content, step.time_s, &stats);
        EXPECT_EQ(stats.refitted, step.refitted) << "at " << step.time_s;
        EXPECT_EQ(stats.kept, 5u - step.refitted) << "at " << step.time_s;
        EXPECT_EQ(stats.rebuilt, 0u) << "at " << step.time_s;
    }
}

TEST(DeformingNodes, WithZeroWeightsAreTheRestPoseToTheBit) {
    Content content = make();
    const Tlas& tlas = play(content, 4.0);
    const Mesh rest = bump();
    const std::span<const glm::vec3> positions = tlas[NodeId{kBump}].positions;
    ASSERT_EQ(positions.size(), rest.positions.size());
    for (size_t v = 0; v < positions.size(); ++v) EXPECT_EQ(positions[v], rest.positions[v]);
}

TEST(DeformingNodes, BoxesContainEveryVertex) {
    expect_boxes_contain_every_vertex(scene());
}

TEST(DeformingNodes, JumpEqualsPlay) {
    expect_jump_equals_play(scene(), 22);
}

TEST(DeformingNodes, ThreadsDoNotMatter) {
    expect_threads_do_not_matter(scene(), 23);
}

TEST(DeformingNodes, MoreGeneralClassesChangeNothing) {
    expect_more_general_classes_change_nothing(scene(), 24);
}

TEST(DeformingNodes, OrderOfNodesPermutesTheAnswer) {
    expect_order_of_nodes_permutes_the_answer(scene(), 25);
}

// The travelling waves of the made scene, from its formula; at times between keys the weights are on the chord.
TEST(DeformingNodes, TheMadeClothIsTheSumOfItsWaves) {
    const int quads = 12;
    const Mesh flat = make_grid(quads, quads, 4.0f, 4.0f);
    const auto wave = [](double t, double turns, double height, const glm::dvec2& k, const glm::dvec3& p) {
        const double key = std::floor(t * 24.0), share = t * 24.0 - key;
        double sum = 0.0;
        for (const double end : {0.0, 1.0}) {
            const double angle = 2.0 * M_PI * turns * (key + end) / 96.0, weight = end > 0.0 ? share : 1.0 - share;
            sum += weight * height * std::cos(k.x * p.x + k.y * p.z - angle);
        }
        return sum;
    };
    const auto cloth = [&](double time_s) {
        const double t = std::fmod(time_s, 4.0);
        std::vector<glm::dvec3> points = to_double(flat.positions);
        for (glm::dvec3& p : points) p.y = wave(t, 2, 0.16, {3.0, 1.2}, p) + wave(t, 3, 0.09, {-1.5, 4.1}, p);
        std::vector<WorldTriangle> triangles;
        add_triangles(points, flat.corners, 0, {}, &triangles);
        return triangles;
    };
    const Case made{[] { return make_content("deforming", quads); }, cloth, {0.0, 0.25, 0.51, 1.0, 1.77, 2.5, 3.98, 4.0}};
    expect_hits_equal_the_oracle(made, 26);
}

TEST(DeformingNodes, TheMadeWalkersAreRefitted) {
    Content content = make_content("skinned", 2);
    content.scene.rebuild.frame_rays = 0.0;
    play(content, 0.0);
    FrameStats stats;
    play(content, 0.3, &stats);
    EXPECT_EQ(stats.refitted, 2u);
    EXPECT_EQ(stats.kept + stats.rebuilt, 0u);
    const Case walkers{[] { return make_content("skinned", 2); }, {}, {0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 3.5}};
    expect_boxes_contain_every_vertex(walkers);
}

}  // namespace
}  // namespace zoe::test
