#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "engine/render/dielectric.h"
#include "engine/render/direction.h"
#include "engine/render/surface.h"

namespace zoe {

/// How a surface scatters light towards the viewer: glTF's metallic-roughness model and its layers, through two normals.
///
/// Light comes from the half space above the geometric normal; cosines are those of the shading normal. The part of the
/// shading normal's hemisphere that lies under the surface is folded up, mirrored at the surface's plane, so that no light
/// leaks through and none is lost: densities integrate to 1. (Sharp light is not folded: `evaluate_sharp`.)
///
///        ng  ns
///         | /  .            directions around ns ...
///     ____|/__'____
///          \..'             ... that end up here are mirrored at the line.
///
/// From the top: a coat over sheen over the base, which is part metal and part dielectric. The dielectric reflects, and what
/// it does not is diffuse or passes: into bodies with a volume, or through frosted sheets. All but coats and sheen keep what
/// several facets reflect.
/// Source     The glTF 2.0 specification, appendix B, and KHR_materials_specular, _ior, _transmission, _volume, _clearcoat,
///            _sheen. Kulla, Conty. Revisiting Physically Based Shading at Imageworks. 2017, for light between facets, and
///            so that white stays white under a reflecting surface. Deviation: a layer takes from the ones under it by the
///            larger of the shares that it reflects towards both directions, which is reciprocal and makes no light; what
///            passes into a volume is spread as GGX facets refract it, without loss between them.
class Bsdf {
public:
    /// to_viewer  unit, above surface.ng.
    Bsdf(const Surface& surface, const glm::vec3& to_viewer);

    struct Value {
        glm::vec3 value{0.0f};  ///< Times the cosine.
        float density = 0.0f;   ///< Of `sample`, per steradian.
    };
    /// For light from a unit direction. Zero under the surface, but for frosted sheets.
    Value evaluate(const glm::vec3& to_light) const;
    /// The value for light from a point, or from a small disc, that a ray from `leave_smoothly` finds: what is above is so
    /// by the interpolated normal, and nothing is folded, which would show where facets turn away from the light.
    glm::vec3 evaluate_sharp(const glm::vec3& to_light) const;

    struct Sample {
        glm::vec3 direction{0.0f};  ///< Unit.
        glm::vec3 weight{0.0f};     ///< Times what comes from there; its mean is what the surface shows.
        float density = 0.0f;  ///< 0: through the surface, or between facets of its inside; `evaluate` knows no such light.
        float spread = 0.0f;   ///< About how wide an angle the direction stands for: radians, at most 1.
    };
    /// A direction to look for light in; none where the choice is lost between facets.
    /// u, pick    uniform in [0, 1).
    std::optional<Sample> sample(const glm::vec2& u, float pick) const;

    /// Nothing is reflected, whatever arrives.
    bool is_black() const { return !(total_weight_ > 0.0f); }

private:
    /// A frame with z along a normal that faces the viewer, and the viewer in it.
    struct Frame {
        glm::vec3 x, y, z, viewer;
        Frame(const glm::vec3& normal, const glm::vec3& to_viewer);
        glm::vec3 to_local(const glm::vec3& v) const { return {glm::dot(v, x), glm::dot(v, y), glm::dot(v, z)}; }
        glm::vec3 to_world(const glm::vec3& v) const { return v.x * x + v.y * y + v.z * z; }
    };
    enum Lobe { kDiffuse, kFacets, kCoat, kThrough, kLobeCount };

    Value evaluate_unfolded(const glm::vec3& to_light, float left = 1.0f, float coat_left = 1.0f) const;
    Value frosted_unfolded(const glm::vec3& to_light) const;
    Sample refract(const glm::vec2& u) const;
    std::optional<Sample> cross_from_inside(const glm::vec2& u, float pick) const;
    float under_layers(float reflected, float also_reflected) const;

    const Surface& surface_;
    Frame frame_, coat_frame_;
    float alpha_, coat_alpha_;
    float total_weight_ = 0.0f;
    float share_[kLobeCount] = {};  // of samples
    bool has_facets_ = false;       // else the surface is diffuse only
    GgxAlbedo albedo_, coat_table_;
    Dielectric dielectric_;
    float hidden_ = 0.0f;  // of its facets, from the viewer; see ggx_hidden
    glm::vec3 f0_{0.0f};   // of metal and dielectric together
    float f90_ = 0.0f;
    glm::vec3 between_{0.0f};                  // what facets send from one to the other, of what a perfect mirror's would
    float lost_ = 0.0f, mean_lost_ = 1.0f;     // of a perfect mirror's facets towards the viewer; from everywhere
    float under_ = 1.0f, mean_under_ = 1.0f;   // what goes under a dielectric's surface: from the viewer; from everywhere
    float sheen_ = 0.0f, coat_ = 0.0f;         // reflected towards the viewer
    glm::vec3 diffuse_{0.0f}, through_{0.0f};  // colours under the surface
};

/// A unit direction around a unit normal, with the density cosine / pi.
/// u          two numbers in [0, 1).
inline glm::vec3 sample_cosine(const glm::vec3& normal, const glm::vec2& u) {
    glm::vec3 tangent, bitangent;
    make_frame(normal, &tangent, &bitangent);
    const float radius = std::sqrt(u.x);
    const float angle = glm::two_pi<float>() * u.y;
    return glm::normalize(radius * std::cos(angle) * tangent + radius * std::sin(angle) * bitangent +
                          std::sqrt(1.0f - u.x) * normal);
}

/// What is left of light from a point, or from a small disc, where a normal texture faces it and the surface nearly does
/// not: its bumps fade towards the edge of the surface's own shadow. 1 where both normals agree.
/// smooth, bent  the interpolated normal, and that of the bumps.
/// to_light   on the same side of `smooth` as what is seen, or from behind a frosted sheet: that of its other side, of which
///            both normals face the other way.
/// Source     Chiang, Li, Burley. Taming the Shadow Terminator. SIGGRAPH Talks 2019. Deviation: the interpolated normal
///            stands for the surface, whose triangles show no edges of their own (`leave_smoothly`); light from all around,
///            which draws no such edge, stays whole.
inline float past_terminator(const glm::vec3& smooth, const glm::vec3& bent, const glm::vec3& to_light) {
    const float side = glm::dot(smooth, to_light) < 0.0f ? -1.0f : 1.0f;
    const float share = side * glm::dot(smooth, to_light);
    const float most = side * glm::dot(bent, to_light) * glm::dot(smooth, bent);
    if (bent == smooth || !(most > share)) return 1.0f;
    const float g = share / most;
    return g * (1.0f + g - g * g);
}

/// The share of light from straight behind that a thin sheet lets pass, by colour: KHR_materials_transmission without a
/// volume. None where it is frosted.
glm::vec3 passes_straight(const Surface& surface, const glm::vec3& to_viewer);

/// The share of all that lies straight behind that reaches the viewer, through holes, half holes and thin sheets.
/// opacity    surface.opacity, or surface.light_opacity for light.
inline glm::vec3 passing_share(const Surface& surface, float opacity, const glm::vec3& to_viewer) {
    return (1.0f - opacity) + opacity * passes_straight(surface, to_viewer);
}

}  // namespace zoe
