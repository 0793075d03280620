#pragma once

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "engine/render/direction.h"

namespace zoe {

/// A diffuse surface seen through two normals. Light comes from the half space above the geometric normal, and the cosine
/// is that of the shading normal. The part of the shading normal's hemisphere that lies under the surface is folded up,
/// mirrored at the surface's plane, so that no light leaks through and none is lost: the density integrates to 1.
///
///        ng  ns
///         | /  .            directions around ns ...
///     ____|/__'____
///          \..'             ... that end up here are mirrored at the line.

/// Density (per steradian) of diffuse light towards or from a unit direction: multiply by the albedo and by what arrives.
/// Returns    cos / pi and the folded part; 0 under the surface.
inline float diffuse(const glm::vec3& ns, const glm::vec3& ng, const glm::vec3& direction) {
    if (!(glm::dot(ng, direction) > 0.0f)) return 0.0f;
    const float above = std::max(0.0f, glm::dot(ns, direction));
    const float folded = std::max(0.0f, glm::dot(ns, mirror(direction, ng)));
    return (above + folded) * glm::one_over_pi<float>();
}

/// A unit direction with the density `diffuse`.
/// u          two numbers in [0, 1).
inline glm::vec3 sample_diffuse(const glm::vec3& ns, const glm::vec3& ng, const glm::vec2& u) {
    glm::vec3 tangent, bitangent;
    make_frame(ns, &tangent, &bitangent);
    const float radius = std::sqrt(u.x);
    const float angle = glm::two_pi<float>() * u.y;
    const glm::vec3 direction = glm::normalize(radius * std::cos(angle) * tangent + radius * std::sin(angle) * bitangent +
                                               std::sqrt(1.0f - u.x) * ns);
    return glm::dot(ng, direction) < 0.0f ? mirror(direction, ng) : direction;
}

}  // namespace zoe
