#include <cmath>

#include <gtest/gtest.h>

#include "engine/frame/trace.h"
#include "engine/math/rng.h"
#include "engine/render/surface.h"
#include "tests/render/scenes.h"

namespace zoe::test {
namespace {

glm::vec3 random_direction(Rng& rng) {
    for (;;) {
        const glm::vec3 d(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1));
        const float length = glm::length(d);
        if (length > 0.01f && length <= 1.0f) return d / length;
    }
}

/// Places of an object of size 1: as it is, turned, stretched and mirrored, tiny, huge, and far from the origin.
std::vector<Trs> places() {
    const glm::quat turn = glm::angleAxis(0.7f, glm::normalize(glm::vec3(1, 2, 3)));
    const glm::quat none(1, 0, 0, 0);
    std::vector<Trs> result;
    for (float scale : {1e-3f, 1.0f, 1e3f, 1e6f}) {
        result.push_back({{0, 0, 0}, none, glm::vec3(scale)});
        result.push_back({scale * glm::vec3(3, -5, 2), turn, scale * glm::vec3(1.0f, 0.4f, -1.5f)});
        result.push_back({scale * glm::vec3(1000, 300, -700), turn, glm::vec3(scale)});
    }
    return result;
}

TEST(Leaks, RaysThatLeaveAConvexObjectNeverHitItAgain) {
    const uint64_t seed = 21;
    SCOPED_TRACE(seed);
    Rng rng(seed);
    for (const Trs& place : places()) {
        Scene scene;
        add_node(scene, make_sphere(3, add_diffuse(scene, glm::vec3(1.0f)), true), place);
        const Tlas& tlas = advance(scene, 0.0);
        const Affine world_from_local = to_affine(place);
        int self_hits = 0, leaks = 0, hits = 0;
        for (int i = 0; i < 20000; ++i) {
            const glm::vec3 from = world_from_local.point(3.0f * random_direction(rng));
            const glm::vec3 to = world_from_local.point(rng.uniform(0.0f, 0.999f) * random_direction(rng));
            const Ray ray{.origin = from, .direction = to - from};
            const Hit hit = closest_hit(tlas, ray);
            if (!hit) continue;
            ++hits;
            const Surface surface = surface_at(scene, tlas, ray, hit);
            glm::vec3 away = random_direction(rng);
            if (i % 4 == 0) away = glm::normalize(glm::cross(surface.ng, away) + 1e-4f * surface.ng);  // grazing
            if (glm::dot(away, surface.ng) < 0.0f) away = -away;
            self_hits += any_hit(tlas, {.origin = leave(surface, away), .direction = away}) ? 1 : 0;
            // The other way leads inside, from where everything is hit, but not the triangle that was left.
            if (i % 4 == 0) continue;
            const Hit inside = closest_hit(tlas, {.origin = leave(surface, -away), .direction = -away});
            leaks += inside && inside.primitive != hit.primitive ? 0 : 1;
        }
        EXPECT_GT(hits, 15000);
        EXPECT_EQ(self_hits, 0) << "scale " << place.scale.x << " at " << place.translation.x;
        EXPECT_EQ(leaks, 0) << "scale " << place.scale.x << " at " << place.translation.x;
    }
}

TEST(Leaks, TheInsideOfAClosedBoxIsExactlyBlackUnderABrightSky) {
    for (const Trs& place : places()) {
        Scene scene;
        add_node(scene, make_box(add_diffuse(scene, glm::vec3(1.0f), true)), place);
        const Affine world_from_local = to_affine(place);
        RenderConfig config;
        config.sky_strength = 100.0f;
        config.max_bounces = 16;
        const View view =
            look_at(world_from_local.point({0.1f, 0.2f, 0.5f}), world_from_local.point({0.3f, -0.1f, -1.0f}), 100.0f, 1.0f);
        const Film film = picture(scene, view, config, 32, 32, 16);
        int lit = 0;
        for (const glm::vec4& pixel : film.sum) lit += glm::vec3(pixel) == glm::vec3(0.0f) && pixel.a == 16.0f ? 0 : 1;
        EXPECT_EQ(lit, 0) << "scale " << place.scale.x << " at " << place.translation.x;
    }
}

TEST(Leaks, AFloorFarFromTheOriginHasNoAcne) {
    for (float far : {0.0f, 1e3f, 1e5f}) {
        Scene scene;
        add_node(scene, make_floor(10.0f, 0.0f, add_diffuse(scene, glm::vec3(1.0f))), {{far, far, -far}});
        const glm::vec3 at(far, far, -far);
        const Film film = picture(scene, look_at(at + glm::vec3(0, 4, 1), at, 60.0f, 1.0f), furnace(1), 32, 32, 4);
        for (const glm::vec4& pixel : film.sum) EXPECT_EQ(pixel.r, 4.0f);
    }
}

}  // namespace
}  // namespace zoe::test
