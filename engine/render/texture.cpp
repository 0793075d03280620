#include "engine/render/texture.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <glm/common.hpp>

namespace zoe {

namespace {

std::array<float, 256> make_srgb_table() {
    std::array<float, 256> table{};
    for (int i = 0; i < 256; ++i) {
        table[static_cast<size_t>(i)] = linear_from_srgb(static_cast<float>(i) / 255.0f);
    }
    return table;
}

const std::array<float, 256> kLinearFromSrgb = make_srgb_table();

/// Brings a coordinate into the image's period (2 for mirrored, else 1), so that texel numbers stay small and exact.
float reduce(float x, Wrap wrap) {
    if (!std::isfinite(x)) return 0.0f;
    switch (wrap) {
        case Wrap::kRepeat:
            return x - std::floor(x);
        case Wrap::kMirror:
            return x - 2.0f * std::floor(0.5f * x);
        case Wrap::kClamp:
            break;
    }
    return std::clamp(x, 0.0f, 1.0f);
}

/// The texel in [0, size) that stands for texel i, which is at most a period away from the image.
int wrap_texel(int i, int size, Wrap wrap) {
    switch (wrap) {
        case Wrap::kRepeat:
            return (i + size) % size;
        case Wrap::kMirror: {
            const int k = (i + 2 * size) % (2 * size);
            return k < size ? k : 2 * size - 1 - k;
        }
        case Wrap::kClamp:
            break;
    }
    return std::clamp(i, 0, size - 1);
}

glm::vec4 texel(const Image& image, int x, int y) {
    const uint8_t* p =
        &image.pixels[4 * (static_cast<size_t>(y) * static_cast<size_t>(image.width) + static_cast<size_t>(x))];
    return {kLinearFromSrgb[p[0]], kLinearFromSrgb[p[1]], kLinearFromSrgb[p[2]], static_cast<float>(p[3]) / 255.0f};
}

}  // namespace

float linear_from_srgb(float encoded) {
    return encoded <= 0.04045f ? encoded / 12.92f : std::pow((encoded + 0.055f) / 1.055f, 2.4f);
}

float linear_from_srgb_byte(uint8_t encoded) {
    return kLinearFromSrgb[encoded];
}

glm::vec4 sample_texture(std::span<const Image> images, const TextureRef& texture, const glm::vec2& uv) {
    if (texture.image == kNone<ImageId> || index(texture.image) >= images.size()) return glm::vec4(1.0f);
    const Image& image = images[index(texture.image)];
    if (image.pixels.empty()) return glm::vec4(1.0f);

    const glm::vec3 at = texture.image_from_uv * glm::vec3(uv, 1.0f);
    const float x = reduce(at.x, texture.wrap_s) * static_cast<float>(image.width);
    const float y = reduce(at.y, texture.wrap_t) * static_cast<float>(image.height);
    const auto fetch = [&](int i, int j) {
        return texel(image, wrap_texel(i, image.width, texture.wrap_s), wrap_texel(j, image.height, texture.wrap_t));
    };
    if (texture.is_nearest) return fetch(static_cast<int>(std::floor(x)), static_cast<int>(std::floor(y)));

    const float left = std::floor(x - 0.5f), top = std::floor(y - 0.5f);
    const float fx = x - 0.5f - left, fy = y - 0.5f - top;
    const int i = static_cast<int>(left), j = static_cast<int>(top);
    return glm::mix(glm::mix(fetch(i, j), fetch(i + 1, j), fx), glm::mix(fetch(i, j + 1), fetch(i + 1, j + 1), fx), fy);
}

}  // namespace zoe
