#include "engine/render/upsample.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "engine/math/aabb.h"
#include "engine/math/parallel.h"

namespace zoe {

namespace {

constexpr uint32_t kSky = 0xffffffffu;
constexpr size_t kRowGrain = 4;
constexpr float kBrightest = 1e15f;     // as the filter has it
constexpr float kFlat = 0.01f;          // share of its depth that a surface may rise by anywhere
constexpr float kSlanted = 2.0f;        // times what it rises by beside the pixel
constexpr float kTurned = 4.0f;         // of 1 - cosine: nothing is alike beyond a quarter
constexpr float kApart = 1.0f / 16.0f;  // what a pixel's distance counts for where nothing is alike

/// Tells whether light makes a pixel brighter.
bool is_lit(const Guides& guides, size_t pixel) {
    return guides.node[pixel] != kSky && guides.normal[pixel] != glm::vec3(0.0f);
}

glm::vec3 divisor_of(const glm::vec3& albedo) {
    return kLeastAlbedo + (1.0f - kLeastAlbedo) * albedo;
}

/// By how much a surface rises to the next pixel of a row or column: the lesser of two sides, of those that show the same
/// node. At the border that of the pixel beside it: a single side may be an edge.
/// at, count  where the pixel stands, and how many there are, `step` apart.
float slope(const Guides& guides, size_t pixel, size_t at, size_t count, size_t step) {
    if (count > 2 && at == 0) return slope(guides, pixel + step, 1, count, step);
    if (count > 2 && at + 1 == count) return slope(guides, pixel - step, at - 1, count, step);
    float least = std::numeric_limits<float>::infinity();
    const auto look = [&](size_t other) {
        if (guides.node[other] == guides.node[pixel])
            least = std::min(least, std::abs(guides.depth[other] - guides.depth[pixel]));
    };
    if (at > 0) look(pixel - step);
    if (at + 1 < count) look(pixel + step);
    return std::isfinite(least) ? least : 0.0f;
}

}  // namespace

/// A pixel of the large picture.
struct Upsampler::Place {
    float x, y;  // in the small picture: whole numbers are pixels' centres
    glm::vec3 normal;
    float depth;
    float slope_x, slope_y;  // metres a pixel of the small picture
    uint32_t node;

