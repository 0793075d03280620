#include "engine/scene/decode_image.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <memory>
#include <string_view>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include "engine/scene/error.h"
#include "engine/scene/exr_check.h"
#include "engine/scene/half.h"
#include "engine/scene/image_levels.h"
#include "engine/scene/jpeg_strip.h"
#include "engine/scene/png_check.h"

namespace zoe {
namespace {

constexpr int kMaxSide = 16384;
constexpr int kMaxOffset = 1 << 30;  // of the picture on its page: OpenImageIO adds rows to it
constexpr int kRowsAtOnce = 64;

/// OpenImageIO's name of the format, told by the first bytes. (Asked by a file name, it looks for the file.) Of those that
/// are read here: its readers of others take as much memory as a few bytes of the file ask for, before anyone is told.
std::string_view format_of(std::span<const std::byte> bytes) {
    const auto begins = [&](std::string_view magic, size_t at = 0) {
        return bytes.size() >= at + magic.size() && std::memcmp(bytes.data() + at, magic.data(), magic.size()) == 0;
    };
    if (begins("\x89PNG")) return "png";
    if (begins("\xff\xd8\xff")) return "jpeg";
    if (begins("RIFF") && begins("WEBP", 8)) return "webp";
    if (begins("\x76\x2f\x31\x01")) return "openexr";
    if (begins("#?RADIANCE") || begins("#?RGBE")) return "hdr";
    return {};
}

/// Where red, green, blue and alpha are among a picture's channels; -1: nowhere.
using Places = std::array<int, 4>;

/// By their order.
Places find_channels(int channel_count) {
    switch (channel_count) {
        case 1:
            return {0, 0, 0, -1};
        case 2:
            return {0, 0, 0, 1};
        case 3:
            return {0, 1, 2, -1};
        default:
            return {0, 1, 2, 3};
    }
}

/// By their names.
/// Throws     std::runtime_error where there are neither all three colours nor one grey.
Places find_channels(const OIIO::ImageSpec& spec) {
    const auto place = [&](const char* name) { return spec.channelindex(name); };
    const int red = place("R"), green = place("G"), blue = place("B"), alpha = place("A");
    if (red >= 0 && green >= 0 && blue >= 0) return {red, green, blue, alpha};
    const bool has_chroma = place("RY") >= 0 || place("BY") >= 0;
    const int grey = std::max(red, place("Y"));
    if (grey < 0 || green >= 0 || blue >= 0 || has_chroma) {
        throw std::runtime_error("an EXR whose channels are neither R, G and B nor one of R and Y");
    }
    return {grey, grey, grey, alpha};
}

/// Numbers that halves of an image do not have become the nearest; what is no number becomes 0.
/// most       of halves in [0, infinity), which are in the order of their bits.
uint64_t replace_halves(std::span<uint16_t> pixels, size_t channel_count, size_t channel, uint16_t most) {
    constexpr uint16_t kSign = 0x8000;
    uint64_t replaced = 0;
    for (size_t i = channel; i < pixels.size(); i += channel_count) {
        uint16_t& half = pixels[i];
        if (half <= most) continue;
        if (half != kSign) ++replaced;
        half = half > kHalfInfinity ? uint16_t{0} : most;
    }
    return replaced;
}

/// A picture that is open.
struct Picture {
    OIIO::ImageInput& in;
    const OIIO::ImageSpec& spec;
    Places places;

    /// Of the channels that are read: the first, up to the last of those that are shown.
    size_t channel_count() const { return static_cast<size_t>(*std::max_element(places.begin(), places.end())) + 1; }

    /// Adds the rows [begin, end) to pixels, as they are in the file but for missing channels.
    /// Returns    false where they cannot be read.
    template <typename T>
    bool read(int begin, int end, OIIO::TypeDesc type, T opaque, Image* image, std::vector<uint8_t>* pixels) const {
        const size_t from_count = channel_count();
        const size_t pixel_count = static_cast<size_t>(spec.width) * static_cast<size_t>(end - begin);
        std::vector<T> from(pixel_count * from_count);
        const int y = spec.y + begin, y_end = spec.y + end, channel_end = static_cast<int>(from_count);
        const bool is_read = spec.tile_width > 0
                                 ? in.read_tiles(0, 0, spec.x, spec.x + spec.width, y, y_end, spec.z, spec.z + 1, 0,
                                                 channel_end, type, from.data())
                                 : in.read_scanlines(0, 0, y, y_end, spec.z, 0, channel_end, type, from.data());
        if (!is_read) return false;
        if constexpr (sizeof(T) == sizeof(uint16_t)) {
            for (size_t c = 0; c < from_count; ++c) {
                const bool is_alpha = places[3] == static_cast<int>(c);
                const uint16_t most = image->is_light && !is_alpha ? kHalfLargest : kHalfOne;
                image->replaced += replace_halves(from, from_count, c, most);
            }
        }
        using Texel = std::array<T, 4>;
        size_t at = pixels->size();
        pixels->resize(at + pixel_count * sizeof(Texel));
        for (size_t i = 0; i < from.size(); i += from_count, at += sizeof(Texel)) {
            Texel texel;
            for (size_t c = 0; c < 4; ++c) texel[c] = places[c] < 0 ? opaque : from[i + static_cast<size_t>(places[c])];
            std::memcpy(&(*pixels)[at], &texel, sizeof texel);
        }
        return true;
    }

