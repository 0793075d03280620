#include "apps/common/picture.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <stdexcept>
#include <string_view>

#include <fmt/format.h>

#include "engine/render/film.h"
#include "engine/scene/image.h"

namespace zoe {

Picture load_picture(const std::filesystem::path& file, const Grade& grade) {
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
        picture.rgba = to_rgba8(film, grade);
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

std::optional<PictureSize> read_picture_size(const std::filesystem::path& file) {
    char bytes[4096];
    std::ifstream stream(file, std::ios::binary);
    stream.read(bytes, sizeof bytes);
    const std::string_view head(bytes, static_cast<size_t>(stream.gcount()));
    const auto byte = [&](size_t at) { return uint32_t{static_cast<uint8_t>(head[at])}; };
    if (head.starts_with("\x89PNG\r\n\x1a\n") && head.size() >= 24) {  // IHDR comes first: width, height
        const auto big_endian = [&](size_t at) {
            return static_cast<int>(byte(at) << 24 | byte(at + 1) << 16 | byte(at + 2) << 8 | byte(at + 3));
        };
        return PictureSize{big_endian(16), big_endian(20)};
    }
    constexpr std::string_view kWindow("dataWindow\0box2i\0\x10\0\0\0", 21);  // then the corners' x, y, both included
    const size_t window = head.starts_with("\x76\x2f\x31\x01") ? head.find(kWindow) : std::string_view::npos;
    if (window == std::string_view::npos || window + kWindow.size() + 16 > head.size()) return std::nullopt;
    const auto little_endian = [&](size_t i) {
        const size_t at = window + kWindow.size() + 4 * i;
        return int64_t{static_cast<int32_t>(byte(at + 3) << 24 | byte(at + 2) << 16 | byte(at + 1) << 8 | byte(at))};
    };
    return PictureSize{static_cast<int>(little_endian(2) - little_endian(0) + 1),
                       static_cast<int>(little_endian(3) - little_endian(1) + 1)};
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
