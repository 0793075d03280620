// Frames after edits, and after frames that threw: what is kept of before is never shown.

#include <gtest/gtest.h>

#include "content/content.h"
#include "content/shapes.h"
#include "engine/frame/bounds_at.h"
#include "engine/zoetrope.h"
#include "tests/math/random_inputs.h"

namespace zoe::test {
namespace {

/// The same as from the scene anew.
void expect_as_fresh(Scene& scene, double time_s) {
    Rng rng(17);
    std::vector<Ray> rays(2000);
    for (Ray& ray : rays) {
        ray.origin = random_direction(rng) * 9.0f;
        ray.direction = random_point(rng, 1.5f) - ray.origin;
    }
    std::vector<Hit> kept(rays.size()), fresh(rays.size());
    closest_hits(advance(scene, time_s), rays, kept);
    scene.touch();
    closest_hits(advance(scene, time_s), rays, fresh);
    for (size_t k = 0; k < rays.size(); ++k) {
        ASSERT_EQ(kept[k].t, fresh[k].t) << "seed 17, ray " << k;
        ASSERT_EQ(kept[k].primitive, fresh[k].primitive);
        ASSERT_EQ(kept[k].node, fresh[k].node);
    }
}

/// A ball that a clip of 2 s morphs. Its mesh is a cage where a level is given.
Scene morphing_ball(int level) {
    Scene scene;
    Mesh mesh = make_sphere(1.0f, 12, 8);
    mesh.normals.clear();
    mesh.uvs = {};
    if (level > 0) {
        Cage cage;
        for (const glm::uvec3& t : mesh.corners) {
            cage.face_sizes.push_back(3);
            cage.vertices.insert(cage.vertices.end(), {t.x, t.y, t.z});
        }
        SubdivisionSurface surface{.cage = cage, .options = {.level = level}};
        mesh.surface = std::move(surface);
    }
    MorphTarget target;
    // The lower half stays.
    for (const glm::vec3& p : mesh.positions) target.positions.push_back(p.y > 0.0f ? 0.7f * p : glm::vec3(0.0f));
    mesh.targets.push_back(target);
    mesh.default_weights = {0.0f};
    Node node;
    node.mesh = scene.add(std::move(mesh));
    const NodeId id = scene.add(std::move(node));
    Clip clip;
    clip.duration_s = 2.0;
    clip.samplers = {{.width = 1, .times_s = {0, 1, 2}, .values = {0, 1, 0}}};
    clip.channels.push_back({.node = id, .path = ChannelPath::kWeights, .sampler = 0});
    scene.clips.push_back(clip);
    scene.playback.clips = {ClipId{0}};
    return scene;
}

TEST(Edits, AFrameThatThrewLeavesNothingBehind) {
    Scene scene = morphing_ball(0);
    advance(scene, 0.0);
    scene.viewpoint = Viewpoint{};
    scene.viewpoint->node = NodeId{99};
    EXPECT_THROW(advance(scene, 0.9), SceneError);
    scene.viewpoint.reset();
    expect_as_fresh(scene, 0.9);
}

TEST(Edits, AMorphedCageMayBeWrittenAgainAndAgain) {
    Scene scene = morphing_ball(2);
    if (const std::string problem = check(scene); !problem.empty()) FAIL() << problem;
    const std::vector<glm::vec3> rest = scene.meshes[0].positions;
    for (const float size : {1.1f, 0.6f, 1.4f}) {
        std::vector<glm::vec3> positions = rest;
        for (glm::vec3& p : positions) p *= size;
        scene.write_cage(MeshId{0}, positions);
        expect_as_fresh(scene, 0.5);
    }
}

TEST(Edits, AWrittenCageMayBeWrittenAsAMesh) {
    Scene scene = morphing_ball(2);
    scene.write_cage(MeshId{0}, std::vector<glm::vec3>(scene.meshes[0].positions));
    advance(scene, 0.0);
    const Mesh other = make_sphere(0.8f, 9, 5);
    scene.write_mesh(MeshId{0}, other.positions, {}, other.corners);
    advance(scene, 0.0);
    EXPECT_EQ(motion(scene, NodeId{0}), Motion::kArbitrary);
    expect_as_fresh(scene, 0.0);
}

TEST(Edits, AViewpointMayGoAndComeBack) {
    Scene scene = morphing_ball(1);
    scene.meshes[0].surface->pixels = 0.5f;
    Viewpoint viewpoint;
    viewpoint.eye_world = {0, 0, 2.5f};
    viewpoint.height_pixels = 500;
    viewpoint.hysteresis = 0.0f;
    scene.viewpoint = viewpoint;
    advance(scene, 0.4);
    scene.viewpoint.reset();
    advance(scene, 0.4);
    scene.viewpoint = viewpoint;
    expect_as_fresh(scene, 0.4);
}

/// Boxes asked for between frames make trees anew: memory for later ones is taken once.
TEST(Edits, BoundsBetweenFramesDoNotAddUp) {
    Scene scene = morphing_ball(0);
    advance(scene, 0.0);
    size_t most = 0;
    for (int frame = 0; frame < 60; ++frame) {
        bounds_at(scene, 0.01 * frame);
        const Tlas& tlas = advance(scene, 0.005 * frame);
        most = std::max(most, tlas.instances[0].blas->blocks.capacity());
    }
    EXPECT_LE(most, 4 * scene.meshes[0].corners.size());
}

}  // namespace
}  // namespace zoe::test
