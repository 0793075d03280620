#include "engine/render/environment.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <glm/common.hpp>
#include <glm/gtc/constants.hpp>

#include "engine/render/direction.h"
#include "engine/scene/image.h"
#include "engine/scene/srgb.h"

namespace zoe {

namespace {

constexpr float kBrightest = 1e6f;

/// Positions of red, green and blue among a picture's channels.
glm::ivec3 find_channels(const FloatImage& picture) {
    const auto position = [&](const char* name) {
        return static_cast<int>(std::find(picture.channels.begin(), picture.channels.end(), name) -
                                picture.channels.begin());
    };
    const glm::ivec3 found(position("R"), position("G"), position("B"));
    const int count = static_cast<int>(picture.channels.size());
    if (found.x < count && found.y < count && found.z < count) return found;
    if (count == 1 || count == 2) return glm::ivec3(0);
    throw std::runtime_error("a sky needs the channels R, G and B, or grey");
}

/// Where a direction is in a picture of 1 x 1: x to the right from the left edge, y down.
glm::vec2 place_of(const glm::vec3& direction) {
    const float x = 0.5f + std::atan2(direction.x, -direction.z) * (0.5f * glm::one_over_pi<float>());
    return {x, std::acos(std::clamp(direction.y, -1.0f, 1.0f)) * glm::one_over_pi<float>()};
}

/// The entry in which a share of the whole falls, and where within it.
/// sums       ascending; the last one is the whole.
size_t find(const float* sums, size_t count, float share, float* within) {
    const float at = share * sums[count - 1];
    size_t i = static_cast<size_t>(std::upper_bound(sums, sums + count, at) - sums);
    if (i == count) i = static_cast<size_t>(std::lower_bound(sums, sums + count, sums[count - 1]) - sums);
    const float begin = i == 0 ? 0.0f : sums[i - 1];
    *within = std::clamp((at - begin) / (sums[i] - begin), 0.0f, 1.0f);
    return i;
}

}  // namespace

Environment::Environment(const FloatImage& picture, const Sun& sun)
    : width_(picture.width), height_(picture.height), sun_(sun) {
    const glm::ivec3 channel = find_channels(picture);
    const size_t stride = picture.channels.size(), pixel_count = static_cast<size_t>(width_) * static_cast<size_t>(height_);
    pixels_.resize(pixel_count);
    for (size_t i = 0; i < pixel_count; ++i) {
        bool is_repaired = false;
        for (int c = 0; c < 3; ++c) {
            float value = picture.values[i * stride + static_cast<size_t>(channel[c])];
            if (picture.is_encoded) value = linear_from_srgb(value);
            const float inside = value > 0.0f ? std::min(value, kBrightest) : 0.0f;  // NaN is not above 0
            is_repaired |= !(value >= 0.0f && value <= kBrightest);
            pixels_[i][c] = inside;
        }
        repaired_count_ += is_repaired ? 1 : 0;
    }
    rows_.resize(static_cast<size_t>(height_));
    columns_.resize(pixel_count);
    for (int y = 0; y < height_; ++y) {
        // A row is as wide on the sphere as the sine of its angle from the pole.
        const double sine = std::sin((y + 0.5) * glm::pi<double>() / height_);
        double row = 0.0;
        for (int x = 0; x < width_; ++x) {
            row += static_cast<double>(largest(pixels_[pixel_at(x, y)])) * sine;
            columns_[pixel_at(x, y)] = static_cast<float>(row);
        }
        total_ += row;
        rows_[static_cast<size_t>(y)] = static_cast<float>(total_);
    }
}

glm::vec3 Environment::radiance(const glm::vec3& direction) const {
    const glm::vec2 place = place_of(direction) * glm::vec2(width_, height_) - 0.5f;
    const float left = std::floor(place.x), top = std::floor(place.y);
    const auto fetch = [&](int x, int y) {
        return pixels_[pixel_at((x + width_) % width_, std::clamp(y, 0, height_ - 1))];  // round, but not over the poles
    };
    const int x = static_cast<int>(left), y = static_cast<int>(top);
    const float fx = place.x - left, fy = place.y - top;
    return glm::mix(glm::mix(fetch(x, y), fetch(x + 1, y), fx), glm::mix(fetch(x, y + 1), fetch(x + 1, y + 1), fx), fy);
}

glm::vec3 Environment::sample(const glm::vec2& u) const {
    if (!(total_ > 0.0)) return {0, 1, 0};
    glm::vec2 within;
    const size_t y = find(rows_.data(), rows_.size(), u.y, &within.y);
    const size_t x = find(&columns_[y * static_cast<size_t>(width_)], static_cast<size_t>(width_), u.x, &within.x);
    const float round = ((static_cast<float>(x) + within.x) / static_cast<float>(width_) - 0.5f) * glm::two_pi<float>();
    const float down = (static_cast<float>(y) + within.y) / static_cast<float>(height_) * glm::pi<float>();
    return {std::sin(down) * std::sin(round), std::cos(down), -std::sin(down) * std::cos(round)};
}

float Environment::density(const glm::vec3& direction) const {
    if (!(total_ > 0.0)) return 0.0f;
    const glm::vec2 place = place_of(direction) * glm::vec2(width_, height_);
    const int x = std::clamp(static_cast<int>(place.x), 0, width_ - 1),
              y = std::clamp(static_cast<int>(place.y), 0, height_ - 1);
    const double row_sine = std::sin((y + 0.5) * glm::pi<double>() / height_);
    const double weight = static_cast<double>(largest(pixels_[pixel_at(x, y)])) * row_sine;
    // The pixel's share, per its area in the picture, per solid angle there: 2 pi * pi * sine for all of the picture.
    const double sine =
        std::sqrt(std::max(1e-12, 1.0 - static_cast<double>(direction.y) * static_cast<double>(direction.y)));
    const double pixel_count = static_cast<double>(width_) * static_cast<double>(height_);
    return static_cast<float>(weight / total_ * pixel_count / (2.0 * glm::pi<double>() * glm::pi<double>() * sine));
}

Environment read_environment(const std::filesystem::path& file) {
    const FloatImage picture = read_picture(file);
    try {
        return Environment(picture);
    } catch (const std::runtime_error& error) {
        throw std::runtime_error(file.string() + ": " + error.what());
    }
}

}  // namespace zoe
