#include "engine/render/inspect.h"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "engine/scene/srgb.h"

namespace zoe {

namespace {

glm::vec3 from_srgb(int r, int g, int b) {
    return glm::vec3(linear_from_srgb(r / 255.0f), linear_from_srgb(g / 255.0f), linear_from_srgb(b / 255.0f));
}

}  // namespace

glm::vec3 motion_color(Motion motion) {
    switch (motion) {
        case Motion::kStatic:
            return from_srgb(150, 150, 150);
        case Motion::kRigid:
            return from_srgb(30, 100, 200);
        case Motion::kDeforming:
            return from_srgb(240, 160, 30);
        case Motion::kArbitrary:
            break;
    }
    return from_srgb(190, 40, 140);
}

glm::vec3 inspect(Shade shade, const Surface& surface, Motion motion, const glm::vec3& toward_viewer) {
    if (shade == Shade::kAlbedo) return surface.base_color;
    if (shade == Shade::kNormal) return 0.5f + 0.5f * surface.ns;
    const float facing = std::clamp(glm::dot(surface.ns, toward_viewer), 0.0f, 1.0f);
    return motion_color(motion) * (0.35f + 0.65f * facing);
}

glm::vec3 cost_color(uint64_t tests) {
    const float x = std::log2(1.0f + static_cast<float>(tests)) / std::log2(1.0f + static_cast<float>(kCostScale));
    const float heat = std::min(x, 1.0f);
    // Red rises first, then green; blue glows in between, which leads the hue through violet. Encoded, as the eye sees it.
    const glm::vec3 encoded(glm::smoothstep(0.05f, 0.75f, heat), std::pow(heat, 1.8f) * 0.95f,
                            0.16f + 0.9f * heat * (1.0f - heat) * (1.6f - heat));
    return {linear_from_srgb(encoded.x), linear_from_srgb(encoded.y), linear_from_srgb(encoded.z)};
}

}  // namespace zoe