    /// From 0, of another surface, to 1.
    float likeness(const Sample& sample, float dx, float dy) const {
        if (sample.node != node) return 0.0f;
        const float rise = kSlanted * (slope_x * dx + slope_y * dy) + kFlat * std::abs(depth);
        const float deeper = 2.0f - 2.0f * std::abs(sample.depth - depth) / rise;
        const float turned = 1.0f - kTurned * (1.0f - glm::dot(normal, sample.normal));
        // Of what is not a number, neither is above.
        if (!(deeper > 0.0f && turned > 0.0f)) return 0.0f;
        return std::min(deeper, 1.0f) * std::min(turned, 1.0f);
    }
    /// The less the better, of any surfaces.
    float difference(const Sample& sample, float dx, float dy) const {
        const float deeper = std::abs(sample.depth - depth) / (std::abs(sample.depth) + std::abs(depth));
        return (sample.node != node ? 1.0f : 0.0f) + deeper + (1.0f - glm::dot(normal, sample.normal)) + kApart * (dx + dy);
    }
};

void Upsampler::take_in(const Guides& guides, const Film& film) {
    width_ = film.width;
    height_ = film.height;
    const auto width = static_cast<size_t>(width_), height = static_cast<size_t>(height_);
    samples_.resize(width * height);
    row_sums_.resize(height);
    parallel_for(0, height, kRowGrain, [&](size_t begin, size_t end) {
        for (size_t row = begin; row < end; ++row) {
            glm::dvec4 sum(0.0);
            for (size_t k = row * width; k < (row + 1) * width; ++k) {
                const glm::vec3 light =
                    (film.share_of(k) * glm::vec3(film.sum[k]) - guides.unfiltered[k]) / divisor_of(guides.albedo[k]);
                const bool is_known = is_lit(guides, k) && is_finite(light);
                samples_[k] = {glm::clamp(light, 0.0f, kBrightest), guides.normal[k], guides.depth[k],
                               is_known ? guides.node[k] : kSky};
                if (is_known) sum += glm::dvec4(samples_[k].light, 1.0);
            }
            row_sums_[row] = sum;
        }
    });
    glm::dvec4 sum(0.0);
    for (const glm::dvec4& row : row_sums_) sum += row;
    mean_ = sum.w > 0.0 ? glm::vec3(glm::dvec3(sum) / sum.w) : glm::vec3(0.0f);
}

/// Calls `use(sample, dx, dy)` for what is known less than `reach` pixels away.
template <typename Use>
void Upsampler::for_beside(const Place& place, int reach, const Use& use) const {
    const int left = static_cast<int>(std::floor(place.x)), top = static_cast<int>(std::floor(place.y));
    for (int y = std::max(top - reach + 1, 0); y <= std::min(top + reach, height_ - 1); ++y) {
        for (int x = std::max(left - reach + 1, 0); x <= std::min(left + reach, width_ - 1); ++x) {
            const Sample& sample = samples_[static_cast<size_t>(y) * static_cast<size_t>(width_) + static_cast<size_t>(x)];
            if (sample.node == kSky) continue;
            use(sample, std::abs(place.x - static_cast<float>(x)), std::abs(place.y - static_cast<float>(y)));
        }
    }
}

glm::vec3 Upsampler::light_at(const Place& place) const {
    for (const int reach : {1, 2}) {
        glm::vec3 sum(0.0f);
        float weights = 0.0f;
        const float far = static_cast<float>(reach);
        for_beside(place, reach, [&](const Sample& sample, float dx, float dy) {
            const float weight = (far - dx) * (far - dy) * place.likeness(sample, dx, dy);
            sum += weight * sample.light;
            weights += weight;
        });
        if (weights > 0.0f) return sum / weights;
    }
    glm::vec3 light = mean_;
    float least = std::numeric_limits<float>::infinity();
    for_beside(place, 2, [&](const Sample& sample, float dx, float dy) {
        const float difference = place.difference(sample, dx, dy);
        if (!(difference < least)) return;
        least = difference;
        light = sample.light;
    });
    return light;
}

void Upsampler::light(const Guides& from_guides, const Film& from, const Guides& guides, Film* film) {
    assert(from.sample_count > 0 && from.width == from_guides.width && from.height == from_guides.height);
    assert(film->sample_count > 0 && film->width == guides.width && film->height == guides.height);
    take_in(from_guides, from);
    const auto scale = static_cast<float>(film->sample_count);
    const auto width = static_cast<size_t>(film->width), height = static_cast<size_t>(film->height);
    const float x_scale = static_cast<float>(width_) / static_cast<float>(width),
                y_scale = static_cast<float>(height_) / static_cast<float>(height);
    parallel_for(0, height, kRowGrain, [&](size_t begin, size_t end) {
        for (size_t row = begin; row < end; ++row) {
            for (size_t column = 0; column < width; ++column) {
                const size_t k = row * width + column;
                glm::vec3 radiance = guides.unfiltered[k];
                if (is_lit(guides, k)) {
                    const Place place{.x = (static_cast<float>(column) + 0.5f) * x_scale - 0.5f,
                                      .y = (static_cast<float>(row) + 0.5f) * y_scale - 0.5f,
                                      .normal = guides.normal[k],
                                      .depth = guides.depth[k],
                                      .slope_x = slope(guides, k, column, width, 1) / x_scale,
                                      .slope_y = slope(guides, k, row, height, width) / y_scale,
                                      .node = guides.node[k]};
                    radiance += divisor_of(guides.albedo[k]) * light_at(place);
                }
                const glm::vec3 sum = scale * radiance;
                film->sum[k] = glm::vec4(is_finite(sum) ? sum : glm::vec3(0.0f), film->sum[k].a);
            }
        }
    });
}

}  // namespace zoe