    /// Reads bands of rows, and halves each.
    /// choose_halvings  asked once some rows were read.
    /// Returns    false where they cannot be read.
    template <typename ChooseHalvings>
    bool read_all(const ChooseHalvings& choose_halvings, Image* image) const {
        int halvings = 0;
        const int step = std::max(spec.tile_height, 1), band = (kRowsAtOnce + step - 1) / step * step;
        for (int y = 0; y < spec.height; y += band) {
            const int end = std::min(spec.height, y + band);
            ImageLevel level{spec.width, end - y, {}};
            std::vector<uint8_t>* const pixels = y == 0 || halvings > 0 ? &level.pixels : &image->pixels;
            const bool is_read = image->is_half ? read(y, end, OIIO::TypeDesc::HALF, kHalfOne, image, pixels)
                                                : read(y, end, OIIO::TypeDesc::UINT8, uint8_t{255}, image, pixels);
            if (!is_read) return false;
            if (y == 0) halvings = choose_halvings();
            for (int i = 0; i < halvings; ++i) level = halved(level, image->is_color, image->is_half);
            image->pixels.insert(image->pixels.end(), level.pixels.begin(), level.pixels.end());
        }
        return true;
    }
};

/// Throws     std::runtime_error with the reason.
void decode(std::span<const std::byte> encoded, std::string_view format, uint64_t max_pixels, const ChooseHalvings& choose,
            Image* image) {
    const auto fail = [](const std::string& reason) {
        throw std::runtime_error(reason.empty() ? "it cannot be decoded" : reason);
    };
    OIIO::Filesystem::IOMemReader memory(const_cast<std::byte*>(encoded.data()), encoded.size());
    OIIO::ImageSpec config;
    config.attribute("oiio:UnassociatedAlpha", 1);  // As stored: not multiplied by alpha.
    OIIO::Filesystem::IOProxy* proxy = &memory;
    config.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy);
    const std::unique_ptr<OIIO::ImageInput> in = OIIO::ImageInput::create(std::string(format));
    if (!in) fail(OIIO::geterror());
    if (!in->supports("ioproxy")) fail("pictures of this format are not read from memory");
    OIIO::ImageSpec spec;
    if (!in->open(std::string(format), spec, config)) fail(in->geterror());
    if (spec.width <= 0 || spec.height <= 0 || spec.width > kMaxSide || spec.height > kMaxSide) {
        fail(fmt::format("{} x {} pixels; {} a side are allowed", spec.width, spec.height, kMaxSide));
    }
    if (spec.nchannels < 1 || spec.nchannels > 16 || spec.depth > 1) {
        fail(fmt::format("{} channels, {} layers of depth; 1 to 16, and 1, are read", spec.nchannels, spec.depth));
    }
    for (const int offset : {spec.x, spec.y}) {
        if (offset < -kMaxOffset || offset > kMaxOffset) fail(fmt::format("{} pixels from its page's corner", offset));
    }
    const bool is_exr = format == "openexr";
    if (is_exr && (spec.x != spec.full_x || spec.y != spec.full_y || spec.width != spec.full_width ||
                   spec.height != spec.full_height)) {
        fail("an EXR that holds another window than it shows");
    }
    if (spec.get_int_attribute("Orientation", 1) != 1 && format == "hdr") fail("an HDR picture that is turned or mirrored");
    const Picture picture{*in, spec, is_exr ? find_channels(spec) : find_channels(spec.nchannels)};

    image->is_half = is_exr || format == "hdr";
    const uint64_t worth = image->is_half ? 2 : 1;
    int halvings = 0;
    const auto side = [&](int size) { return static_cast<uint64_t>(((size - 1) >> halvings) + 1); };
    while (side(spec.width) * side(spec.height) * worth > max_pixels) {
        if (++halvings > kMaxHalvings) {
            fail(fmt::format("{} x {} pixels{}, where images may have {} together", spec.width, spec.height,
                             image->is_half ? ", each counting twice" : "", max_pixels));
        }
    }
    image->width = spec.width;
    image->height = spec.height;
    const auto choose_halvings = [&] {
        if (in->has_error()) fail(in->geterror());
        if (choose) halvings = std::max(halvings, std::min(choose(*image), kMaxHalvings));
        image->pixels.reserve(side(spec.width) * side(spec.height) * image->texel_bytes());
        return halvings;
    };
    // A truncated JPEG reads "well", with an error set.
    if (!picture.read_all(choose_halvings, image) || in->has_error()) fail(in->geterror());
    image->width = static_cast<int>(side(spec.width));
    image->height = static_cast<int>(side(spec.height));
    image->halvings = halvings;
}

}  // namespace

bool decode_image(std::span<const std::byte> encoded, Image* image, std::string* error, uint64_t max_pixels,
                  const ChooseHalvings& choose) {
    const auto empty = [&] {
        image->width = image->height = image->halvings = 0;
        image->replaced = 0;
        image->is_half = false;
        image->pixels = {};
        image->coarser.clear();
    };
    empty();
    try {
        const std::string_view format = format_of(encoded);
        if (format.empty()) throw std::runtime_error("not a picture of a known format");
        if (format == "png" && !is_whole_png(encoded)) throw std::runtime_error("a truncated or damaged PNG");
        if (format == "openexr") {
            if (const std::string broken = check_exr(encoded, kMaxSide); !broken.empty()) throw std::runtime_error(broken);
        }
        std::vector<std::byte> stripped;
        if (format == "jpeg") {
            stripped = without_metadata(encoded);
            encoded = stripped;
        }
        decode(encoded, format, max_pixels, choose, image);
        return true;
    } catch (const std::exception& exception) {
        empty();
        *error = plain_line(exception.what());
        while (!error->empty() && error->back() == ' ') error->pop_back();
        return false;
    }
}

}  // namespace zoe
