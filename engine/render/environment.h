#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "engine/render/sun.h"

namespace zoe {

struct FloatImage;

/// A picture of all directions that lights a scene: its columns go round from -Z in the middle over +X on the right, its
/// rows from straight up to straight down.
class Environment {
public:
    /// picture    channels R, G, B, or one for grey. Values below 0 and NaN count as 0, those above 1e6 as 1e6;
    ///            rows are twice as long as columns, or the picture is stretched.
    /// sun        what is too small for pixels.
    /// Throws     std::runtime_error where it has no such channels.
    explicit Environment(const FloatImage& picture, const Sun& sun = {});

    /// From a unit direction, without the sun; between the centres of pixels it is blended.
    glm::vec3 radiance(const glm::vec3& direction) const;

    /// A unit direction, by the brightness of pixels and their solid angle.
    /// u          two numbers in [0, 1).
    glm::vec3 sample(const glm::vec2& u) const;
    /// The density of `sample`, per steradian; 0 where the picture is black.
    float density(const glm::vec3& direction) const;

    const Sun& sun() const { return sun_; }

    uint64_t repaired_count() const { return repaired_count_; }  ///< Pixels with a value that was brought into range.

private:
    size_t pixel_at(int x, int y) const {
        return static_cast<size_t>(y) * static_cast<size_t>(width_) + static_cast<size_t>(x);
    }

    int width_ = 0, height_ = 0;
    uint64_t repaired_count_ = 0;
    std::vector<glm::vec3> pixels_;  // [height * width]
    std::vector<float> rows_;        // [height] sums of weights up to the row's end, over all
    std::vector<float> columns_;     // [height * width] within the row
    double total_ = 0.0;             // sum of weights
    Sun sun_;
};

/// Reads an environment from a file that OpenImageIO can read (HDR, EXR, ...).
/// Throws     std::runtime_error with the file's name and the reason.
Environment read_environment(const std::filesystem::path& file);

}  // namespace zoe
