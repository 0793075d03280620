#include "engine/render/denoise.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include <glm/common.hpp>

#include "engine/math/aabb.h"
#include "engine/math/parallel.h"

namespace zoe {

namespace {

constexpr size_t kRowGrain = 4;
/// The least that light is divided by: what a dielectric reflects whatever its colour.
constexpr float kLeastAlbedo = 0.04f;
/// Brighter light counts as this bright, so that squares stay finite.
constexpr float kBrightest = 1e15f;
/// The sky's depth in sums that must stay finite.
constexpr float kFarthest = 1e30f;

glm::vec3 divisor(const glm::vec3& albedo) {
    return kLeastAlbedo + (1.0f - kLeastAlbedo) * albedo;
}

/// The smaller of the steps to both sides: at an edge, the one on this side of it.
float slope_between(float before, float here, float after) {
    return std::min(std::abs(here - before), std::abs(after - here));
}

}  // namespace

void Denoiser::Light::resize(size_t pixel_count) {
    for (std::vector<float>* plane : {&red, &green, &blue, &variance}) plane->resize(pixel_count);
}

void Denoiser::Shape::resize(size_t pixel_count) {
    for (std::vector<float>* plane : {&x, &y, &z, &depth, &slope}) plane->resize(pixel_count);
    node.resize(pixel_count);
}

void Denoiser::Moments::resize(size_t pixel_count) {
    for (std::vector<float>* plane : {&mean, &square, &frames}) plane->resize(pixel_count);
}

void Denoiser::resize(int width, int height) {
    if (width == width_ && height == height_) return;
    width_ = width;
    height_ = height;
    is_first_ = true;
    const size_t pixel_count = static_cast<size_t>(width) * static_cast<size_t>(height);
    for (Light* light : {&sample_, &light_, &smoothed_, &past_light_}) light->resize(pixel_count);
    for (Shape* shape : {&shape_, &past_shape_}) shape->resize(pixel_count);
    for (Moments* moments : {&moments_, &past_moments_, &near_}) moments->resize(pixel_count);
    known_.resize(pixel_count);
}

void Denoiser::filter(const Guides& guides, const DenoiseConfig& config, Film* film) {
    assert(film->sample_count > 0 && film->width == guides.width && film->height == guides.height);
    assert(config.most_frames >= 1 && config.rounds >= 1 && config.rounds <= 16);
    resize(film->width, film->height);
    const size_t rows = static_cast<size_t>(height_);
    take_in(*film, guides);
    parallel_for(0, rows, kRowGrain, [&](size_t begin, size_t end) { find_slopes(begin, end); });
    const size_t width = static_cast<size_t>(width_);
    parallel_for(0, rows, kRowGrain, [&](size_t begin, size_t end) {
        look_around(begin, end);
        for (size_t k = begin * width; k < end * width; ++k) follow(k, guides, config);
    });
    past_light_ = light_;  // What is smoothed would be smoothed again in every frame.
    for (int round = 0; round < config.rounds; ++round) {
        parallel_for(0, rows, kRowGrain, [&](size_t begin, size_t end) {
            static thread_local RowSums sums;
            for (size_t row = begin; row < end; ++row)
                smooth_row(row, size_t{1} << round, config.strength, light_, &smoothed_, &sums);
        });
        std::swap(light_, smoothed_);
    }
    put_out(guides, film);
    std::swap(shape_, past_shape_);
    std::swap(moments_, past_moments_);
    is_first_ = false;
}

void Denoiser::take_in(const Film& film, const Guides& guides) {
    const float scale = 1.0f / static_cast<float>(film.sample_count);
    const size_t row = static_cast<size_t>(width_);
    parallel_for(0, static_cast<size_t>(height_), kRowGrain, [&](size_t begin, size_t end) {
        for (size_t k = begin * row; k < end * row; ++k) {
            const bool is_surface = guides.node[k] != 0xffffffffu && std::isfinite(guides.depth[k]);
            const glm::vec3 light = (glm::vec3(film.sum[k]) * scale - guides.unfiltered[k]) / divisor(guides.albedo[k]);
            const bool is_known = is_surface && is_finite(light);
            known_[k] = is_known ? 1.0f : 0.0f;
            const glm::vec3 kept = is_known ? glm::clamp(light, 0.0f, kBrightest) : glm::vec3(0.0f);
            sample_.red[k] = kept.r;
            sample_.green[k] = kept.g;
            sample_.blue[k] = kept.b;
            const glm::vec3 normal = is_finite(guides.normal[k]) ? guides.normal[k] : glm::vec3(0.0f);
            shape_.x[k] = normal.x;
            shape_.y[k] = normal.y;
            shape_.z[k] = normal.z;
            shape_.depth[k] = is_surface ? std::clamp(guides.depth[k], -kFarthest, kFarthest) : kFarthest;
            shape_.node[k] = guides.node[k];
        }
    });
}

void Denoiser::find_slopes(size_t row_begin, size_t row_end) {
    const size_t width = static_cast<size_t>(width_), last_row = static_cast<size_t>(height_) - 1;
    const std::vector<float>& depth = shape_.depth;
    for (size_t y = row_begin; y < row_end; ++y) {
        for (size_t x = 0; x < width; ++x) {
            const size_t k = y * width + x;
            const float left = depth[x > 0 ? k - 1 : k], right = depth[x + 1 < width ? k + 1 : k];
            const float above = depth[y > 0 ? k - width : k], below = depth[y < last_row ? k + width : k];
            const float across = x > 0 && x + 1 < width ? slope_between(left, depth[k], right) : std::abs(right - left);
            const float down = y > 0 && y < last_row ? slope_between(above, depth[k], below) : std::abs(below - above);
            shape_.slope[k] = std::max(across, down);
        }
    }
}

void Denoiser::put_out(const Guides& guides, Film* film) const {
    const auto sample_count = static_cast<float>(film->sample_count);
    const size_t row = static_cast<size_t>(width_);
    parallel_for(0, static_cast<size_t>(height_), kRowGrain, [&](size_t begin, size_t end) {
        for (size_t k = begin * row; k < end * row; ++k) {
            glm::vec4& sum = film->sum[k];
            glm::vec3 result = glm::vec3(sum);  // What shows no surface has nothing to be smoothed by.
            if (guides.node[k] != 0xffffffffu) {
                const glm::vec3 light(light_.red[k], light_.green[k], light_.blue[k]);
                result = sample_count * (guides.unfiltered[k] + divisor(guides.albedo[k]) * light);
            }
            sum = glm::vec4(is_finite(result) ? result : glm::vec3(0.0f), sum.a);
        }
    });
}

}  // namespace zoe
