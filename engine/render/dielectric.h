#pragma once

#include <algorithm>

#include <glm/common.hpp>
#include <glm/vec3.hpp>

#include "engine/render/albedo.h"
#include "engine/render/direction.h"
#include "engine/render/surface.h"

namespace zoe {

/// Light that rough facets send on to others: the share that comes out in the end, of what a perfect mirror's facets send
/// on, where they reflect f0 + (f90 - f0) (1 - cosine)^5. mean       of facets as rough as these.
inline glm::vec3 between_facets(const glm::vec3& f0, float f90, const Albedo& mean) {
    const glm::vec3 average = f0 + (f90 - f0) * (1.0f / 21.0f);
    return average * average * mean.all / (1.0f - average * (1.0f - mean.all));
}

/// What the dielectric part of a surface reflects; by itself, nothing.
struct Dielectric {
    glm::vec3 f0{0.0f};
    float f90 = 0.0f;
    glm::vec3 between{0.0f};  ///< See between_facets.

    Dielectric() = default;
    Dielectric(const Surface& surface, const Albedo& mean)
        : f0(glm::min(glm::vec3(1.0f), surface.f0 * surface.specular_color) * surface.specular),
          f90(surface.specular),
          between(between_facets(f0, f90, mean)) {}

    /// Share of light that goes under the surface, by the strongest colour of its reflection: what is under it keeps its
    /// hue.
    float goes_under(const Albedo& at) const {
        const glm::vec3 reflected = f0 * (at.all - at.edge) + f90 * at.edge + between * (1.0f - at.all);
        return std::clamp(1.0f - largest(reflected), 0.0f, 1.0f);
    }
};

}  // namespace zoe
