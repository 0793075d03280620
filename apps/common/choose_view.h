#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "apps/common/open_scene.h"
#include "apps/common/parse.h"
#include "engine/render/view.h"

namespace zoe {

/// Where a picture is seen from, whatever its shape and the frame.
struct ViewChoice {
    struct LookAt {
        glm::vec3 eye{0.0f}, target{0.0f};
        float fov_degrees = 45.0f;
        friend bool operator==(const LookAt&, const LookAt&) = default;
    };
    std::optional<NodeId> camera;   ///< A camera of the scene, else:
    std::optional<LookAt> look_at;  ///< a place, else:
    Aabb bounds;                    ///< the box to show whole.

    /// Requires   an `advance` of the scene before, where a camera is chosen.
    View view(const Scene& scene, float aspect) const;
};

/// Whether a mesh of the scene is a surface that is as fine as its pixels show.
bool has_pixel_surfaces(const Scene& scene);

/// Makes such surfaces as fine as a picture of this view shows, in every frame from now on. For an orthographic camera they
/// keep their `level`, with a warning.
/// hysteresis   of the levels; 0 where pictures must not depend on those before.
void set_viewpoint(const ViewChoice& choice, PictureSize size, float hysteresis, Scene* scene);

/// The shown nodes that carry a camera, in the order of the nodes.
std::vector<NodeId> camera_nodes(const Scene& scene);

/// What a camera node is called: its own name, else its camera's.
std::string camera_name(const Scene& scene, NodeId node);

/// Finds a camera node by its name or its position among the camera nodes.
/// Throws     UsageError that lists the cameras.
NodeId find_camera(const Scene& scene, const std::string& choice);

/// A box that holds the scene at all of several times, by which it is framed when nothing else was chosen.
/// Moves the scene as `bounds_at` does. An empty scene gives a box of two metres around the origin.
Aabb bounds_over(Content& content, std::span<const double> times);

/// Nine times that cover what plays, or `otherwise_s` seconds where nothing repeats.
std::vector<double> times_over_clip(const Scene& scene, double otherwise_s);

}  // namespace zoe
