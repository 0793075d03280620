// The box of a frame without its trees.

#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "content/content.h"
#include "engine/frame/bounds_at.h"
#include "engine/frame/frame.h"
#include "engine/frame/trace.h"
#include "tests/math/random_inputs.h"

namespace zoe::test {
namespace {

constexpr double kTimes_s[] = {0.0, 0.6, 3.1};

Content make(const ContentInfo& info) {
    Content content = make_content(info.name, info.max_size == 0 ? 0 : 3);
    content.scene.tree_build.budget_s = 0.0;  // Quick builds: hits are the same.
    return content;
}

Aabb bounds_of(Content& content, double time_s) {
    if (content.write) content.write(content.scene, time_s);
    return bounds_at(content.scene, time_s);
}

const Tlas& play(Content& content, double time_s, FrameStats* stats) {
    if (content.write) content.write(content.scene, time_s);
    return advance(content.scene, time_s, stats);
}

std::vector<Hit> hits_of(const Tlas& tlas, uint64_t seed) {
    Rng rng(seed);
    const Aabb box = tlas.bounds();
    std::vector<Ray> rays;
    for (int k = 0; k < 400; ++k) {
        const glm::vec3 origin = box.centre() + glm::length(box.extent()) * random_direction(rng);
        const glm::vec3 target = box.centre() + 0.4f * random_point(rng, 1.0f) * box.extent();
        rays.push_back({.origin = origin, .direction = target - origin});
    }
    std::vector<Hit> hits(rays.size());
    closest_hits(tlas, rays, hits);
    return hits;
}

TEST(BoundsAt, IsTheBoxOfTheFrameToTheLastBitAndBuildsNothing) {
    for (const ContentInfo& info : content_list()) {
        Content framed = make(info), played = make(info);
        for (const double time_s : kTimes_s) {
            const Aabb box = bounds_of(framed, time_s), expected = play(played, time_s, nullptr).bounds();
            EXPECT_EQ(box.lo, expected.lo) << info.name << " at " << time_s;
            EXPECT_EQ(box.hi, expected.hi) << info.name << " at " << time_s;
        }
        // The first frame after it still has everything to build, once.
        FrameStats after_framing, fresh;
        Content other = make(info);
        play(framed, 0.25, &after_framing);
        play(other, 0.25, &fresh);
        EXPECT_EQ(after_framing.rebuilt, fresh.rebuilt) << info.name;
        EXPECT_EQ(after_framing.kept, fresh.kept) << info.name;
        EXPECT_GT(after_framing.rebuilt, 0u) << info.name;
    }
}

TEST(BoundsAt, ChangesNoHitsBeforeOrBetweenFrames) {
    for (const ContentInfo& info : content_list()) {
        Content framed = make(info);
        for (const double time_s : kTimes_s) {
            bounds_of(framed, time_s + 0.4);
            Content fresh = make(info);
            const std::vector<Hit> hits = hits_of(play(framed, time_s, nullptr), 301);
            EXPECT_EQ(hits, hits_of(play(fresh, time_s, nullptr), 301)) << info.name << " at " << time_s;
            const Aabb same = bounds_of(framed, time_s);
            const Tlas& again = play(framed, time_s, nullptr);
            EXPECT_EQ(same.lo, again.bounds().lo) << info.name << " at " << time_s;
            EXPECT_EQ(hits_of(again, 301), hits) << info.name << " at " << time_s;
        }
    }
}

TEST(BoundsAt, OfNothingThatCanBeHitIsEmpty) {
    Scene scene;
    EXPECT_TRUE(bounds_at(scene, 0.0).is_empty());
    Mesh mesh;
    mesh.positions.assign(3, glm::vec3(std::nanf("")));
    mesh.corners = {{0, 1, 2}};
    Node node;
    node.mesh = scene.add(mesh);
    scene.add(node);
    EXPECT_TRUE(bounds_at(scene, 0.0).is_empty());
    EXPECT_THROW(bounds_at(scene, std::numeric_limits<double>::infinity()), std::invalid_argument);
}

}  // namespace
}  // namespace zoe::test
