#include "engine/render/film.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <glm/common.hpp>
#include <glm/vec3.hpp>

#include "engine/math/parallel.h"
#include "engine/render/layers.h"
#include "engine/scene/image.h"
#include "engine/scene/srgb.h"

namespace zoe {

namespace {

constexpr size_t kPixelGrain = 4096;

// Channels of a layer, taken apart.
template <typename Vector>
void add_planes(const std::vector<Vector>& values, const std::vector<std::string>& names,
                std::vector<std::vector<float>>* planes, std::vector<Channel>* channels) {
    for (size_t c = 0; c < names.size(); ++c) {
        std::vector<float>& plane = planes->emplace_back();
        plane.reserve(values.size());
        for (const Vector& value : values) plane.push_back(value[static_cast<int>(c)]);
        channels->push_back({.name = names[c], .values = plane});
    }
}

void add_ids(const std::vector<uint32_t>& ids, const std::string& name, std::vector<std::vector<float>>* planes,
             std::vector<Channel>* channels) {
    std::vector<float>& plane = planes->emplace_back();
    plane.reserve(ids.size());
    for (const uint32_t id : ids) plane.push_back(std::bit_cast<float>(id));
    channels->push_back({.name = name, .values = plane, .is_id = true});
}

void write_film_exr(const Film& film, const std::filesystem::path& file, const PictureOptions& options) {
    std::vector<glm::vec4> beauty = film.sum;
    std::vector<float> sample_counts(beauty.size());
    for (size_t i = 0; i < beauty.size(); ++i) {
        beauty[i] *= film.share_of(i);
        sample_counts[i] = static_cast<float>(film.samples_of(i));
    }
    std::vector<std::vector<float>> planes;
    planes.reserve(16);  // Channels look at what they hold.
    std::vector<Channel> channels;
    add_planes(beauty, {"R", "G", "B", "A"}, &planes, &channels);
    channels.push_back({.name = "depth.Z", .values = film.depth});
    add_ids(film.node, "node.id", &planes, &channels);
    add_ids(film.primitive, "primitive.id", &planes, &channels);
    channels.push_back({.name = "sampleCount", .values = sample_counts});
    if (const Layers* layers = options.layers) {
        assert(layers->width == film.width && layers->height == film.height);
        add_planes(layers->albedo, {"albedo.R", "albedo.G", "albedo.B"}, &planes, &channels);
        add_planes(layers->normal, {"normal.X", "normal.Y", "normal.Z"}, &planes, &channels);
        add_planes(layers->motion, {"backward.u", "backward.v"}, &planes, &channels);
    }
    assert(planes.size() <= planes.capacity());
    write_exr(file, film.width, film.height, channels, options.notes);
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
    enough.clear();
    std::fill(sum.begin(), sum.end(), glm::vec4(0.0f));
    std::fill(depth.begin(), depth.end(), std::numeric_limits<float>::infinity());
    std::fill(node.begin(), node.end(), 0xffffffffu);
    std::fill(primitive.begin(), primitive.end(), 0xffffffffu);
}

glm::vec4 Film::pixel(int x, int y) const {
    const size_t k = static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x);
    const uint32_t count = samples_of(k);
    return count > 0 ? sum[k] / static_cast<float>(count) : glm::vec4(0.0f);
}

std::vector<uint8_t> to_rgba8(const Film& film, const Grade& grade) {
    std::vector<uint8_t> rgba(film.sum.size() * 4);
    parallel_for(0, film.sum.size(), kPixelGrain, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
            const uint32_t count = film.samples_of(i);
            const float scale = count > 0 ? grade.exposure / static_cast<float>(count) : 0.0f;
            const glm::vec3 color = tone_map(grade.tone, glm::vec3(film.sum[i]) * scale);
            for (int c = 0; c < 3; ++c) rgba[4 * i + static_cast<size_t>(c)] = srgb_byte_from_linear(color[c]);
            rgba[4 * i + 3] = 255;  // The sky is part of the picture: coverage belongs to compositing, which reads the EXR.
        }
    });
    return rgba;
}

void write_film(const Film& film, const std::filesystem::path& file, const PictureOptions& options) {
    std::string extension = file.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(), [](unsigned char c) { return std::tolower(c); });
    if (extension == ".png") {
        write_png(file, film.width, film.height, to_rgba8(film, options.grade), options.notes);
    } else if (extension == ".exr") {
        write_film_exr(film, file, options);
    } else {
        throw std::runtime_error(file.string() + ": a picture's name must end in .png or .exr");
    }
}

}  // namespace zoe
