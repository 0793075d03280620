#pragma once

#include "apps/common/choose_view.h"

namespace zoe {

/// The free camera: around a target, +Y up. Angles in radians.
struct Orbit {
    glm::vec3 target{0.0f};
    float yaw = 0.0f;    ///< 0: from +Z; grows towards +X.
    float pitch = 0.0f;  ///< Above the horizon.
    float distance = 1.0f;
    float fov_degrees = 45.0f;

    ViewChoice::LookAt look_at() const;

    /// Mouse movements in pixels of a picture `height` pixels high; a drag across it turns by half a circle.
    void turn(float dx, float dy, float height);
    /// Moves the target across the picture: what is at its distance stays under the mouse.
    void pan(float dx, float dy, float height);
    /// Each step is a tenth nearer or farther.
    void zoom(float steps);
};

/// The orbit that sees what a view sees. It turns around the point of the view's axis nearest the bounds' middle.
Orbit orbit_from_view(const View& view, const Aabb& bounds);

}  // namespace zoe
