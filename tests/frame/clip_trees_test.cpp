// Trees of deforming nodes that are built over a clip: what they cost, and that they change no hit.

#include <gtest/gtest.h>

#include "content/shapes.h"
#include "engine/zoetrope.h"
#include "tests/frame/rebuild_sequences.h"
#include "tests/math/random_inputs.h"

namespace zoe::test {
namespace {

constexpr double kDuration = 2.0;

/// Separate triangles that fly to another place each, and that a clip of 2 s takes there and back.
Scene flight(uint64_t seed) {
    Scene scene;
    Mesh mesh = from_triangles(make_sphere(1.0f, 40, 24));
    Rng rng(seed);
    MorphTarget target;
    for (size_t k = 0; k < mesh.positions.size(); k += 3) {
        const glm::vec3 offset = random_point(rng, 4.0f);
        target.positions.insert(target.positions.end(), 3, offset);
    }
    mesh.targets.push_back(target);
    mesh.default_weights = {0.0f};
    mesh.normals.clear();
    Node node;
    node.mesh = scene.add(std::move(mesh));
    const NodeId id = scene.add(std::move(node));
    Clip clip;
    clip.duration_s = kDuration;
    Sampler sampler;
    sampler.width = 1;
    sampler.times_s = {0.0f, 1.0f, 2.0f};
    sampler.values = {0.0f, 1.0f, 0.0f};
    clip.samplers.push_back(sampler);
    clip.channels.push_back({.node = id, .path = ChannelPath::kWeights, .sampler = 0});
    scene.clips.push_back(clip);
    scene.playback.clips = {ClipId{0}};
    scene.rebuild.frame_rays = 0;  // Trees are refitted only.
    return scene;
}

double mean_cost(Scene& scene) {
    double sum = 0.0;
    constexpr int kCount = 13;
    for (int k = 0; k < kCount; ++k) sum += advance(scene, kDuration * k / kCount).instances[0].blas->tree.summed_cost();
    return sum / kCount;
}

TEST(ClipTrees, CostLessOverTheClipThanThoseOfItsFirstFrame) {
    for (const uint64_t seed : {1, 2, 3}) {
        Scene of_first = flight(seed), over_clip = flight(seed);
        of_first.clip_poses = 1;
        EXPECT_LT(mean_cost(over_clip), 0.8 * mean_cost(of_first)) << "seed " << seed;
    }
}

TEST(ClipTrees, AreTheSameWhateverFrameComesFirst) {
    Scene early = flight(4), late = flight(4);
    advance(early, 0.1);
    advance(late, 1.3);
    EXPECT_EQ(advance(early, 0.7).instances[0].blas->tree.summed_cost(),
              advance(late, 0.7).instances[0].blas->tree.summed_cost());
}

TEST(ClipTrees, ChangeNoHit) {
    Scene of_first = flight(5), over_clip = flight(5);
    of_first.clip_poses = 1;
    for (const double time_s : {0.0, 0.3, 1.0, 1.7, 5.1}) {
        const Tlas &a = advance(of_first, time_s), &b = advance(over_clip, time_s);
        Rng rng(6);
        for (int k = 0; k < 2000; ++k) {
            const glm::vec3 origin = random_direction(rng) * 8.0f;
            const Ray ray{.origin = origin, .direction = random_point(rng, 2.0f) - origin};
            const Hit one = closest_hit(a, ray), other = closest_hit(b, ray);
            ASSERT_EQ(one.t, other.t) << "seed 6, ray " << k << ", at " << time_s << " s";
            ASSERT_EQ(one.primitive, other.primitive);
            ASSERT_EQ(one.u, other.u);
            ASSERT_EQ(one.v, other.v);
        }
    }
}

TEST(ClipTrees, AreNotMadeWhereNothingPlays) {
    Scene still = flight(7), of_first = flight(7);
    still.playback.clips.clear();
    of_first.playback.clips.clear();
    of_first.clip_poses = 1;
    EXPECT_EQ(advance(still, 0.0).instances[0].blas->tree.summed_cost(),
              advance(of_first, 0.0).instances[0].blas->tree.summed_cost());
}

}  // namespace
}  // namespace zoe::test
