#pragma once

#include <glm/vec3.hpp>

#include "engine/frame/trace.h"

namespace zoe {

/// What a ray finds where it hits: world space, unit normals that face the ray.
struct Surface {
    glm::vec3 position{0.0f};
    glm::vec3 error{0.0f};           ///< The true surface, and the one that rays see, are within +-error of `position`.
    glm::vec3 ng{0.0f, 0.0f, 1.0f};  ///< Geometric normal.
    glm::vec3 ns{0.0f, 0.0f, 1.0f};  ///< Shading normal, above the surface; interpolated where the mesh has normals.
    glm::vec3 base_color{1.0f};      ///< Linear, in [0, 1]: factor times texture times vertex colour.
    glm::vec3 emission{0.0f};        ///< Radiance.
    float opacity = 1.0f;            ///< Share of what lies behind that the ray does not see; 0 or 1 for alpha masks.
    float light_opacity = 1.0f;      ///< Share of the light from behind, which travels against the ray, that is stopped.
    bool is_unlit = false;           ///< Shows its base colour, whatever the light.
};

/// The surface under a hit. Metals are treated as diffuse: the base colour is the albedo.
///
/// A single-sided material is there only for what arrives at its front, from where its corners run counter-clockwise (or
/// clockwise, where the node's world matrix mirrors). A ray that sees the back sees through it, opacity 0. Light against a
/// ray that sees the front arrives at the back and passes, light_opacity 0:
///
///     ray ------>  back | front  ------> what lies behind is seen
///     ray <------ front | back   <------ light from behind arrives
///
/// Requires   hit, and that the ray is the one that hit, in the last frame that was made of the scene.
Surface surface_at(const Scene& scene, const Tlas& tlas, const Ray& ray, const Hit& hit);

/// An origin for a ray that leaves a surface in a direction: outside by more than all rounding that separates `position`
/// from the triangle as the ray will see it, so that the ray cannot hit what it leaves.
/// Source     Pharr, Jakob, Humphreys. Physically Based Rendering, 3rd ed., section 3.9. Deviation: bounds
///            also cover the way back into the instance's space and the triangle test.
glm::vec3 leave(const Surface& surface, const glm::vec3& direction);

}  // namespace zoe
