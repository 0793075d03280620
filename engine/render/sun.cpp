#include "engine/render/sun.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>

#include "engine/render/direction.h"

namespace zoe {

Sun::Sun(const glm::vec3& toward, const glm::vec3& irradiance, float radius)
    : toward_(toward), irradiance_(irradiance), radius_(radius) {
    const float s = std::sin(0.5f * radius);
    cap_ = 2.0f * s * s;  // 1 - cos without the cancellation
    density_ = 1.0f / (glm::two_pi<float>() * cap_);
    make_frame(toward, &across_, &also_across_);
}

glm::vec3 Sun::radiance(const glm::vec3& direction) const {
    const glm::vec3 apart = direction - toward_;
    // |a - b|^2 = 2 (1 - cos) for unit vectors: exact for small angles, where the cosine is not.
    return glm::dot(apart, apart) <= 2.0f * cap_ ? irradiance_ * density_ : glm::vec3(0.0f);
}

glm::vec3 Sun::sample(const glm::vec2& u) const {
    const float height = u.x * cap_;  // 1 - cos
    const float radius = std::sqrt(std::max(0.0f, height * (2.0f - height)));
    const float angle = glm::two_pi<float>() * u.y;
    return glm::normalize(radius * std::cos(angle) * across_ + radius * std::sin(angle) * also_across_ +
                          (1.0f - height) * toward_);
}

}  // namespace zoe
