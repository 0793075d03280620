#include "engine/render/light.h"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>
#include <glm/exponential.hpp>
#include <glm/geometric.hpp>

#include "engine/render/direction.h"

namespace zoe {

namespace {

/// A light's place, axis and strength from its node.
PunctualLight place(const Light& light, const Affine& world_from_light) {
    PunctualLight placed;
    placed.kind = light.kind;
    placed.position = world_from_light.translation;
    placed.axis = unit_or(-world_from_light.linear[2], glm::vec3(0.0f));
    placed.intensity = light.color * light.intensity;
    placed.range = light.range;
    if (light.kind == LightKind::kSpot) {
        const float cos_outer = std::cos(light.outer_cone);
        placed.cone_scale = 1.0f / std::max(0.001f, std::cos(light.inner_cone) - cos_outer);
        placed.cone_offset = -cos_outer * placed.cone_scale;
    }
    return placed;
}

}  // namespace

glm::vec3 default_sky(const glm::vec3& direction) {
    const glm::vec3 zenith(0.20f, 0.38f, 0.78f), horizon(0.78f, 0.86f, 0.95f), ground(0.30f, 0.28f, 0.26f);
    const float up = direction.y;
    const glm::vec3 above = glm::mix(horizon, zenith, std::sqrt(std::clamp(up, 0.0f, 1.0f)));
    return glm::mix(ground, above, glm::smoothstep(-0.03f, 0.01f, up));
}

Sun default_sun() {
    return {glm::normalize(glm::vec3(0.45f, 0.75f, 0.5f)), {2.6f, 2.45f, 2.2f}, 2.0f * kSunRadius};
}

glm::vec3 Lighting::sky(const glm::vec3& direction) const {
    if (uniform_sky) return *uniform_sky;
    return sky_strength * (environment != nullptr ? environment->radiance(direction) : default_sky(direction));
}

void gather_lights(const Scene& scene, const RenderConfig& config, Lighting* lighting) {
    lighting->lights.clear();
    for (size_t i = 0; i < scene.nodes.size(); ++i) {
        const Node& node = scene.nodes[i];
        if (node.light == kNone<LightId> || !node.is_shown) continue;
        const Light& light = scene.lights[index(node.light)];
        const PunctualLight placed = place(light, world_from_node(scene, NodeId{static_cast<uint32_t>(i)}));
        const bool needs_axis = light.kind != LightKind::kPoint;
        if (needs_axis && placed.axis == glm::vec3(0.0f)) continue;
        const glm::vec3 sum = placed.position + placed.intensity;
        if (!std::isfinite(sum.x + sum.y + sum.z)) continue;
        lighting->lights.push_back(placed);
    }
    lighting->uniform_sky = config.uniform_sky;
    lighting->sky_strength = config.sky_strength;
    lighting->environment = config.uniform_sky ? nullptr : config.environment;
    const Sun sun = config.environment != nullptr ? config.environment->sun() : default_sun();
    lighting->sun = config.uniform_sky ? Sun() : sun.times(config.sun_strength);
}

Illumination illuminate(const PunctualLight& light, const glm::vec3& point) {
    if (light.kind == LightKind::kDirectional) return {-light.axis, light.intensity};
    const glm::vec3 offset = light.position - point;
    const float distance2 = glm::dot(offset, offset);
    if (!(distance2 > 0.0f) || !std::isfinite(distance2)) return {};
    const glm::vec3 toward = offset / std::sqrt(distance2);
    float share = 1.0f / distance2;
    if (light.range > 0.0f) {
        const float ratio2 = distance2 / (light.range * light.range);
        share *= std::clamp(1.0f - ratio2 * ratio2, 0.0f, 1.0f);
    }
    if (light.kind == LightKind::kSpot) {
        const float inside = std::clamp(glm::dot(light.axis, -toward) * light.cone_scale + light.cone_offset, 0.0f, 1.0f);
        share *= inside * inside;
    }
    if (!std::isfinite(share)) return {};
    return {toward, light.intensity * share};
}

}  // namespace zoe
