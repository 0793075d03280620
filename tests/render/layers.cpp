// Albedo, normals and motion of what pixels show.

#include "engine/render/layers.h"

#include <cmath>

#include <gtest/gtest.h>
#include <glm/gtc/quaternion.hpp>

#include "engine/math/parallel.h"
#include "engine/render/geometry.h"
#include "engine/render/past_frame.h"
#include "engine/render/path.h"
#include "tests/render/scenes.h"
#include "tests/support/same_bits.h"

namespace zoe::test {
namespace {

constexpr int kWidth = 48, kHeight = 32;

/// Where a view shows a point, in pixels to the right and up, in double precision.
glm::dvec2 place(const View& view, const glm::dvec3& point) {
    const glm::dvec3 offset = point - glm::dvec3(view.origin);
    const double ahead = view.is_perspective ? -glm::dot(offset, glm::dvec3(view.axis_z)) : 1.0;
    return {0.5 * kWidth * glm::dot(offset, glm::dvec3(view.axis_x)) / ahead / view.half_width,
            0.5 * kHeight * glm::dot(offset, glm::dvec3(view.axis_y)) / ahead / view.half_height};
}

View looking(const glm::vec3& eye) {
    return look_at(eye, {0, 0, 0}, 50.0f, float(kWidth) / kHeight);
}

/// What the rays through pixels' centres meet, by themselves.
std::vector<Hit> hits_of(const Tlas& tlas, const View& view) {
    std::vector<Hit> hits;
    for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
            hits.push_back(closest_hit(
                tlas, camera_ray(view, static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f, kWidth, kHeight)));
        }
    }
    return hits;
}

/// Where the ray of a pixel meets something.
glm::dvec3 point_at(const View& view, size_t k, const Hit& hit) {
    const Ray ray =
        camera_ray(view, static_cast<float>(k % kWidth) + 0.5f, static_cast<float>(k / kWidth) + 0.5f, kWidth, kHeight);
    return glm::dvec3(ray.origin) + double(hit.t) * glm::dvec3(ray.direction);
}

Layers layers_of(const Scene& scene, const Tlas& tlas, const View& view, const PastFrame* past) {
    Film film(kWidth, kHeight);
    Layers layers;
    layers.past = past;
    see_geometry(scene, tlas, view, &film, &layers);
    return layers;
}

PastFrame kept(const Tlas& tlas, const View& view) {
    PastFrame past;
    past.keep(tlas, view);
    return past;
}

TEST(Layers, HoldColoursAndNormalsOfWhatIsHit) {
    Scene scene;
    add_node(scene, make_sphere(4, add_diffuse(scene, {0.2f, 0.4f, 0.6f}), true));
    const View view = looking({0, 0, 4});
    const Tlas& tlas = advance(scene, 0.0);
    const std::vector<Hit> hits = hits_of(tlas, view);
    const Layers layers = layers_of(scene, tlas, view, nullptr);
    int hit_count = 0;
    for (size_t k = 0; k < hits.size(); ++k) {
        if (!hits[k]) {
            EXPECT_EQ(layers.albedo[k], glm::vec3(0.0f));
            EXPECT_EQ(layers.normal[k], glm::vec3(0.0f));
            continue;
        }
        ++hit_count;
        EXPECT_EQ(layers.albedo[k], glm::vec3(0.2f, 0.4f, 0.6f));
        // A unit sphere's normal is the point itself, but for how coarse the triangles are.
        EXPECT_LT(glm::distance(glm::dvec3(layers.normal[k]), glm::normalize(point_at(view, k, hits[k]))), 0.02);
        EXPECT_EQ(layers.motion[k], glm::vec2(0.0f));
    }
    EXPECT_GT(hit_count, kWidth * kHeight / 10);
}

