#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace zoe {

/// Half the angle of the real sun's disc, radians: it is 0.53 degrees wide.
inline constexpr float kSunRadius = 0.00465f;

/// A sun: a disc infinitely far away, as bright everywhere. None, unless told.
class Sun {
public:
    Sun() = default;
    /// toward     unit, to the disc's centre.
    /// irradiance on a surface that faces it.
    /// radius     radians, above 0.
    Sun(const glm::vec3& toward, const glm::vec3& irradiance, float radius = kSunRadius);

    bool is_dark() const { return irradiance_ == glm::vec3(0.0f); }
    const glm::vec3& toward() const { return toward_; }
    const glm::vec3& irradiance() const { return irradiance_; }
    float radius() const { return radius_; }

    /// The radiance from a unit direction: zero beside the disc.
    glm::vec3 radiance(const glm::vec3& direction) const;
    /// A unit direction into the disc, uniform over its solid angle.
    /// u          two numbers in [0, 1).
    glm::vec3 sample(const glm::vec2& u) const;
    /// The density of `sample` in the disc, per steradian.
    float density() const { return density_; }

    /// The same sun, so many times as bright.
    Sun times(float strength) const { return {toward_, strength * irradiance_, radius_}; }

private:
    glm::vec3 toward_{0, 1, 0}, across_{1, 0, 0}, also_across_{0, 0, -1};  // orthonormal
    glm::vec3 irradiance_{0.0f};
    float radius_ = kSunRadius;
    float cap_ = 0.0f;  // 1 - cosine of the radius
    float density_ = 0.0f;
};

}  // namespace zoe
