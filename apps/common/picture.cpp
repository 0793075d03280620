#include "apps/common/picture.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "engine/render/film.h"
#include "engine/scene/image.h"

namespace zoe {

Picture load_picture(const std::filesystem::path& file) {
    const FloatImage image = read_picture(file);
    const size_t channel_count = image.channels.size();
    size_t rgb[3];
    const char* const names[3] = {"R", "G", "B"};
    for (int c = 0; c < 3; ++c) {
        const auto found = std::find(image.channels.begin(), image.channels.end(), names[c]);
        if (found == image.channels.end())
            throw std::runtime_error(fmt::format("{}: has no channel {}", file.native(), names[c]));
        rgb[c] = static_cast<size_t>(found - image.channels.begin());
    }

    const size_t pixel_count = static_cast<size_t>(image.width) * image.height;
    Picture picture{image.width, image.height, {}};
    if (file.extension() == ".exr") {
        Film film(image.width, image.height);
        film.sample_count = 1;
        for (size_t i = 0; i < pixel_count; ++i) {
            const float* const p = &image.values[i * channel_count];
            film.sum[i] = {p[rgb[0]], p[rgb[1]], p[rgb[2]], 1.0f};
        }
        picture.rgba = to_rgba8(film);
    } else {
        picture.rgba.resize(4 * pixel_count);
        for (size_t i = 0; i < pixel_count; ++i) {
            for (int c = 0; c < 3; ++c) {
                const float value = std::clamp(image.values[i * channel_count + rgb[c]], 0.0f, 1.0f);
                picture.rgba[4 * i + c] = static_cast<uint8_t>(std::lround(255.0f * value));
            }
        }
    }
    for (size_t i = 0; i < pixel_count; ++i) picture.rgba[4 * i + 3] = 255;
    return picture;
}

Picture shrink(const Picture& picture, int max_width) {
    if (picture.width <= max_width) return picture;
    const int width = max_width;
    const int height = std::max(1, static_cast<int>(std::lround(double(picture.height) * width / picture.width)));
    Picture small{width, height, std::vector<uint8_t>(size_t{4} * width * height)};
    // Each pixel is the mean of the pixels whose first corner falls into it.
    const auto edge = [](int i, int to, int from) { return static_cast<int>(int64_t{i} * from / to); };
    for (int y = 0; y < height; ++y) {
        const int y_begin = edge(y, height, picture.height),
                  y_end = std::max(y_begin + 1, edge(y + 1, height, picture.height));
        for (int x = 0; x < width; ++x) {
            const int x_begin = edge(x, width, picture.width), x_end = edge(x + 1, width, picture.width);
            uint64_t sum[4] = {};
            for (int sy = y_begin; sy < y_end; ++sy) {
                const uint8_t* const row = &picture.rgba[4 * (size_t{1} * sy * picture.width)];
                for (int sx = x_begin; sx < x_end; ++sx) {
                    for (int c = 0; c < 4; ++c) sum[c] += row[4 * sx + c];
                }
            }
            const uint64_t count = uint64_t(y_end - y_begin) * uint64_t(x_end - x_begin);
            for (int c = 0; c < 4; ++c) {
                small.rgba[4 * (size_t{1} * y * width + x) + c] = static_cast<uint8_t>((sum[c] + count / 2) / count);
            }
        }
    }
    return small;
}

}  // namespace zoe