/// The first sample of a picture fills them with the same bits as rays of their own.
TEST(Layers, APictureFillsThem) {
    Scene scene;
    const NodeId node = add_node(scene, make_sphere(3, add_diffuse(scene, {0.2f, 0.4f, 0.6f}), true));
    const View view = looking({1, 0.5f, 4}), view_then = looking({0.8f, 0.5f, 4});
    const PastFrame past = kept(advance(scene, 0.0), view_then);
    scene[node].local.translation = {0.2f, 0.1f, 0};
    const Tlas& tlas = advance(scene, 1.0);
    const Layers alone = layers_of(scene, tlas, view, &past);
    for (const Shade shade : {Shade::kPath, Shade::kNormal, Shade::kCost}) {
        Layers layers;
        layers.past = &past;
        RenderConfig config;
        config.shade = shade;
        config.layers = &layers;
        Film film(kWidth, kHeight);
        ASSERT_TRUE(render(scene, tlas, view, config, 2, &film, nullptr));
        ASSERT_TRUE(render(scene, tlas, view, config, 1, &film, nullptr));
        EXPECT_TRUE(has_same_bits(layers.albedo, alone.albedo));
        EXPECT_TRUE(has_same_bits(layers.normal, alone.normal));
        EXPECT_TRUE(has_same_bits(layers.motion, alone.motion));
    }
}

/// A sphere that is moved, turned and scaled, seen by a camera that moves, too.
TEST(Layers, MotionIsWhereEachPointWasToTheEye) {
    Scene scene;
    const NodeId node = add_node(scene, make_sphere(3, add_diffuse(scene, glm::vec3(0.5f)), false));
    add_node(scene, make_floor(5.0f, -1.5f, add_diffuse(scene, glm::vec3(0.5f))));
    const View view = looking({0.3f, 0.8f, 5}), view_then = looking({0, 1, 5.5f});
    const Trs now{
        .translation = {0.4f, 0.1f, 0}, .rotation = glm::angleAxis(0.3f, glm::vec3(0, 1, 0)), .scale = glm::vec3(1.1f)};
    const Trs then{.translation = {0.1f, -0.2f, 0.3f}, .rotation = glm::angleAxis(0.1f, glm::vec3(0, 1, 0))};
    scene[node].local = then;
    const PastFrame past = kept(advance(scene, 0.0), view_then);
    scene[node].local = now;
    const Tlas& tlas = advance(scene, 1.0);
    const std::vector<Hit> hits = hits_of(tlas, view);
    const Layers layers = layers_of(scene, tlas, view, &past);

    int moved_count = 0, still_count = 0;
    for (size_t k = 0; k < hits.size(); ++k) {
        if (!hits[k]) continue;
        const glm::dvec3 point = point_at(view, k, hits[k]);
        glm::dvec3 before = point;
        if (hits[k].node == node) {
            // Back to the sphere, and out to where it was.
            const glm::dquat turn_now(now.rotation), turn_then(then.rotation);
            const glm::dvec3 local = glm::inverse(turn_now) * (point - glm::dvec3(now.translation)) / double(now.scale.x);
            before = turn_then * local + glm::dvec3(then.translation);
            ++moved_count;
        } else {
            ++still_count;
        }
        const glm::dvec2 expected = place(view, point) - place(view_then, before);
        // Points are floats of about 6 m, of which 1e-6 is lost; a pixel is about 5 / 32 m wide there.
        EXPECT_LT(glm::distance(glm::dvec2(layers.motion[k]), expected), 2e-4) << "pixel " << k;
    }
    EXPECT_GT(moved_count, 50);
    EXPECT_GT(still_count, 50);
}

TEST(Layers, TheSkyMovesAsTheCameraTurns) {
    Scene scene;
    add_node(scene, make_sphere(0, add_diffuse(scene, glm::vec3(0.5f)), false), {.translation = {0, 0, 500}});
    const View view = look_at({0, 0, 0}, {0, 0, -1}, 50.0f, float(kWidth) / kHeight);
    const View view_then = look_at({9, 9, 9}, {9.1f, 9, 8}, 50.0f, float(kWidth) / kHeight);  // Where it stands is all one.
    const Tlas& tlas = advance(scene, 0.0);
    const PastFrame past = kept(tlas, view_then);
    const Layers layers = layers_of(scene, tlas, view, &past);
    const size_t middle = size_t{kHeight / 2} * kWidth + kWidth / 2;
    ASSERT_FALSE(hits_of(tlas, view)[middle]);
    // It turned to the left by an angle whose tangent is 0.1; what it shows went to the right.
    EXPECT_NEAR(layers.motion[middle].x, 0.1f * 0.5f * kWidth / view.half_width, 0.05f);
    EXPECT_NEAR(layers.motion[middle].y, 0.0f, 0.01f);
}

