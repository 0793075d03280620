#include "apps/demo/orbit.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>
#include <glm/trigonometric.hpp>

namespace zoe {
namespace {

constexpr float kMaxPitch = 1.553f;  // 89 degrees: +Y stays up

/// From the target towards the eye.
glm::vec3 backward(const Orbit& orbit) {
    return {std::sin(orbit.yaw) * std::cos(orbit.pitch), std::sin(orbit.pitch), std::cos(orbit.yaw) * std::cos(orbit.pitch)};
}

}  // namespace

ViewChoice::LookAt Orbit::look_at() const {
    return {target + distance * backward(*this), target, fov_degrees};
}

void Orbit::turn(float dx, float dy, float height) {
    const float radians_a_pixel = glm::pi<float>() / std::max(height, 1.0f);
    yaw = std::remainder(yaw - dx * radians_a_pixel, glm::two_pi<float>());
    pitch = std::clamp(pitch + dy * radians_a_pixel, -kMaxPitch, kMaxPitch);
}

void Orbit::pan(float dx, float dy, float height) {
    const float metres_a_pixel = 2.0f * distance * std::tan(glm::radians(fov_degrees) / 2.0f) / std::max(height, 1.0f);
    const glm::vec3 right{std::cos(yaw), 0.0f, -std::sin(yaw)};
    const glm::vec3 up = glm::cross(backward(*this), right);
    target += metres_a_pixel * (dy * up - dx * right);
}

void Orbit::zoom(float steps) {
    distance = std::clamp(distance * std::pow(0.9f, steps), 1e-6f, 1e12f);
}

Orbit orbit_from_view(const View& view, const Aabb& bounds) {
    const bool has_bounds = !bounds.is_empty() && bounds.is_finite();
    const float size = has_bounds ? std::max(glm::length(bounds.extent()), 1e-6f) : 2.0f;
    const glm::vec3 centre = has_bounds ? bounds.centre() : glm::vec3(0.0f);

    Orbit orbit;
    orbit.yaw = std::atan2(view.axis_z.x, view.axis_z.z);
    orbit.pitch = std::clamp(std::asin(std::clamp(view.axis_z.y, -1.0f, 1.0f)), -kMaxPitch, kMaxPitch);
    if (view.is_perspective) {
        orbit.fov_degrees = std::clamp(glm::degrees(2.0f * std::atan(view.half_height)), 1.0f, 170.0f);
        orbit.distance = glm::dot(centre - view.origin, -view.axis_z);
        if (orbit.distance < 0.01f * size) orbit.distance = 0.5f * size;  // it looks away from the scene
    } else {
        orbit.distance = std::max(view.half_height / std::tan(glm::radians(orbit.fov_degrees) / 2.0f), 1e-6f);
    }
    orbit.target = view.origin - orbit.distance * view.axis_z;
    return orbit;
}

}  // namespace zoe
