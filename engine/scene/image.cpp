#include "engine/scene/image.h"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <memory>
#include <stdexcept>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include "engine/scene/error.h"
#include "engine/scene/image_levels.h"
#include "engine/scene/jpeg_strip.h"
#include "engine/scene/png_check.h"

namespace zoe {
namespace {

namespace fs = std::filesystem;

constexpr int kMaxSide = 16384;
constexpr uint64_t kMaxPictureValues = uint64_t{1} << 28;  // numbers of a picture of floats: 1 GiB

/// OpenImageIO's name of the format, told by the first bytes. (Asked by a file name, it looks for the file.) Those that
/// glTF's pictures have: its readers of others take as much memory as a few bytes of the file ask for, before anyone is
/// told.
const char* format_of(std::span<const std::byte> bytes) {
    const auto begins = [&](std::string_view magic, size_t at = 0) {
        return bytes.size() >= at + magic.size() && std::memcmp(bytes.data() + at, magic.data(), magic.size()) == 0;
    };
    if (begins("\x89PNG")) return "png";
    if (begins("\xff\xd8\xff")) return "jpeg";
    if (begins("RIFF") && begins("WEBP", 8)) return "webp";
    return nullptr;
}

std::string one_line(const std::string& text) {
    std::string line = plain_line(text);
    while (!line.empty() && line.back() == ' ') line.pop_back();
    return line;
}

/// Repeats grey, and adds opaque alpha, where pixels have less than 4 channels.
std::vector<uint8_t> to_rgba(const std::vector<uint8_t>& from, size_t pixel_count, size_t channel_count) {
    std::vector<uint8_t> rgba(pixel_count * 4, 255);
    const bool is_grey = channel_count < 3;
    for (size_t i = 0; i < pixel_count; ++i) {
        const uint8_t* p = &from[i * channel_count];
        for (size_t c = 0; c < 3; ++c) rgba[4 * i + c] = p[is_grey ? 0 : c];
        if (channel_count == 2 || channel_count >= 4) rgba[4 * i + 3] = p[is_grey ? 1 : 3];
    }
    return rgba;
}

/// Reads pixels into the image: as they are, or bands of rows at a time, of which each becomes one row.
/// Returns    false where they cannot be read.
bool read_rows(OIIO::ImageInput& in, const OIIO::ImageSpec& spec, int halvings, Image* image) {
    const int channel_count = std::min(spec.nchannels, 4);
    const int band = halvings > 0 ? 1 << halvings : spec.height;
    const size_t row_pixels = static_cast<size_t>(spec.width);
    std::vector<uint8_t> rows;
    for (int y = 0; y < spec.height; y += band) {
        const int end = std::min(spec.height, y + band);
        const size_t pixel_count = row_pixels * static_cast<size_t>(end - y);
        rows.resize(pixel_count * static_cast<size_t>(channel_count));
        const bool is_read = halvings > 0
                                 ? in.read_scanlines(0, 0, y, end, 0, 0, channel_count, OIIO::TypeDesc::UINT8, rows.data())
                                 : in.read_image(0, 0, 0, channel_count, OIIO::TypeDesc::UINT8, rows.data());
        if (!is_read) return false;
        ImageLevel level{spec.width, end - y, {}};
        level.pixels = channel_count == 4 ? std::move(rows) : to_rgba(rows, pixel_count, static_cast<size_t>(channel_count));
        for (int i = 0; i < halvings; ++i) level = halved(level.width, level.height, level.pixels, image->is_color);
        if (halvings == 0) {
            image->pixels = std::move(level.pixels);
        } else {
            image->pixels.insert(image->pixels.end(), level.pixels.begin(), level.pixels.end());
        }
    }
    return true;
}

/// The picture's name while it is being written; removed unless it was renamed.
class TemporaryFile {
public:
    explicit TemporaryFile(const fs::path& target) : target_(target) {
        static std::atomic<uint64_t> counter{0};
        path_ = target;
        path_.replace_filename(
            fmt::format(".{}.{}.{}.tmp{}", target.stem().string(), ::getpid(), counter++, target.extension().string()));
    }
    ~TemporaryFile() {
        std::error_code ignored;
        if (!is_renamed_) fs::remove(path_, ignored);
    }
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;

