#include "engine/render/view.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "engine/frame/frame.h"
#include "engine/render/direction.h"

namespace zoe {

namespace {

constexpr float kFrameFovDegrees = 40.0f;  // of frame_whole
constexpr float kFrameMargin = 1.08f;      // room around the box

/// Sets the axes from the one that points back at the viewer and a rough up.
void set_axes(const glm::vec3& back, const glm::vec3& up, View* view) {
    view->axis_z = back;
    glm::vec3 across = glm::cross(up, back);
    if (glm::dot(across, across) < 1e-12f) {
        // Up and back are parallel. As a camera that first looked along -Z and was then tilted straight down or up.
        const glm::vec3 tilted(0.0f, 0.0f, back.y > 0.0f ? -1.0f : 1.0f);
        across = glm::cross(std::abs(back.z) < 0.9f ? tilted : glm::vec3(0, 1, 0), back);
    }
    view->axis_x = glm::normalize(across);
    view->axis_y = glm::cross(view->axis_z, view->axis_x);
}

// back       from the target to the eye, of any length.
View look_along(const glm::vec3& eye, const glm::vec3& back, float fov_degrees, float aspect) {
    assert(fov_degrees > 0.0f && fov_degrees < 180.0f && aspect > 0.0f);
    View view;
    view.origin = eye;
    set_axes(unit_or(back, glm::vec3(0, 0, 1)), glm::vec3(0, 1, 0), &view);
    view.half_height = std::tan(0.5f * glm::radians(fov_degrees));
    view.half_width = view.half_height * aspect;
    return view;
}

}  // namespace

View look_at(const glm::vec3& eye, const glm::vec3& target, float fov_degrees, float aspect) {
    return look_along(eye, eye - target, fov_degrees, aspect);
}

View view_from_camera(const Scene& scene, NodeId node, float aspect) {
    assert(aspect > 0.0f);
    const Camera& camera = scene.cameras.at(index(scene[node].camera));
    const Affine& world_from_camera = world_from_node(scene, node);
    View view;
    view.origin = world_from_camera.translation;
    view.is_perspective = camera.is_perspective;
    // Only the directions of the node's axes count, not their lengths; a negative scale along z turns the camera round.
    const glm::vec3 back = unit_or(world_from_camera.linear[2], glm::vec3(0, 0, 1));
    set_axes(back, unit_or(world_from_camera.linear[1], glm::vec3(0, 1, 0)), &view);

    view.half_height = half_height(camera, aspect);
    view.half_width = view.half_height * aspect;
    return view;
}

float half_height(const Camera& camera, float aspect) {
    // The camera's own frame, widened on one side to the picture's shape: nothing of the frame is cut off.
    const float own_height = camera.is_perspective ? std::tan(0.5f * camera.yfov) : std::abs(camera.ymag);
    const float own_aspect = camera.aspect > 0.0f ? camera.aspect : aspect;
    const float own_width = camera.is_perspective ? own_height * own_aspect : std::abs(camera.xmag);
    return own_width < own_height * aspect ? own_height : own_width / aspect;
}

View frame_whole(const Aabb& bounds, float aspect) {
    const glm::vec3 toward_viewer = glm::normalize(glm::vec3(0.25f, 0.3f, 1.0f));
    const bool is_usable = bounds.is_proper();
    const glm::vec3 centre = is_usable ? bounds.centre() : glm::vec3(0.0f);
    // By the direction, not from eye to centre: far from the origin, those are rounded.
    View view = look_along(centre + toward_viewer, toward_viewer, kFrameFovDegrees, aspect);
    if (!is_usable) return view;

    // A corner at (x, y, z) from the centre, along the axes, is seen by an eye at (ex, ey, ez) where
    //     +-(x - ex) <= (ez - z) * w, and so for y with h:
    // the largest z * w + x and z * w - x over the corners give the nearest eye, and the place across that centres them.
    const float w = view.half_width / kFrameMargin, h = view.half_height / kFrameMargin;
    float right = 0.0f, left = 0.0f, up = 0.0f, down = 0.0f;
    for (int corner = 0; corner < 8; ++corner) {
        const glm::vec3 half = 0.5f * bounds.extent();
        const glm::vec3 offset(corner & 1 ? half.x : -half.x, corner & 2 ? half.y : -half.y, corner & 4 ? half.z : -half.z);
        const float x = glm::dot(offset, view.axis_x), y = glm::dot(offset, view.axis_y), z = glm::dot(offset, view.axis_z);
        right = std::max(right, z * w + x);
        left = std::max(left, z * w - x);
        up = std::max(up, z * h + y);
        down = std::max(down, z * h - y);
    }
    const float distance = std::max((right + left) / (2.0f * w), (up + down) / (2.0f * h));
    if (!(distance > 0.0f) || !std::isfinite(distance)) return view;
    view.origin = centre + 0.5f * (right - left) * view.axis_x + 0.5f * (up - down) * view.axis_y + distance * view.axis_z;
    return view;
}

Ray camera_ray(const View& view, float x, float y, int width, int height) {
    const float right = (2.0f * x / static_cast<float>(width) - 1.0f) * view.half_width;
    const float up = (1.0f - 2.0f * y / static_cast<float>(height)) * view.half_height;
    const glm::vec3 across = right * view.axis_x + up * view.axis_y;
    if (!view.is_perspective) return {.origin = view.origin + across, .direction = -view.axis_z};
    return {.origin = view.origin, .direction = glm::normalize(across - view.axis_z)};
}

bool project(const View& view, const glm::vec3& offset, bool is_far, int width, int height, glm::vec2* at) {
    const float ahead = -glm::dot(offset, view.axis_z);
    if (!(ahead > 0.0f) || (is_far && !view.is_perspective)) return false;
    const float scale = view.is_perspective ? 1.0f / ahead : 1.0f;
    const glm::vec2 across(glm::dot(offset, view.axis_x) * scale / view.half_width,
                           glm::dot(offset, view.axis_y) * scale / view.half_height);
    *at = {0.5f * (1.0f + across.x) * static_cast<float>(width), 0.5f * (1.0f - across.y) * static_cast<float>(height)};
    return true;
}

float depth(const View& view, const glm::vec3& point) {
    return glm::dot(view.origin - point, view.axis_z);
}

}  // namespace zoe
