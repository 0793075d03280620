#pragma once

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace zoe {

/// Microfacets with the GGX distribution of slopes and Smith's masking. All directions are unit, in a frame whose z is the
/// surface's normal; alpha is the slopes' width.
/// Source     Walter et al. Microfacet Models for Refraction through Rough Surfaces. EGSR 2007.
///            Heitz. Understanding the Masking-Shadowing Function in Microfacet-Based BRDFs. JCGT 2014.
///            Heitz. Sampling the GGX Distribution of Visible Normals. JCGT 2018.

/// Below this, the distribution is narrower than floats resolve.
inline constexpr float kMinAlpha = 1e-3f;
inline float alpha_of(float roughness) {
    return std::max(roughness * roughness, kMinAlpha);
}

/// Density of microfacets with a normal, per steradian and area of the surface. Without the difference of near equal
/// numbers that the usual form has where alpha is small.
inline float ggx_density(const glm::vec3& normal, float alpha) {
    const float a2 = alpha * alpha;
    const float spread = normal.x * normal.x + normal.y * normal.y + a2 * normal.z * normal.z;
    return a2 * glm::one_over_pi<float>() / (spread * spread);
}

/// Area hidden from a direction per area that is seen.
inline float ggx_hidden(const glm::vec3& direction, float alpha) {
    const float z2 = direction.z * direction.z;
    const float slope2 = alpha * alpha * (direction.x * direction.x + direction.y * direction.y) / std::max(z2, 1e-12f);
    // sqrt(1 + x) - 1 for small x.
    return 0.5f * slope2 / (std::sqrt(1.0f + slope2) + 1.0f);
}

/// The share of facets with a given normal that a direction sees.
inline float ggx_seen(const glm::vec3& direction, float alpha) {
    return 1.0f / (1.0f + ggx_hidden(direction, alpha));
}

/// The share that two directions on the same side both see.
inline float ggx_seen_by_both(const glm::vec3& a, const glm::vec3& b, float alpha) {
    return 1.0f / (1.0f + ggx_hidden(a, alpha) + ggx_hidden(b, alpha));
}

/// A microfacet's normal among those that a direction sees, by their seen area.
/// u          two numbers in [0, 1).
/// Source     Dupuy, Benyoub. Sampling Visible GGX Normals with Spherical Caps. HPG 2023.
inline glm::vec3 sample_seen_normal(const glm::vec3& direction, float alpha, const glm::vec2& u) {
    const glm::vec3 stretched = glm::normalize(glm::vec3(alpha * direction.x, alpha * direction.y, direction.z));
    const float angle = glm::two_pi<float>() * u.x;
    const float z = (1.0f - u.y) * (1.0f + stretched.z) - stretched.z;
    const float radius = std::sqrt(std::clamp(1.0f - z * z, 0.0f, 1.0f));
    const glm::vec3 half = glm::vec3(radius * std::cos(angle), radius * std::sin(angle), z) + stretched;
    return glm::normalize(glm::vec3(alpha * half.x, alpha * half.y, std::max(half.z, 1e-7f)));
}

/// What a smooth surface reflects: f0 straight on, f90 at grazing.
/// Source     Schlick. An Inexpensive BRDF Model for Physically-based Rendering. 1994.
inline float schlick_share(float cosine) {
    const float x = std::clamp(1.0f - cosine, 0.0f, 1.0f);
    return x * x * x * x * x;
}

/// Charlie: the density of fibres' normals in cloth.
/// Source     Estevez, Kulla. Production Friendly Microfacet Sheen BRDF. 2017; the masking of Neubelt, Pettineo. Crafting a
///            Next-Gen Material Pipeline for The Order: 1886. 2013.
inline float sheen_density(float normal_z, float alpha) {
    const float sine2 = std::max(1.0f - normal_z * normal_z, 0.0f);
    const float power = 1.0f / alpha;
    return (2.0f + power) * 0.5f * glm::one_over_pi<float>() * std::pow(sine2, 0.5f * power);
}

/// Of white sheen, with the cosine of the direction that light comes from.
inline float sheen(const glm::vec3& to_viewer, const glm::vec3& to_light, float alpha) {
    const float v = to_viewer.z, l = to_light.z;
    const glm::vec3 half = glm::normalize(to_viewer + to_light);
    return sheen_density(half.z, alpha) * l / (4.0f * std::max(l + v - l * v, 1e-6f));
}
inline float sheen_alpha(float roughness) {
    return std::max(roughness * roughness, 0.02f);
}

}  // namespace zoe
