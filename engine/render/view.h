#pragma once

#include <optional>
#include <span>

#include "engine/frame/build_tlas.h"
#include "engine/math/ray.h"
#include "engine/scene/scene.h"

namespace zoe {

/// A camera in the world, ready to make rays. Looks along -axis_z; +axis_y is up.
struct View {
    glm::vec3 origin{0.0f};
    glm::vec3 axis_x{1, 0, 0}, axis_y{0, 1, 0}, axis_z{0, 0, 1};  ///< Orthonormal.
    bool is_perspective = true;
    float half_width = 1.0f, half_height = 1.0f;  ///< At distance 1 (perspective) or of the view (orthographic).
};

/// eye looks at target, +Y up (any up where the two are above one another), vertical field of view in degrees.
View look_at(const glm::vec3& eye, const glm::vec3& target, float fov_degrees, float aspect);

/// The view of a camera node at the last `advance`: the camera's whole frame, and more of the scene on two sides where the
/// picture has another aspect. The node's scale does not matter.
View view_from_camera(const Scene& scene, NodeId node, float aspect);

/// Half the height of that view, as `View` has it, wherever the camera is.
float half_height(const Camera& camera, float aspect);

/// A view that holds a whole box, from the front, a little above.
View frame_whole(const Aabb& bounds, float aspect);

/// The ray through a point of the picture: (0, 0) is the top left corner, (width, height) the bottom right.
/// Direction has length 1.
Ray camera_ray(const View& view, float x, float y, int width, int height);

/// Where a view shows something, in pixels from the top left; may lie beside the picture.
/// offset     from the eye, or any length of a direction for what is infinitely far.
/// Returns    false where it shows it nowhere: behind the eye, or at no place of its own.
bool project(const View& view, const glm::vec3& offset, bool is_far, int width, int height, glm::vec2* at);

/// Distance of a point from the camera along its axis (metres): what a depth layer holds.
float depth(const View& view, const glm::vec3& point);

}  // namespace zoe
