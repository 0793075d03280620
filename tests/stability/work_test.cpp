// Nothing that a scene may hold makes its rays slow: what they test, counted, beside what an ordinary scene's rays test.

#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "content/content.h"
#include "tests/math/random_inputs.h"
#include "tests/stability/scenes.h"

namespace zoe::test {
namespace {

/// Nodes and triangles that a ray tests, in the mean.
double work_of(const Tlas& tlas, const std::vector<Ray>& rays) {
    TraverseCounts counts;
    for (const Ray& ray : rays) closest_hit(tlas, ray, &counts);
    return static_cast<double>(counts.nodes + counts.triangles) / static_cast<double>(rays.size());
}

/// Through a ball around a point, from all sides.
std::vector<Ray> rays_at(const glm::vec3& centre, float radius, uint64_t seed) {
    Rng rng(seed);
    std::vector<Ray> rays;
    for (int k = 0; k < 400; ++k) {
        const glm::vec3 origin = centre + 3.0f * radius * random_direction(rng);
        rays.push_back({origin, centre + radius * random_point(rng, 0.9f) - origin});
    }
    return rays;
}

/// A ball, turned, scaled and moved.
double work_of_a_ball(float scale, const glm::vec3& place) {
    Rng rng(221);
    Scene scene;
    const MeshId mesh = scene.add(ball(48));
    add_node(scene, mesh, {glm::mat3_cast(random_rotation(rng)) * scale, place});
    return work_of(advance(scene, 0.0), rays_at(place, scale, 222));
}

TEST(Work, OfRaysIsTheSameAtAllScales) {
    const double ordinary = work_of_a_ball(1.0f, glm::vec3(0.0f));
    for (float scale = 1e-6f; scale < 2e6f; scale *= 10.0f) {
        EXPECT_LE(work_of_a_ball(scale, glm::vec3(0.0f)), 1.1 * ordinary) << scale;
    }
}

// Boxes are padded by what rounding needs, which grows with the distance.
TEST(Work, OfRaysFarFromTheOriginIsBounded) {
    const double ordinary = work_of_a_ball(1.0f, glm::vec3(0.0f));
    for (const float distance : {10.0f, 100.0f, 1e3f, 1e4f}) {
        EXPECT_LE(work_of_a_ball(1.0f, distance * glm::vec3(0.6f, 0.0f, -0.8f)), 2.0 * ordinary) << distance;
    }
}

TEST(Work, OfRaysAtTinyInstancesUnderAHugeOneIsLittleMore) {
    const auto work = [](bool has_stadium) {
        Scene scene;
        const MeshId mesh = scene.add(ball(16));
        if (has_stadium) add_node(scene, mesh, placed({0, 0, 0}, glm::vec3(1e4f)));
        std::vector<Ray> rays;
        for (int k = 0; k < 400; ++k) {
            const glm::vec3 place(k % 20, k / 20, 0);
            add_node(scene, mesh, placed(place, glm::vec3(0.3f)));
            const std::vector<Ray> at_it = rays_at(place, 0.3f, 223 + k);
            rays.insert(rays.end(), at_it.begin(), at_it.begin() + 10);
        }
        return work_of(advance(scene, 0.0), rays);
    };
    EXPECT_LE(work(true), 3.0 * work(false));
}

// A ray must ask each of them.
TEST(Work, OfRaysThroughCoincidentInstancesIsThatOfOneTimesTheirNumber) {
    const auto work = [](int count) {
        Scene scene;
        const MeshId mesh = scene.add(ball(24));
        for (int k = 0; k < count; ++k) add_node(scene, mesh, placed({0, 0, -5}));
        return work_of(advance(scene, 0.0), rays_at({0, 0, -5}, 1.0f, 224));
    };
    EXPECT_LE(work(200), 1.5 * 200.0 * work(1));
}

// Trees that were built for the first frame and have followed a clip since, beside those of a scene that begins at each
// frame.
TEST(Work, OfRaysThroughPlayedScenesIsLittleMoreThanThroughFreshOnes) {
    for (const char* const name : {"deforming-20", "skinned-1", "topology-10"}) {
        SCOPED_TRACE(name);
        const auto make = [&] {
            Content content = make_content(name);
            content.scene.clip_poses = 1;
            return content;
        };
        const auto frame_of = [](Content& content, int frame) -> const Tlas& {
            if (content.write) content.write(content.scene, frame / 24.0);
            return advance(content.scene, frame / 24.0);
        };
        Content content = make();
        double played = 0.0, fresh = 0.0;
        for (int frame = 0; frame <= 72; ++frame) {
            const Tlas& tlas = frame_of(content, frame);
            report_rays(content.scene, 100'000);
            if (frame % 12 != 0) continue;
            const Aabb bounds = tlas.bounds();
            const std::vector<Ray> rays = rays_at(bounds.centre(), 0.5f * glm::length(bounds.extent()), 225);
            played += work_of(tlas, rays);
            Content anew = make();
            fresh += work_of(frame_of(anew, frame), rays);
        }
        EXPECT_LE(0.9 * played, fresh);
    }
}

}  // namespace
}  // namespace zoe::test