TEST(Layers, WhatWasNotThereIsTakenToHaveStoodStill) {
    Scene scene;
    const NodeId hidden =
        add_node(scene, make_sphere(2, add_diffuse(scene, glm::vec3(0.5f)), false), {.translation = {-1, 0, 0}});
    const NodeId written =
        add_node(scene, make_sphere(2, add_diffuse(scene, glm::vec3(0.5f)), false), {.translation = {1, 0, 0}});
    const View view = looking({0, 0, 5});
    scene[hidden].local.scale = glm::vec3(0.0f);
    const PastFrame past = kept(advance(scene, 0.0), view);
    scene[hidden].local.scale = glm::vec3(1.0f);
    Mesh other = make_box(kNone<MaterialId>);
    scene.write_mesh(scene[written].mesh, other.positions, {}, other.corners);
    scene[written].local.translation.y = 1.0f;
    const Layers layers = layers_of(scene, advance(scene, 1.0), view, &past);
    for (const glm::vec2& motion : layers.motion) EXPECT_EQ(motion, glm::vec2(0.0f));
}

/// What a surface shows at another level has other triangles, wherever in memory they lie: it stood still.
TEST(Layers, ASurfaceMayHaveHadAnotherLevel) {
    Scene scene;
    Mesh box = make_box(kNone<MaterialId>);
    Cage cage;
    for (const glm::uvec3& t : box.corners) {
        cage.face_sizes.push_back(3);
        cage.vertices.insert(cage.vertices.end(), {t.x, t.y, t.z});
    }
    SubdivisionSurface surface{.cage = cage, .options = {.level = 2}, .pixels = 0.05f, .max_level = 5};
    add_node(scene, make_surface(box.positions, surface));
    const View view = looking({0, 0, 5});
    for (const float away : {4.0f, 400.0f, 3.0f, 90.0f, 5.0f, 9.0f, 1000.0f}) {
        scene.viewpoint = Viewpoint{.eye_world = {0, 0, away}, .hysteresis = 0.0f};
        const PastFrame past = kept(advance(scene, 0.0), view);
        scene.viewpoint->eye_world.z = away > 50.0f ? 3.5f : 700.0f;
        const Layers layers = layers_of(scene, advance(scene, 1.0), view, &past);
        for (const glm::vec2& motion : layers.motion) ASSERT_EQ(motion, glm::vec2(0.0f)) << "from " << away;
    }
}

TEST(Layers, OrthographicCamerasHaveMotionAndNoSky) {
    Scene scene;
    const NodeId node = add_node(scene, make_floor(1.0f, 0.0f, add_diffuse(scene, glm::vec3(0.5f))));
    View view = looking({0, 5, 0.001f});
    view.is_perspective = false;
    view.half_width = 2.0f * kWidth / kHeight;
    view.half_height = 2.0f;
    const PastFrame past = kept(advance(scene, 0.0), view);
    scene[node].local.translation = {0.25f, 0, 0};
    const Tlas& tlas = advance(scene, 1.0);
    const std::vector<Hit> hits = hits_of(tlas, view);
    const Layers layers = layers_of(scene, tlas, view, &past);
    for (size_t k = 0; k < hits.size(); ++k) {
        EXPECT_NEAR(layers.motion[k].x, hits[k] ? 0.25f * kHeight / 4.0f : 0.0f, 1e-4f);
        EXPECT_NEAR(layers.motion[k].y, 0.0f, 1e-4f);
    }
}

TEST(Layers, AreTheSameOnAnyNumberOfThreads) {
    Scene scene;
    add_node(scene, make_sphere(3, add_diffuse(scene, glm::vec3(0.5f)), true));
    const View view = looking({1, 2, 3});
    const Tlas& tlas = advance(scene, 0.0);
    const PastFrame past = kept(tlas, looking({1.1f, 2, 3}));
    set_thread_count(1);
    const Layers one = layers_of(scene, tlas, view, &past);
    set_thread_count(3);
    const Layers three = layers_of(scene, tlas, view, &past);
    set_thread_count(0);
    EXPECT_TRUE(has_same_bits(one.albedo, three.albedo));
    EXPECT_TRUE(has_same_bits(one.normal, three.normal));
    EXPECT_TRUE(has_same_bits(one.motion, three.motion));
}

}  // namespace
}  // namespace zoe::test
