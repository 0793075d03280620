#pragma once

#include <limits>

#include <glm/vec3.hpp>

namespace zoe {

/// A ray, world space unless the name says otherwise. The direction need not have length 1; `t` counts in its lengths.
struct Ray {
    glm::vec3 origin{0.0f};
    glm::vec3 direction{0.0f, 0.0f, -1.0f};
    float t_min = 0.0f;                                    ///< At least 0. Hits at exactly t_min count.
    float t_max = std::numeric_limits<float>::infinity();  ///< Hits at exactly t_max count.
};

}  // namespace zoe
