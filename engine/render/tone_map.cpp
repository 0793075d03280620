#include "engine/render/tone_map.h"

#include <algorithm>

#include <glm/common.hpp>

namespace zoe {

namespace {

constexpr float kMost = 1e6f;  // Brighter is white by every curve; and no infinity meets another.

// What a dielectric reflects straight on, 0.04, is taken off, less of it where it is dark: so base colours come out as they
// were given under a light that is as white. What is left is kept below the shoulder and compressed above.
glm::vec3 neutral(glm::vec3 color) {
    constexpr float kReflected = 0.04f, kShoulder = 0.8f - kReflected, kDesaturation = 0.15f;
    const float least = std::min({color.x, color.y, color.z});
    color -= least < 2.0f * kReflected ? least - least * least / (4.0f * kReflected) : kReflected;
    const float peak = std::max({color.x, color.y, color.z});
    if (peak < kShoulder) return color;
    constexpr float kRoom = 1.0f - kShoulder;
    const float mapped = 1.0f - kRoom * kRoom / (peak + kRoom - kShoulder);
    const float kept = 1.0f / (kDesaturation * (peak - mapped) + 1.0f);
    return glm::mix(glm::vec3(mapped), color * (mapped / peak), kept);
}

glm::vec3 aces(const glm::vec3& x) {
    return x * (2.51f * x + 0.03f) / (x * (2.43f * x + 0.59f) + 0.14f);
}

}  // namespace

std::optional<Tone> tone_from_name(std::string_view name) {
    if (name == "neutral") return Tone::kNeutral;
    if (name == "aces") return Tone::kAces;
    if (name == "linear") return Tone::kLinear;
    return std::nullopt;
}

glm::vec3 tone_map(Tone tone, const glm::vec3& color) {
    glm::vec3 usable;
    for (int c = 0; c < 3; ++c) usable[c] = color[c] > 0.0f ? std::min(color[c], kMost) : 0.0f;
    const glm::vec3 mapped = tone == Tone::kNeutral ? neutral(usable) : tone == Tone::kAces ? aces(usable) : usable;
    return glm::clamp(mapped, 0.0f, 1.0f);
}

}  // namespace zoe
