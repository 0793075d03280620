#include "engine/render/film.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <glm/common.hpp>
#include <glm/vec3.hpp>

#include "engine/scene/image.h"
#include "engine/scene/srgb.h"

namespace zoe {

namespace {

constexpr float kShoulder = 0.8f;  // brightness up to which the picture is linear

/// Maps brightness [0, inf) to [0, 1): linear up to the shoulder, then an exponential that continues its slope.
/// What is compressed also loses saturation, so that a bright coloured light goes towards white and keeps its shape.
glm::vec3 tone_map(const glm::vec3& color) {
    const float brightest = std::max({color.x, color.y, color.z});
    if (!(brightest > kShoulder)) return color;
    if (!std::isfinite(brightest)) return glm::vec3(1.0f);
    const float room = 1.0f - kShoulder;
    const float mapped = kShoulder + room * (1.0f - std::exp((kShoulder - brightest) / room));
    const float excess = 0.25f * (brightest - mapped);
    return glm::mix(color * (mapped / brightest), glm::vec3(mapped), excess / (1.0f + excess));
}

void write_film_exr(const Film& film, const std::filesystem::path& file) {
    const size_t pixel_count = film.sum.size();
    std::vector<float> planes(6 * pixel_count);
    float* const plane[6] = {planes.data(),
                             planes.data() + pixel_count,
                             planes.data() + 2 * pixel_count,
                             planes.data() + 3 * pixel_count,
                             planes.data() + 4 * pixel_count,
                             planes.data() + 5 * pixel_count};
    const float scale = film.sample_count > 0 ? 1.0f / static_cast<float>(film.sample_count) : 0.0f;
    for (size_t i = 0; i < pixel_count; ++i) {
        for (int c = 0; c < 4; ++c) plane[c][i] = film.sum[i][c] * scale;
        plane[4][i] = std::bit_cast<float>(film.node[i]);
        plane[5][i] = std::bit_cast<float>(film.primitive[i]);
    }
    const Channel channels[] = {
        {.name = "R", .values = {plane[0], pixel_count}},
        {.name = "G", .values = {plane[1], pixel_count}},
        {.name = "B", .values = {plane[2], pixel_count}},
        {.name = "A", .values = {plane[3], pixel_count}},
        {.name = "depth.Z", .values = film.depth},
        {.name = "node.id", .values = {plane[4], pixel_count}, .is_id = true},
        {.name = "primitive.id", .values = {plane[5], pixel_count}, .is_id = true},
    };
    write_exr(file, film.width, film.height, channels);
}

}  // namespace

Film::Film(int width, int height) : width(width), height(height) {
    assert(width > 0 && height > 0);
    const size_t pixel_count = static_cast<size_t>(width) * static_cast<size_t>(height);
    sum.resize(pixel_count);
    depth.resize(pixel_count);
    node.resize(pixel_count);
    primitive.resize(pixel_count);
    clear();
}

void Film::clear() {
    sample_count = 0;
    std::fill(sum.begin(), sum.end(), glm::vec4(0.0f));
    std::fill(depth.begin(), depth.end(), std::numeric_limits<float>::infinity());
    std::fill(node.begin(), node.end(), 0xffffffffu);
    std::fill(primitive.begin(), primitive.end(), 0xffffffffu);
}

glm::vec4 Film::pixel(int x, int y) const {
    const glm::vec4& total = sum[static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x)];
    return sample_count > 0 ? total / static_cast<float>(sample_count) : glm::vec4(0.0f);
}

std::vector<uint8_t> to_rgba8(const Film& film, float exposure) {
    std::vector<uint8_t> rgba(film.sum.size() * 4);
    const float scale = film.sample_count > 0 ? exposure / static_cast<float>(film.sample_count) : 0.0f;
    for (size_t i = 0; i < film.sum.size(); ++i) {
        const glm::vec3 color = tone_map(glm::vec3(film.sum[i]) * scale);
        for (int c = 0; c < 3; ++c) rgba[4 * i + static_cast<size_t>(c)] = srgb_byte_from_linear(color[c]);
        rgba[4 * i + 3] = 255;  // The sky is part of the picture: coverage belongs to compositing, which reads the EXR.
    }
    return rgba;
}

void write_film(const Film& film, const std::filesystem::path& file, float exposure) {
    std::string extension = file.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(), [](unsigned char c) { return std::tolower(c); });
    if (extension == ".png") {
        write_png(file, film.width, film.height, to_rgba8(film, exposure));
    } else if (extension == ".exr") {
        write_film_exr(film, file);
    } else {
        throw std::runtime_error(file.string() + ": a picture's name must end in .png or .exr");
    }
}

}  // namespace zoe
