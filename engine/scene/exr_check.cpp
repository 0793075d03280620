#include "engine/scene/exr_check.h"

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <set>
#include <string_view>

#include <fmt/format.h>

namespace zoe {
namespace {

constexpr uint32_t kVersion = 2, kVersionBits = 0xff, kIsTiled = 0x200, kIsDeep = 0x800, kIsMultiPart = 0x1000;
constexpr uint32_t kUintChannel = 0;
constexpr size_t kMaxChannels = 16;
constexpr uint32_t kTileStep = 16, kMaxTile = 512;

constexpr const char* kDamaged = "an EXR whose header is damaged";

/// What OpenEXR reads of an attribute of a type, whatever size the file gives it: from another size on, it would see other
/// attributes than are checked here.
struct TypeSize {
    std::string_view type;
    size_t size;
};
constexpr TypeSize kTypeSizes[] = {
    {"compression", 1}, {"lineOrder", 1}, {"envmap", 1}, {"deepImageState", 1}, {"int", 4},      {"float", 4},
    {"double", 8},      {"v2i", 8},       {"v2f", 8},    {"rational", 8},       {"timecode", 8}, {"tiledesc", 9},
    {"v3i", 12},        {"v3f", 12},      {"box2i", 16}, {"box2f", 16},         {"v2d", 16},     {"v3d", 24},
    {"keycode", 28},    {"m33f", 36},     {"m44f", 64},  {"m33d", 72},          {"m44d", 128},   {"chromaticities", 32},
};

/// Reads a header from its begin; what is not there makes it fail.
class Cursor {
public:
    explicit Cursor(std::span<const std::byte> bytes) : bytes_(bytes) {}
    bool has_failed() const { return has_failed_; }
    size_t left() const { return bytes_.size(); }

    std::span<const std::byte> take(size_t count) {
        has_failed_ |= count > bytes_.size();
        if (has_failed_) return {};
        const std::span<const std::byte> taken = bytes_.first(count);
        bytes_ = bytes_.subspan(count);
        return taken;
    }
    /// Least byte first; 0 where it is not there.
    uint32_t word() {
        uint32_t value = 0;
        int shift = 0;
        for (const std::byte byte : take(4)) {
            value |= std::to_integer<uint32_t>(byte) << shift;
            shift += 8;
        }
        return value;
    }
    /// Up to a zero, which is passed.
    std::string_view text() {
        const auto* begin = reinterpret_cast<const char*>(bytes_.data());
        const size_t length = std::string_view(begin, bytes_.size()).find('\0');
        if (length == std::string_view::npos) {
            has_failed_ = true;
            return {};
        }
        take(length + 1);
        return {begin, length};
    }

private:
    std::span<const std::byte> bytes_;
    bool has_failed_ = false;
};

/// What the header says, each thing once.
class HeaderCheck {
public:
    HeaderCheck(size_t file_size, int max_side) : file_size_(file_size), max_side_(max_side) {}

    std::string check_attribute(std::string_view name, std::string_view type, Cursor value) {
        if (!names_.insert(name).second) return "an EXR that says something twice";
        const auto found = std::ranges::find(kTypeSizes, type, &TypeSize::type);
        if (found != std::end(kTypeSizes) && value.left() != found->size) return kDamaged;
        if (type == "floatvector" && value.left() % sizeof(float) != 0) return kDamaged;
        if (type == "preview") return check_preview(value);
        if (type == "chlist") return name == "channels" ? check_channels(value) : kDamaged;
        if (name == "dataWindow" && type == "box2i") return check_window(value);
        if (name == "tiles" && type == "tiledesc") return check_tiles(value);
        return {};
    }

    /// What must be there, and what only the whole tells.
    std::string check_whole(bool is_tiled) const {
        if (channel_count_ == 0 || width_ == 0) return "an EXR without channels or size";
        if (!is_tiled) return {};
        if (tile_width_ == 0) return "an EXR of tiles that does not say their size";
        const uint64_t tile_count = uint64_t{(width_ - 1) / tile_width_ + 1} * ((height_ - 1) / tile_height_ + 1);
        return tile_count > file_size_ / sizeof(uint64_t) ? "an EXR of more tiles than its bytes have room for" : "";
    }

private:
    std::string check_channels(Cursor value) {
        size_t count = 0;
        for (std::string_view name = value.text(); !name.empty(); name = value.text()) {
            const uint32_t type = value.word();
            value.word();  // Flags.
            const uint32_t x_step = value.word(), y_step = value.word();
            if (value.has_failed()) break;
            if (type == kUintChannel) return "an EXR with a channel of whole numbers";
            if (x_step != 1 || y_step != 1) return "an EXR with a channel of fewer pixels";
            if (++count > kMaxChannels) return fmt::format("an EXR of more than {} channels", kMaxChannels);
        }
        if (value.has_failed() || value.left() != 0) return kDamaged;
        channel_count_ = count;
        return {};
    }

    /// A small picture of four bytes a pixel, which is not looked at.
    static std::string check_preview(Cursor value) {
        const uint64_t width = value.word(), height = value.word();
        const bool is_whole = !value.has_failed() && value.left() % 4 == 0 && width * height == value.left() / 4;
        return is_whole ? "" : kDamaged;
    }

    std::string check_window(Cursor value) {
        int64_t ends[4];
        for (int64_t& end : ends) end = static_cast<int32_t>(value.word());
        const int64_t width = ends[2] - ends[0] + 1, height = ends[3] - ends[1] + 1;
        if (value.has_failed()) return kDamaged;
        if (width < 1 || height < 1 || width > max_side_ || height > max_side_) {
            return fmt::format("{} x {} pixels; {} a side are allowed", width, height, max_side_);
        }
        width_ = static_cast<uint32_t>(width);
        height_ = static_cast<uint32_t>(height);
        return {};
    }

    std::string check_tiles(Cursor value) {
        tile_width_ = value.word();
        tile_height_ = value.word();
        if (value.has_failed()) return kDamaged;
        for (const uint32_t side : {tile_width_, tile_height_}) {
            if (side == 0 || side % kTileStep != 0 || side > kMaxTile) {
                return fmt::format("an EXR of tiles of {} x {} pixels; multiples of {} up to {} are read", tile_width_,
                                   tile_height_, kTileStep, kMaxTile);
            }
        }
        return {};
    }

    size_t file_size_;
    std::set<std::string_view> names_;
    int max_side_;
    size_t channel_count_ = 0;
    uint32_t width_ = 0, height_ = 0, tile_width_ = 0, tile_height_ = 0;
};

}  // namespace

std::string check_exr(std::span<const std::byte> bytes, int max_side) {
    Cursor cursor(bytes);
    cursor.word();  // The signature.
    const uint32_t version = cursor.word();
    if ((version & kVersionBits) != kVersion) return "an EXR of another version than 2";
    if ((version & kIsMultiPart) != 0) return "an EXR of several parts";
    if ((version & kIsDeep) != 0) return "a deep EXR";
    HeaderCheck check(bytes.size(), max_side);
    for (std::string_view name = cursor.text(); !name.empty(); name = cursor.text()) {
        const std::string_view type = cursor.text();
        const Cursor value(cursor.take(cursor.word()));
        if (cursor.has_failed()) break;
        if (std::string broken = check.check_attribute(name, type, value); !broken.empty()) return broken;
    }
    if (cursor.has_failed()) return kDamaged;
    return check.check_whole((version & kIsTiled) != 0);
}

}  // namespace zoe