    std::string path() const { return path_.string(); }
    void rename_to_target() {
        std::error_code error;
        fs::rename(path_, target_, error);
        if (error) throw std::runtime_error(target_.string() + ": " + error.message());
        is_renamed_ = true;
    }

private:
    fs::path target_, path_;
    bool is_renamed_ = false;
};

/// Writes packed pixels in the spec's own formats. OpenImageIO encodes into memory only: where a file ends early, it does
/// not say so of a PNG, and ends the program over an EXR.
void write_pixels(const fs::path& file, OIIO::ImageSpec spec, const char* format, const void* pixels) {
    const auto fail = [&](const std::string& reason) { throw std::runtime_error(file.string() + ": " + one_line(reason)); };
    if (fs::is_directory(file)) fail("it is a directory");
    OIIO::Filesystem::IOVecOutput memory;
    OIIO::Filesystem::IOProxy* proxy = &memory;
    spec.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy);
    const std::unique_ptr<OIIO::ImageOutput> out = OIIO::ImageOutput::create(format);
    if (!out) fail(OIIO::geterror());
    if (!out->open(format, spec)) fail(out->geterror());
    const OIIO::TypeDesc native = spec.channelformats.empty() ? spec.format : OIIO::TypeDesc(OIIO::TypeDesc::UNKNOWN);
    if (!out->write_image(native, pixels) || !out->close()) {
        const std::string reason = out->geterror();
        fail(reason.empty() ? "it cannot be encoded" : reason);
    }
    TemporaryFile temporary(file);
    errno = 0;
    std::ofstream stream(temporary.path(), std::ios::binary);
    const std::vector<unsigned char>& bytes = memory.buffer();
    stream.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    stream.close();
    if (!stream) fail(errno != 0 ? std::strerror(errno) : "it cannot be written");
    temporary.rename_to_target();
}

}  // namespace

bool decode_image(std::span<const std::byte> encoded, Image* image, std::string* error, uint64_t max_pixels) {
    const auto fail = [&](const std::string& reason) {
        *error = one_line(reason);
        return false;
    };
    image->width = image->height = image->halvings = 0;
    image->pixels.clear();
    image->coarser.clear();
    const char* format = format_of(encoded);
    if (format == nullptr) return fail("not a picture of a known format");
    if (std::string_view(format) == "png" && !is_whole_png(encoded)) return fail("a truncated or damaged PNG");
    std::vector<std::byte> stripped;
    if (std::string_view(format) == "jpeg") {
        stripped = without_metadata(encoded);
        encoded = stripped;
    }
    try {
        OIIO::Filesystem::IOMemReader memory(const_cast<std::byte*>(encoded.data()), encoded.size());
        OIIO::ImageSpec config;
        config.attribute("oiio:UnassociatedAlpha", 1);  // As stored: not multiplied by alpha.
        OIIO::Filesystem::IOProxy* proxy = &memory;
        config.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy);
        const std::unique_ptr<OIIO::ImageInput> in = OIIO::ImageInput::create(format);
        if (!in) return fail(OIIO::geterror());
        if (!in->supports("ioproxy")) return fail("pictures of this format are not read from memory");
        OIIO::ImageSpec spec;
        if (!in->open(format, spec, config)) {
            const std::string reason = in->geterror();
            return fail(reason.empty() ? "it cannot be decoded" : reason);
        }
        if (spec.width <= 0 || spec.height <= 0 || spec.width > kMaxSide || spec.height > kMaxSide) {
            return fail(fmt::format("{} x {} pixels; {} a side are allowed", spec.width, spec.height, kMaxSide));
        }
        if (spec.nchannels < 1 || spec.nchannels > 16 || spec.depth > 1) return fail("not an image of 1 to 16 channels");
        int halvings = 0;
        const auto side = [&](int size) { return static_cast<uint64_t>(((size - 1) >> halvings) + 1); };
        while (side(spec.width) * side(spec.height) > max_pixels) {
            if (++halvings > kMaxHalvings) {
                return fail(
                    fmt::format("{} x {} pixels, where {} are left for images", spec.width, spec.height, max_pixels));
            }
        }
        const bool is_read = read_rows(*in, spec, halvings, image);
        // A truncated JPEG reads "well", with an error set.
        if (!is_read || in->has_error()) {
            const std::string reason = in->geterror();
            image->pixels.clear();
            return fail(reason.empty() ? "it cannot be decoded" : reason);
        }
        image->width = static_cast<int>(side(spec.width));
        image->height = static_cast<int>(side(spec.height));
        image->halvings = halvings;
        return true;
    } catch (const std::exception& exception) {
        image->pixels.clear();
        return fail(exception.what());
    }
}

