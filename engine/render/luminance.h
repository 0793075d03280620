#pragma once

#include <glm/vec3.hpp>

namespace zoe {

/// How bright the eye finds linear light of the sRGB primaries (Rec. 709).
inline constexpr glm::vec3 kLuminance{0.2126f, 0.7152f, 0.0722f};

inline float luminance(const glm::vec3& color) {
    return kLuminance.r * color.r + kLuminance.g * color.g + kLuminance.b * color.b;
}

}  // namespace zoe
