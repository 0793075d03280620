#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "apps/common/parse.h"
#include "engine/render/tone_map.h"

namespace zoe {

/// A picture as a screen shows it: 8-bit sRGB, opaque, top row first.
struct Picture {
    int width = 0, height = 0;
    std::vector<uint8_t> rgba;  ///< [height * width * 4]
};

/// Reads a picture that `write_film` wrote; an .exr is graded as its .png would be.
/// Throws     std::runtime_error with the file's name and the reason.
Picture load_picture(const std::filesystem::path& file, const Grade& grade = {});

/// The size that the first bytes of a .png or .exr file tell; none where they are not those of such a file.
std::optional<PictureSize> read_picture_size(const std::filesystem::path& file);

/// Shrinks by averaging so that the width is at most `max_width`; the shape stays.
Picture shrink(const Picture& picture, int max_width);

}  // namespace zoe
