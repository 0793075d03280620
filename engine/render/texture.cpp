#include "engine/render/texture.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include <glm/common.hpp>

#include "engine/scene/half.h"

namespace zoe {

namespace {

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

/// A picture's pixels: of the image itself, or of a coarser level.
struct Pixels {
    int width, height;
    const uint8_t* bytes;
    bool is_half;
};

Pixels pixels_of(const Image& image, size_t level) {
    if (level == 0) return {image.width, image.height, image.pixels.data(), image.is_half};
    const ImageLevel& coarser = image.coarser[level - 1];
    return {coarser.width, coarser.height, coarser.pixels.data(), image.is_half};
}

glm::vec4 half_texel(const Pixels& pixels, size_t at, Texels texels) {
    uint16_t h[4];
    std::memcpy(h, pixels.bytes + sizeof h * at, sizeof h);
    const glm::vec4 value(float_from_half(h[0]), float_from_half(h[1]), float_from_half(h[2]), float_from_half(h[3]));
    return texels == Texels::kLight ? value : glm::min(value, glm::vec4(1.0f));
}

glm::vec4 texel(const Pixels& pixels, int x, int y, Texels texels) {
    const size_t at = static_cast<size_t>(y) * static_cast<size_t>(pixels.width) + static_cast<size_t>(x);
    if (pixels.is_half) return half_texel(pixels, at, texels);
    const uint8_t* const p = pixels.bytes + 4 * at;
    constexpr float kScale = 1.0f / 255.0f;
    if (texels == Texels::kNumbers) return kScale * glm::vec4(p[0], p[1], p[2], p[3]);
    return {linear_from_srgb_byte(p[0]), linear_from_srgb_byte(p[1]), linear_from_srgb_byte(p[2]),
            static_cast<float>(p[3]) / 255.0f};
}

/// at         within a period of the image.
glm::vec4 sample_level(const Pixels& pixels, const TextureRef& texture, bool is_nearest, const glm::vec2& at,
                       Texels texels) {
    const float x = at.x * static_cast<float>(pixels.width), y = at.y * static_cast<float>(pixels.height);
    const auto fetch = [&](int i, int j) {
        return texel(pixels, wrap_texel(i, pixels.width, texture.wrap_s), wrap_texel(j, pixels.height, texture.wrap_t),
                     texels);
    };
    if (is_nearest) return fetch(static_cast<int>(std::floor(x)), static_cast<int>(std::floor(y)));

    const float left = std::floor(x - 0.5f), top = std::floor(y - 0.5f);
    const float fx = x - 0.5f - left, fy = y - 0.5f - top;
    const int i = static_cast<int>(left), j = static_cast<int>(top);
    return glm::mix(glm::mix(fetch(i, j), fetch(i + 1, j), fx), glm::mix(fetch(i, j + 1), fetch(i + 1, j + 1), fx), fy);
}

/// The level, with its fraction, whose texels are as wide as what is looked at, if there were such; 0 where those of the
/// finest are not narrower.
float level_of(const Image& image, const TextureRef& texture, float uv_width) {
    if (!(uv_width > 0.0f)) return 0.0f;
    const glm::mat3& m = texture.image_from_uv;
    const float stretch = std::abs(m[0].x * m[1].y - m[1].x * m[0].y);
    const float texel_count = static_cast<float>(image.width) * static_cast<float>(image.height);
    const float texels_wide = uv_width * std::sqrt(stretch * texel_count);
    return texels_wide > 1.0f ? std::log2(texels_wide) : 0.0f;
}

/// The level that is looked up, with its fraction where that one is blended with the next.
float filter_level(const Image& image, const TextureRef& texture, float level) {
    if (texture.levels == LevelFilter::kFinest) return 0.0f;
    if (texture.levels == LevelFilter::kNearest) level = std::ceil(level - 0.5f);
    return std::min(level, static_cast<float>(image.coarser.size()));
}

}  // namespace

bool has_pixels(std::span<const Image> images, const TextureRef& texture) {
    return texture.image != kNone<ImageId> && index(texture.image) < images.size() &&
           !images[index(texture.image)].pixels.empty();
}

glm::vec4 mean_texel(const Image& image, Texels texels) {
    const Pixels coarsest = pixels_of(image, image.coarser.size());
    return coarsest.width == 1 && coarsest.height == 1 ? texel(coarsest, 0, 0, texels) : glm::vec4(1.0f);
}

glm::vec4 sample_texture(std::span<const Image> images, const TextureRef& texture, const glm::vec2& uv, float uv_width,
                         Texels texels) {
    if (!has_pixels(images, texture)) return glm::vec4(1.0f);
    const Image& image = images[index(texture.image)];
    const glm::vec3 moved = texture.image_from_uv * glm::vec3(uv, 1.0f);
    const glm::vec2 at(reduce(moved.x, texture.wrap_s), reduce(moved.y, texture.wrap_t));
    const float wanted = level_of(image, texture, uv_width);
    if (!(wanted > 0.0f)) return sample_level(pixels_of(image, 0), texture, texture.is_nearest, at, texels);

    const float level = filter_level(image, texture, wanted), finer = std::floor(level);
    const auto look_up = [&](float of) {
        return sample_level(pixels_of(image, static_cast<size_t>(of)), texture, texture.is_nearest_minified, at, texels);
    };
    const glm::vec4 value = look_up(finer);
    return level > finer ? glm::mix(value, look_up(finer + 1.0f), level - finer) : value;
}

}  // namespace zoe
