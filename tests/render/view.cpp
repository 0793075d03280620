#include "engine/render/view.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/render/scenes.h"

namespace zoe::test {
namespace {

void expect_near(const glm::vec3& a, const glm::vec3& b, float bound = 1e-5f) {
    EXPECT_LT(glm::distance(a, b), bound) << a.x << ' ' << a.y << ' ' << a.z << " against " << b.x << ' ' << b.y << ' '
                                          << b.z;
}

TEST(View, TheCentreRayLooksAtTheTargetAndCornersAreWhereTheySay) {
    const View view = look_at({0, 0, 5}, {0, 0, 0}, 90.0f, 2.0f);
    expect_near(camera_ray(view, 100, 50, 200, 100).direction, {0, 0, -1});
    expect_near(camera_ray(view, 0, 0, 200, 100).direction, glm::normalize(glm::vec3(-2, 1, -1)));
    expect_near(camera_ray(view, 200, 100, 200, 100).direction, glm::normalize(glm::vec3(2, -1, -1)));
    expect_near(camera_ray(view, 0, 0, 200, 100).origin, {0, 0, 5}, 1e-9f);
}

TEST(View, DepthCountsAlongTheAxisNotAlongTheRay) {
    const View view = look_at({1, 2, 3}, {1, 2, -7}, 60.0f, 1.0f);
    EXPECT_FLOAT_EQ(depth(view, {4, -2, 1}), 2.0f);
}

TEST(View, LookingStraightUpOrDownHasAnUpToo) {
    for (float y : {-1.0f, 1.0f}) {
        const View view = look_at({0, 0, 0}, {0, y, 0}, 60.0f, 1.0f);
        expect_near(view.axis_z, {0, -y, 0});
        EXPECT_NEAR(glm::length(view.axis_x), 1.0f, 1e-5f);
        expect_near(glm::cross(view.axis_x, view.axis_y), view.axis_z);
        expect_near(view.axis_x, {1, 0, 0});  // as a camera that was tilted from looking along -Z
    }
}

TEST(View, AWholeBoxIsInsideThePicture) {
    const Aabb boxes[] = {
        {{-1, -1, -1}, {1, 1, 1}}, {{0, 0, 0}, {100, 1, 3}}, {{5, 5, 5}, {5, 9, 5}}, {{1e4f, 0, 0}, {1.1e4f, 9, 2}}};
    for (const Aabb& box : boxes) {
        for (float aspect : {0.5f, 1.0f, 2.0f}) {
            const View view = frame_whole(box, aspect);
            for (int i = 0; i < 8; ++i) {
                const glm::vec3 corner(i & 1 ? box.hi.x : box.lo.x, i & 2 ? box.hi.y : box.lo.y,
                                       i & 4 ? box.hi.z : box.lo.z);
                const glm::vec3 offset = corner - view.origin;
                const float ahead = depth(view, corner);
                EXPECT_GT(ahead, 0.0f);
                EXPECT_LE(std::abs(glm::dot(offset, view.axis_x)), ahead * view.half_width);
                EXPECT_LE(std::abs(glm::dot(offset, view.axis_y)), ahead * view.half_height);
            }
        }
    }
}

TEST(View, AWholeBoxIsSeenFromTheSameSideWhereverItIs) {
    const Aabb near{{-1, -2, -3}, {1, 2, 3}};
    const View expected = frame_whole(near, 1.5f);
    for (const float away : {1.0f, 1e3f, 1e7f, 1e12f, -3e7f}) {
        for (int axis = 0; axis < 3; ++axis) {
            glm::vec3 centre(0.0f);
            centre[axis] = away;
            const View view = frame_whole({near.lo + centre, near.hi + centre}, 1.5f);
            EXPECT_EQ(view.axis_x, expected.axis_x) << away << " along " << axis;
            EXPECT_EQ(view.axis_y, expected.axis_y) << away << " along " << axis;
            EXPECT_EQ(view.axis_z, expected.axis_z) << away << " along " << axis;
            // The place is as exact as floats are there.
            EXPECT_LE(glm::distance(view.origin - centre, expected.origin), 4e-7f * std::abs(away) + 1e-5f)
                << away << " along " << axis;
        }
    }
}

TEST(View, NothingToFrameStillGivesAView) {
    for (const Aabb& box : {Aabb{}, Aabb{{2, 2, 2}, {2, 2, 2}}}) {
        const Ray ray = camera_ray(frame_whole(box, 1.5f), 0.5f, 0.5f, 1, 1);
        EXPECT_NEAR(glm::length(ray.direction), 1.0f, 1e-5f);
        EXPECT_TRUE(std::isfinite(ray.origin.x + ray.origin.y + ray.origin.z));
    }
}

/// A scene with one camera node.
Scene with_camera(const Camera& camera, const Trs& local) {
    Scene scene;
    scene.cameras.push_back(camera);
    Node node;
    node.camera = CameraId{0};
    node.local = local;
    scene.add(std::move(node));
    advance(scene, 0.0);
    return scene;
}

TEST(View, ACameraNodeLooksAlongItsMinusZWhateverItsScale) {
    const glm::quat quarter_turn = glm::angleAxis(glm::radians(90.0f), glm::vec3(0, 1, 0));
    for (const glm::vec3& scale : {glm::vec3(1), glm::vec3(3, 5, 0.1f), glm::vec3(-1, 1, 1)}) {
        const Scene scene = with_camera({.yfov = glm::radians(90.0f)}, {{1, 2, 3}, quarter_turn, scale});
        const View view = view_from_camera(scene, NodeId{0}, 2.0f);
        const Ray centre = camera_ray(view, 1, 1, 2, 2);
        expect_near(centre.origin, {1, 2, 3});
        expect_near(centre.direction, {-1, 0, 0});
        expect_near(camera_ray(view, 0, 0, 2, 2).direction, glm::normalize(glm::vec3(-1, 1, 2)));
    }
}

TEST(View, ACamerasWholeFrameIsInAPictureOfAnyShape) {
    const Scene scene = with_camera({.yfov = glm::radians(90.0f), .aspect = 1.5f}, {});
    const View wide = view_from_camera(scene, NodeId{0}, 3.0f);
    EXPECT_NEAR(wide.half_height, 1.0f, 1e-5f);
    EXPECT_NEAR(wide.half_width, 3.0f, 1e-5f);
    const View tall = view_from_camera(scene, NodeId{0}, 0.5f);
    EXPECT_NEAR(tall.half_width, 1.5f, 1e-5f);
    EXPECT_NEAR(tall.half_height, 3.0f, 1e-5f);
}

TEST(View, AnOrthographicCamerasRaysAreParallel) {
    const Scene scene = with_camera({.is_perspective = false, .xmag = 4.0f, .ymag = 2.0f}, {{0, 0, 9}});
    const View view = view_from_camera(scene, NodeId{0}, 2.0f);
    const Ray corner = camera_ray(view, 0, 0, 64, 32);
    expect_near(corner.origin, {-4, 2, 9});
    expect_near(corner.direction, {0, 0, -1});
    expect_near(camera_ray(view, 64, 32, 64, 32).origin, {4, -2, 9});
}

}  // namespace
}  // namespace zoe::test
