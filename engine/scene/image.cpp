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

namespace zoe {
namespace {

namespace fs = std::filesystem;

constexpr int kMaxPictureSide = 65536, kMaxPictureChannels = 1024;
constexpr uint64_t kMaxPictureValues = uint64_t{1} << 28;  // numbers of a picture of floats: 1 GiB

std::string one_line(const std::string& text) {
    std::string line = plain_line(text);
    while (!line.empty() && line.back() == ' ') line.pop_back();
    return line;
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
    const std::string size = fmt::format("{} x {} pixels of {} channels", spec.width, spec.height, spec.nchannels);
    const bool has_sides =
        spec.width > 0 && spec.height > 0 && spec.width <= kMaxPictureSide && spec.height <= kMaxPictureSide;
    if (!has_sides) fail(fmt::format("{}; {} pixels a side are allowed", size, kMaxPictureSide));
    if (spec.nchannels < 1 || spec.nchannels > kMaxPictureChannels) {
        fail(fmt::format("{}; 1 to {} channels are allowed", size, kMaxPictureChannels));
    }
    const uint64_t value_count =
        static_cast<uint64_t>(spec.width) * static_cast<uint64_t>(spec.height) * static_cast<uint64_t>(spec.nchannels);
    if (value_count > kMaxPictureValues) {
        fail(fmt::format("{}: {} numbers; {} are allowed", size, value_count, kMaxPictureValues));
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
