#pragma once

#include <cmath>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "engine/math/affine.h"
#include "engine/math/rng.h"

namespace zoe::test {

/// A magnitude between lo and hi, every decade as likely as another.
inline float log_uniform(Rng& rng, double lo, double hi) {
    return static_cast<float>(lo * std::pow(hi / lo, static_cast<double>(rng.uniform())));
}

inline float random_sign(Rng& rng) {
    return rng.below(2) == 0 ? -1.0f : 1.0f;
}

/// Uniform in the cube of half-width `size` about the origin.
inline glm::vec3 random_point(Rng& rng, float size) {
    const float x = rng.uniform(-size, size);
    const float y = rng.uniform(-size, size);
    const float z = rng.uniform(-size, size);
    return {x, y, z};
}

/// Uniform on the unit sphere, by rejection.
inline glm::vec3 random_direction(Rng& rng) {
    while (true) {
        const glm::vec3 p = random_point(rng, 1.0f);
        const float length = glm::length(p);
        if (length > 0.05f && length <= 1.0f) return p / length;
    }
}

inline glm::quat random_rotation(Rng& rng) {
    while (true) {
        const glm::vec3 v = random_point(rng, 1.0f);
        const float w = rng.uniform(-1.0f, 1.0f);
        const float length = std::sqrt(w * w + glm::dot(v, v));
        if (length > 0.05f && length <= 1.0f) return glm::quat(w / length, v.x / length, v.y / length, v.z / length);
    }
}

/// Rotation, scale (each axis between lo and hi, mirrored half the time), shear up to 1 and a translation.
inline Affine random_affine(Rng& rng, double scale_lo, double scale_hi, float translation) {
    glm::mat3 linear = glm::mat3_cast(random_rotation(rng));
    for (int axis = 0; axis < 3; ++axis) linear[axis] *= log_uniform(rng, scale_lo, scale_hi) * random_sign(rng);
    glm::mat3 shear(1.0f);
    shear[1][0] = rng.uniform(-1.0f, 1.0f);
    shear[2][0] = rng.uniform(-1.0f, 1.0f);
    shear[2][1] = rng.uniform(-1.0f, 1.0f);
    return {linear * shear, random_point(rng, translation)};
}

}  // namespace zoe::test
