// Scenes far from (0, 0, 0): their world begins where `Scene::origin` says.

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "content/content.h"
#include "content/shapes.h"
#include "engine/frame/frame.h"
#include "engine/frame/trace.h"
#include "tests/math/random_inputs.h"

namespace zoe {
namespace {

const glm::vec3 kFar{16777216.0f, -33554432.0f, 8388608.0f};

// A turning box, a skinned pole that bends and a still floor, all under one node at `place`. Translations are such that
// none is rounded when `place` is added in double precision.
Scene make_scene(const glm::vec3& place) {
    Scene scene;
    const MeshId floor = scene.add(make_grid(4, 4, 6.0f, 6.0f)), box = scene.add(make_box({-1, -1, -1}, {1, 1, 1}));
    Mesh pole = make_cylinder(0.25f, 0.0f, 2.0f, 12);
    pole.binding.influence_count = 4;
    for (const glm::vec3& p : pole.positions) {
        pole.binding.joints.insert(pole.binding.joints.end(), {0, 1, 0, 0});
        pole.binding.weights.insert(pole.binding.weights.end(), {1 - p.y / 2, p.y / 2, 0, 0});
    }
    const MeshId bent = scene.add(pole);
    enum : uint32_t { kRoot, kFloor, kBox, kPole, kLow, kHigh, kCount };
    scene.nodes.resize(kCount);
    scene.nodes[kRoot].local.translation = place;
    for (const uint32_t k : {kFloor, kBox, kPole, kLow, kHigh}) scene.nodes[k].parent = NodeId{kRoot};
    scene.nodes[kFloor].mesh = floor;
    scene.nodes[kFloor].local.translation = {0, -1.5f, 0};
    scene.nodes[kBox].mesh = box;
    scene.nodes[kBox].local.translation = {-1.5f, 0.25f, 0};
    scene.nodes[kPole].mesh = bent;
    scene.nodes[kPole].skin = SkinId{0};
    scene.nodes[kLow].local.translation = {1.5f, -1.0f, 0};
    scene.nodes[kHigh].local.translation = {1.5f, 1.0f, 0};
    scene.skins.push_back({"pole", {NodeId{kLow}, NodeId{kHigh}}, {Affine{}, Affine{glm::mat3(1.0f), {0, -2, 0}}}});
    Clip clip{"turn", {}, {}, 2.0};
    const float half = std::sqrt(0.5f);
    clip.samplers.push_back({.is_rotation = true, .width = 4, .times_s = {0, 2}, .values = {0, 0, 0, 1, 0, half, 0, half}});
    for (const uint32_t k : {kBox, kHigh}) clip.channels.push_back({NodeId{k}, ChannelPath::kRotation, 0});
    scene.clips.push_back(clip);
    scene.playback = {{ClipId{0}}, true};
    return scene;
}

std::vector<Hit> hits_around(const Tlas& tlas, const glm::vec3& centre, uint64_t seed) {
    Rng rng(seed);
    std::vector<Ray> rays;
    for (int k = 0; k < 4000; ++k) {
        const glm::vec3 from = centre + test::random_point(rng, 4.0f);
        rays.push_back({.origin = from, .direction = centre + test::random_point(rng, 1.5f) - from});
    }
    std::vector<Hit> hits(rays.size());
    closest_hits(tlas, rays, hits);
    return hits;
}

size_t count_other_nodes(const std::vector<Hit>& a, const std::vector<Hit>& b) {
    size_t count = 0;
    for (size_t k = 0; k < a.size(); ++k) count += a[k].node != b[k].node;
    return count;
}

TEST(Origin, MakesAFarSceneAsExactAsANearOne) {
    Scene near = make_scene(glm::vec3(0.0f)), far = make_scene(kFar), unaided = make_scene(kFar);
    far.origin = glm::dvec3(kFar);
    for (const double time_s : {0.0, 0.3, 1.1, 1.9}) {
        SCOPED_TRACE(::testing::Message() << "seed 7, time " << time_s << " s");
        const std::vector<Hit> expected = hits_around(advance(near, time_s), glm::vec3(0.0f), 7);
        EXPECT_GE(count_other_nodes(expected, std::vector<Hit>(expected.size())), expected.size() / 4);
        EXPECT_EQ(hits_around(advance(far, time_s), glm::vec3(0.0f), 7), expected);
        // Which is worth it: at that distance floats are 1 to 4 metres apart.
        EXPECT_GE(count_other_nodes(hits_around(advance(unaided, time_s), kFar, 7), expected), expected.size() / 20);
    }
}

TEST(Origin, IsTakenOffInDoublePrecisionHoweverDeepTheNode) {
    const glm::dvec3 origin(1.0e7, -3.0e7, 0.25);
    Scene scene;
    glm::dvec3 expected(0.0);
    // A spiral of quarter turns about +y, each a step further out.
    glm::dvec3 step(1.0e6 / 16, 0.125, 0.375);
    for (uint32_t k = 0; k < 41; ++k) {
        Node node;
        node.parent = k == 0 ? kNone<NodeId> : NodeId{k - 1};
        node.local.translation = glm::vec3(1.0e6f / 16, 0.125f, 0.375f);
        node.local.rotation = glm::quat(std::sqrt(0.5f), 0, std::sqrt(0.5f), 0);
        scene.add(node);
        expected += step;
        step = {step.z, step.y, -step.x};
    }
    scene.origin = origin;
    advance(scene, 0.0);
    const NodeId last{40};
    EXPECT_LE(glm::length(place_in_scene(scene, last) - expected), 1e-8);
    const glm::vec3 world = world_from_node(scene, last).translation;
    EXPECT_EQ(world, glm::vec3(place_in_scene(scene, last) - origin));
}

const Tlas& frame_of(Content* content) {
    constexpr double kTime_s = 0.7;
    if (content->write) content->write(content->scene, kTime_s);
    return advance(content->scene, kTime_s);
}

TEST(Origin, LeavesNoHistory) {
    for (const char* name : {"default", "mixed-1"}) {
        Content played = make_content(name);
        for (const double x : {0.0, 3.0, -700.0, 0.0}) {
            SCOPED_TRACE(::testing::Message() << name << ", origin x " << x << ", seed 8");
            Content fresh = make_content(name);
            played.scene.origin = fresh.scene.origin = {x, 0.5, 2.0};
            const glm::vec3 centre = glm::vec3(0.0f, 1.0f, 0.0f) - glm::vec3(fresh.scene.origin);
            const std::vector<Hit> expected = hits_around(frame_of(&fresh), centre, 8);
            EXPECT_EQ(hits_around(frame_of(&played), centre, 8), expected);
        }
    }
}

}  // namespace
}  // namespace zoe
