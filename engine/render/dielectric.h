#pragma once

#include <algorithm>

#include <glm/vec3.hpp>

#include "engine/render/albedo.h"
#include "engine/render/direction.h"
#include "engine/render/surface.h"

namespace zoe {

/// What the dielectric part of a surface reflects: f0 + (f90 - f0) (1 - cosine)^5, from rough facets.
struct Dielectric {
    glm::vec3 f0{0.04f};
    float f90 = 1.0f;

    explicit Dielectric(const Surface& surface)
        : f0(glm::min(glm::vec3(1.0f), surface.f0 * surface.specular_color) * surface.specular), f90(surface.specular) {}

    /// Light that facets send on to others: the share that comes out in the end, of what a perfect mirror's facets send on.
    /// mean       of facets as rough as these.
    glm::vec3 between(const Albedo& mean) const { return between_facets(f0, f90, mean); }

    /// Share of light that goes under the surface, by the strongest colour of its reflection: what is under it keeps its
    /// hue.
    float goes_under(const Albedo& at, const Albedo& mean) const {
        const glm::vec3 reflected = f0 * (at.all - at.edge) + f90 * at.edge + between(mean) * (1.0f - at.all);
        return std::clamp(1.0f - largest(reflected), 0.0f, 1.0f);
    }

    static glm::vec3 between_facets(const glm::vec3& f0, float f90, const Albedo& mean) {
        const glm::vec3 average = f0 + (f90 - f0) * (1.0f / 21.0f);
        return average * average * mean.all / (1.0f - average * (1.0f - mean.all));
    }
};

}  // namespace zoe
