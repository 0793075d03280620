#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace zoe {

/// A coarser form of an image, with texels as it.
struct ImageLevel {
    int width = 0, height = 0;
    std::vector<uint8_t> pixels;

    bool operator==(const ImageLevel&) const = default;
};

/// RGBA pixels as stored in the file, top row first. No pixels: missing.
struct Image {
    std::string name;
    bool is_color = true;  ///< Red, green and blue are sRGB where they are bytes, and averaged as light; else plain numbers.
    bool is_light = false;  ///< Shown as emission: red, green and blue may be above 1 where they are halves.
    bool is_half = false;   ///< A texel is four halves in [0, 65504], linear all of them; else four bytes.
    uint64_t replaced = 0;  ///< How many of the file's numbers were none that it can have.
    int halvings = 0;       ///< How often both sides were halved when it was loaded, to fit.
    int width = 0, height = 0;
    std::vector<uint8_t> pixels;      ///< [height * width * texel_bytes()]
    std::vector<ImageLevel> coarser;  ///< Each half as large as the one before (image_levels.h), or none.

    size_t texel_bytes() const { return is_half ? 8 : 4; }
    bool operator==(const Image&) const = default;
};

/// One layer channel of a picture to write: name ("R", "depth.Z", "node.id") and [height * width] values.
struct Channel {
    std::string name;
    std::span<const float> values;
    bool is_id = false;  ///< Written as a 32-bit unsigned integer (EXR); bit pattern of `values` reinterpreted.
};

/// What a picture's file says of it: names and texts, such as ("frame", "12").
using PictureNotes = std::vector<std::pair<std::string, std::string>>;

/// Writes an EXR file with named channels (32-bit float, or uint32 for ids): to a temporary name, then renamed.
/// Throws     std::runtime_error with the file's name and the reason; nothing is left behind.
void write_exr(const std::filesystem::path& file, int width, int height, std::span<const Channel> channels,
               const PictureNotes& notes = {});

/// Writes an 8-bit PNG, top row first: to a temporary name, then renamed.
/// rgba       [height * width * 4]
void write_png(const std::filesystem::path& file, int width, int height, std::span<const uint8_t> rgba,
               const PictureNotes& notes = {});

/// Reads any picture as 32-bit floats, channels by name.
struct FloatImage {
    int width = 0, height = 0;
    std::vector<std::string> channels;
    std::vector<float> values;  ///< [height * width * channels.size()]; unsigned integer channels as their value.
    bool is_encoded = false;    ///< Red, green and blue are sRGB, as of files with 8 or 16 bits; else light.
    PictureNotes notes;         ///< All texts of the file.
};
/// Throws     std::runtime_error with the file's name and the reason.
FloatImage read_picture(const std::filesystem::path& file);

}  // namespace zoe
