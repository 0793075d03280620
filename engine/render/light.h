#pragma once

#include <limits>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "engine/render/environment.h"
#include "engine/render/path.h"

namespace zoe {

/// The sky: a clear day's gradient above, plain ground below, in units where a sunlit white wall is about 1.
glm::vec3 default_sky(const glm::vec3& direction);

/// The sun in it; twice as wide as the real one: soft edges that a video keeps.
Sun default_sun();

/// A punctual light of the scene in the world.
struct PunctualLight {
    LightKind kind = LightKind::kPoint;
    glm::vec3 position{0.0f};
    glm::vec3 axis{0.0f, 0.0f, -1.0f};  ///< Shines along it; unit.
    glm::vec3 intensity{0.0f};          ///< Candela, or lux where directional.
    float range = 0.0f;                 ///< Metres; 0: infinite.
    float cone_scale = 0.0f, cone_offset = 1.0f;
};

/// What a light does at a point.
struct Illumination {
    glm::vec3 toward{0.0f};      ///< Unit, to the light.
    glm::vec3 irradiance{0.0f};  ///< On a surface that faces it, if nothing stands between.
};

/// Everything that lights a frame, besides its emissive surfaces.
struct Lighting {
    std::vector<PunctualLight> lights;
    Sun sun;  ///< Of the environment, or the default one.
    float sky_strength = 1.0f;
    std::optional<glm::vec3> uniform_sky;
    const Environment* environment = nullptr;

    /// The sky without its sun.
    glm::vec3 sky(const glm::vec3& direction) const;
};

/// Collects the lights of the shown nodes, at the last `advance`. Lights without a finite place and direction shine nothing.
void gather_lights(const Scene& scene, const RenderConfig& config, Lighting* lighting);

/// Light of one punctual light at a point. Zero outside range and cone, and at the light itself.
/// Source     KHR_lights_punctual, with its recommended range window and angular attenuation.
Illumination illuminate(const PunctualLight& light, const glm::vec3& point);

/// The weight of a sample whose direction has some density, where another way would have found it with another density: the
/// weights of both ways add up to 1.
/// Source     Veach, Guibas. Optimally Combining Sampling Techniques for Monte Carlo Rendering. SIGGRAPH 1995 (power of 2).
inline float weight_of(float density, float other) {
    const float ratio = other / density;
    return 1.0f / (1.0f + ratio * ratio);
}

}  // namespace zoe
