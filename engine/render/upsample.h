#pragma once

#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "engine/render/film.h"
#include "engine/render/guides.h"

namespace zoe {

/// Lights a picture by a smaller one of the same view. Light changes slowly where surfaces go on; edges and textures do not,
/// and what they are costs one ray a pixel:
///
///     light = (small radiance - what has no noise) / small albedo
///     radiance = what has no noise + albedo * mean of the light beside it, of the same node, depth and normal
///
/// The mean is bilinear where all four neighbours are quite alike. Where none is, 4 x 4 are looked at; then the surface that
/// is most alike among those gives its light; and where there is none at all, the picture's mean does. What mirrors show,
/// and what is seen through glass, counts as light: it stays as coarse.
///
/// Source     Kopf, Cohen, Lischinski, Uyttendaele. Joint Bilateral Upsampling. SIGGRAPH 2007. Deviation: three guides
///            instead of a picture; polynomials that end instead of Gaussians; light without the surfaces' colour.
class Upsampler {
public:
    /// from_guides  of the small picture.
    /// from         its radiance, of any number of samples.
    /// guides       of the large picture: all that it needs, even where it is not lit.
    /// film         it. Its radiance is replaced, and nothing else of it; black where that would not be finite.
    /// Cost         a pass over the small picture and one over the large, in parallel; no allocation once sizes have
    /// settled.
    void light(const Guides& from_guides, const Film& from, const Guides& guides, Film* film);

private:
    /// What a pixel of the small picture knows of light: nothing where its node is none.
    struct Sample {
        glm::vec3 light;
        glm::vec3 normal;
        float depth;
        uint32_t node;
    };
    struct Place;
    void take_in(const Guides& guides, const Film& film);
    template <typename Use>
    void for_beside(const Place& place, int reach, const Use& use) const;
    glm::vec3 light_at(const Place& place) const;

    int width_ = 0, height_ = 0;
    std::vector<Sample> samples_;       // [height * width]
    std::vector<glm::dvec4> row_sums_;  // [height] light, and how many pixels know of it
    glm::vec3 mean_{0.0f};
};

}  // namespace zoe
