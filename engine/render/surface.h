#pragma once

#include <cstdint>
#include <optional>

#include <glm/vec3.hpp>

#include "engine/frame/trace.h"

namespace zoe {

/// What a ray finds where it hits: world space, unit normals that face the ray.
struct Surface {
    glm::vec3 position{0.0f};
    glm::vec3 error{0.0f};               ///< The true surface, and the one that rays see, are within +-error of `position`.
    glm::vec3 ng{0.0f, 0.0f, 1.0f};      ///< Geometric normal.
    glm::vec3 smooth{0.0f, 0.0f, 1.0f};  ///< Interpolated normal, above the surface.
    glm::vec3 ns{0.0f, 0.0f, 1.0f};      ///< Shading normal, above the surface: `smooth`, bent by the normal texture.
    glm::vec3 base_color{1.0f};          ///< Linear, in [0, 1]: factor times texture times vertex colour.
    glm::vec3 emission{0.0f};            ///< Radiance.
    float opacity = 1.0f;                ///< Share of what lies behind that the ray does not see; 0 or 1 for alpha masks.
    float light_opacity = 1.0f;          ///< Share of the light from behind, which travels against the ray, that is stopped.
    MaterialId material = kNone<MaterialId>;
    bool is_unlit = false;   ///< Shows its base colour, whatever the light.
    bool is_inside = false;  ///< The ray met the back.

    float metallic = 0.0f, roughness = 1.0f;  ///< In [0, 1].
    float ior = 1.5f, f0 = 0.04f;             ///< Of the dielectric, and what it reflects straight on for that.
    float specular = 0.0f;                    ///< Strength of that reflection, in [0, 1] ...
    glm::vec3 specular_color{1.0f};           ///< ... and its colour.
    float transmission = 0.0f;                ///< Share of what is not reflected that passes, in [0, 1].
    bool has_volume = false;                  ///< Else a thin sheet.
    glm::vec3 absorption{0.0f};               ///< In the volume, per metre.
    float coat = 0.0f, coat_roughness = 0.0f;
    glm::vec3 coat_ns{0.0f, 0.0f, 1.0f};  ///< Shading normal of the coat.
    glm::vec3 sheen_color{0.0f};
    float sheen_roughness = 0.0f;

    /// Light passes into a volume.
    bool is_body() const { return has_volume && transmission > 0.0f; }
    /// A thin sheet that scatters what passes; smoother ones let it pass straight, and so bring sharp light to what is
    /// behind.
    bool is_frosted() const { return !has_volume && transmission > 0.0f && roughness > 0.1f; }
};

/// How wide a ray is: what it stands for among the rays of its pixel.
/// Source     Akenine-Moeller, Crassin, Boksansky, Belcour, Panteleev, Wright. Improved Shader and Texture Level of Detail
///            Using Ray Cones. JCGT 2021. Deviation: curvature does not widen it; a slanted
///            surface's ellipse counts as the circle of its area, since a pixel's samples spread along it.
struct RayCone {
    float width = 0.0f;   ///< Where the ray starts, metres.
    float spread = 0.0f;  ///< What it gains a metre.
};

/// How much of a surface is worked out.
enum class Detail : uint8_t {
    kAll,
    kLight,  ///< What it emits and what it lets pass straight; how it scatters, and its shading normals, only for that.
};

/// The surface under a hit. Of glTF's default material where it has none.
///
/// A single-sided material is there only for what arrives at its front, from where its corners run counter-clockwise (or
/// clockwise, where the node's world matrix mirrors). A ray that sees the back sees through it, opacity 0. Light against a
/// ray that sees the front arrives at the back and passes, light_opacity 0:
///
///     ray ------>  back | front  ------> what lies behind is seen
///     ray <------ front | back   <------ light from behind arrives
///
/// A material with a volume has two sides whatever it says: its inside has to be seen. So has a frosted sheet, which
/// scatters light on its way in and on its way out.
/// cone       how finely textures are looked up; the holes of alpha masks are always sharp.
/// Requires   hit, and that the ray is the one that hit, in the last frame that was made of the scene.
Surface surface_at(const Scene& scene, const Tlas& tlas, const Ray& ray, const Hit& hit, const RayCone& cone = {},
                   Detail detail = Detail::kAll);

/// An origin for a ray that leaves a surface in a direction: outside by more than all rounding that separates `position`
/// from the triangle as the ray will see it, so that the ray cannot hit what it leaves.
/// Source     Pharr, Jakob, Humphreys. Physically Based Rendering, 3rd ed., section 3.9. Deviation: bounds
///            also cover the way back into the instance's space and the triangle test.
glm::vec3 leave(const Surface& surface, const glm::vec3& direction);

/// Tells whether a triangle faces away from a light that its interpolated normal faces.
bool is_turned_away(const Surface& surface, const glm::vec3& to_light);

/// An origin for a ray towards a light whose shadows have sharp edges; none where the surface itself is in the way. Where a
/// triangle is turned away from the light, but its interpolated normal is not, the origin is on the curved surface that its
/// corners' normals stand for: so the edge of the light runs over a coarse mesh as over a fine one.
/// Source     Hanika. Hacking the Shadow Terminator. Ray Tracing Gems II, 2021. Deviation: rays of triangles that face the
///            light start on them, so that what lies closely above still shades them; so does what stands between a
///            triangle and its curve; normals that all lean one way, or more than 41 degrees away from the triangle's, stand
///            for no curve: those of leaves and of boxes.
/// Requires   that the surface is that of the hit.
/// Cost       a short ray where the triangle is turned away.
std::optional<glm::vec3> leave_smoothly(const Tlas& tlas, const Hit& hit, const Surface& surface, const glm::vec3& to_light);

}  // namespace zoe