void write_exr(const fs::path& file, int width, int height, std::span<const Channel> channels, const PictureNotes& notes) {
    if (width <= 0 || height <= 0 || channels.empty())
        throw std::runtime_error(file.string() + ": a picture without pixels");
    const size_t pixel_count = static_cast<size_t>(width) * static_cast<size_t>(height);
    OIIO::ImageSpec spec(width, height, static_cast<int>(channels.size()), OIIO::TypeDesc::FLOAT);
    spec.channelnames.clear();
    spec.channelformats.clear();
    for (const Channel& channel : channels) {
        if (channel.values.size() != pixel_count) {
            throw std::runtime_error(fmt::format("{}: channel {} has {} values for {} pixels", file.string(), channel.name,
                                                 channel.values.size(), pixel_count));
        }
        spec.channelnames.push_back(channel.name);
        spec.channelformats.push_back(channel.is_id ? OIIO::TypeDesc::UINT32 : OIIO::TypeDesc::FLOAT);
    }
    spec.attribute("compression", "zip");
    spec.attribute("DateTime", "0000:00:00 00:00:00");  // Unknown. Unless told, the time of writing: no two files the same.
    for (const auto& [name, text] : notes) spec.attribute(name, text);
    // Every channel has 4 bytes: pixels interleave as words, whatever the bits mean.
    std::vector<uint32_t> words(pixel_count * channels.size());
    for (size_t c = 0; c < channels.size(); ++c) {
        for (size_t i = 0; i < pixel_count; ++i) {
            std::memcpy(&words[i * channels.size() + c], &channels[c].values[i], sizeof(uint32_t));
        }
    }
    write_pixels(file, spec, "exr", words.data());
}

void write_png(const fs::path& file, int width, int height, std::span<const uint8_t> rgba, const PictureNotes& notes) {
    if (width <= 0 || height <= 0 || rgba.size() != size_t{4} * static_cast<size_t>(width) * static_cast<size_t>(height)) {
        throw std::runtime_error(file.string() + ": the pixels are not 4 * width * height");
    }
    OIIO::ImageSpec spec(width, height, 4, OIIO::TypeDesc::UINT8);
    spec.attribute("oiio:UnassociatedAlpha", 1);
    spec.attribute("oiio:ColorSpace", "sRGB");
    for (const auto& [name, text] : notes) spec.attribute(name, text);
    write_pixels(file, spec, "png", rgba.data());
}

FloatImage read_picture(const fs::path& file) {
    const auto fail = [&](const std::string& reason) { throw std::runtime_error(file.string() + ": " + one_line(reason)); };
    OIIO::ImageSpec config;
    config.attribute("oiio:UnassociatedAlpha", 1);
    if (!fs::is_regular_file(file)) fail("there is no such file");
    const std::unique_ptr<OIIO::ImageInput> in = OIIO::ImageInput::open(file.string(), &config);
    if (!in) fail(OIIO::geterror());
    const OIIO::ImageSpec spec = in->spec();
    const bool has_sides = spec.width > 0 && spec.height > 0 && spec.width <= 4 * kMaxSide && spec.height <= 4 * kMaxSide;
    if (!has_sides || spec.nchannels < 1 || spec.nchannels > 1024 ||
        static_cast<uint64_t>(spec.width) * static_cast<uint64_t>(spec.height) >
            kMaxPictureValues / static_cast<uint64_t>(spec.nchannels)) {
        fail(fmt::format("{} x {} pixels of {} channels", spec.width, spec.height, spec.nchannels));
    }
    FloatImage image;
    image.width = spec.width;
    image.height = spec.height;
    image.channels = spec.channelnames;
    image.is_encoded = spec.format == OIIO::TypeDesc::UINT8 || spec.format == OIIO::TypeDesc::UINT16;
    for (const OIIO::ParamValue& note : spec.extra_attribs) {
        if (note.type() == OIIO::TypeDesc::STRING) image.notes.emplace_back(note.name().string(), note.get_string());
    }
    const size_t channel_count = static_cast<size_t>(spec.nchannels);
    const size_t pixel_count = static_cast<size_t>(spec.width) * static_cast<size_t>(spec.height);
    image.values.resize(pixel_count * channel_count);

    // Reading ids as floats would divide them by 2^32: a picture with ids is read channel by channel.
    bool has_ids = false;
    for (int c = 0; c < spec.nchannels; ++c) has_ids |= spec.channelformat(c) == OIIO::TypeDesc::UINT32;
    if (!has_ids && !in->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, image.values.data()))
        fail(in->geterror());
    for (int c = 0; has_ids && c < spec.nchannels; ++c) {
        const bool is_id = spec.channelformat(c) == OIIO::TypeDesc::UINT32;
        std::vector<uint32_t> words(pixel_count);
        if (!in->read_image(0, 0, c, c + 1, is_id ? OIIO::TypeDesc::UINT32 : OIIO::TypeDesc::FLOAT, words.data())) {
            fail(in->geterror());
        }
        for (size_t i = 0; i < pixel_count; ++i) {
            float value;
            std::memcpy(&value, &words[i], sizeof value);
            image.values[i * channel_count + static_cast<size_t>(c)] = is_id ? static_cast<float>(words[i]) : value;
        }
    }
    if (in->has_error()) fail(in->geterror());
    return image;
}

}  // namespace zoe
