#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>

#include <sys/resource.h>

#include <gtest/gtest.h>

#include "engine/math/rng.h"
#include "engine/scene/decode_image.h"
#include "engine/scene/image.h"
#include "tests/scene/glb_builder.h"
#include "tests/support/allocation_count.h"

namespace zoe::test {
namespace {

namespace fs = std::filesystem;

std::vector<std::byte> bytes_of(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    const std::string text((std::istreambuf_iterator<char>(in)), {});
    const auto* begin = reinterpret_cast<const std::byte*>(text.data());
    return {begin, begin + text.size()};
}

std::vector<uint8_t> random_pixels(size_t count, uint64_t seed) {
    Rng rng(seed);
    std::vector<uint8_t> pixels(count);
    for (uint8_t& value : pixels) value = static_cast<uint8_t>(rng.below(256));
    return pixels;
}

TEST(Picture, PngComesBackBitForBitAlphaIncluded) {
    const TempFolder folder;
    const std::vector<uint8_t> pixels = random_pixels(7 * 5 * 4, 1);
    write_png(folder / "a.png", 7, 5, pixels);
    Image image;
    std::string error;
    ASSERT_TRUE(decode_image(bytes_of(folder / "a.png"), &image, &error)) << error;
    EXPECT_EQ(image.width, 7);
    EXPECT_EQ(image.height, 5);
    EXPECT_EQ(image.pixels, pixels);
    const FloatImage back = read_picture(folder / "a.png");
    ASSERT_EQ(back.values.size(), pixels.size());
    EXPECT_NEAR(back.values[9], pixels[9] / 255.0f, 1e-6f);
}

TEST(Picture, ImagesAboveTheLimitAreNotDecoded) {
    const TempFolder folder;
    write_png(folder / "a.png", 7, 5, random_pixels(7 * 5 * 4, 4));
    const std::vector<std::byte> bytes = bytes_of(folder / "a.png");
    Image image;
    std::string error;
    EXPECT_FALSE(decode_image(bytes, &image, &error, 0));
    EXPECT_EQ(error, "7 x 5 pixels, where images may have 0 together");
    EXPECT_EQ(image.pixels.capacity(), 0u);
    EXPECT_EQ(image.width, 0);
    EXPECT_TRUE(decode_image(bytes, &image, &error, 35));
}

TEST(Picture, ImagesAboveTheLimitAreHalvedWhileTheyAreDecoded) {
    const TempFolder folder;
    const std::vector<uint8_t> pixels = random_pixels(37 * 21 * 4, 6);
    write_png(folder / "a.png", 37, 21, pixels);
    Image whole, half;
    std::string error;
    for (bool is_color : {true, false}) {
        whole.is_color = half.is_color = is_color;
        ASSERT_TRUE(decode_image(bytes_of(folder / "a.png"), &whole, &error)) << error;
        ASSERT_TRUE(decode_image(bytes_of(folder / "a.png"), &half, &error, 37 * 21 - 1)) << error;
        EXPECT_EQ(half.halvings, 1);
        EXPECT_EQ(half.width, 19);
        EXPECT_EQ(half.height, 11);
        ASSERT_EQ(half.pixels.size(), 19u * 11u * 4u);
        double mean = 0.0, half_mean = 0.0;
        for (size_t i = 3; i < whole.pixels.size(); i += 4) mean += whole.pixels[i] * 4.0 / double(whole.pixels.size());
        for (size_t i = 3; i < half.pixels.size(); i += 4) half_mean += half.pixels[i] * 4.0 / double(half.pixels.size());
        EXPECT_NEAR(half_mean, mean, 5.0) << "the last row stands for one row, not two";
    }
}

/// Gives a PNG another size in its header, and that the checksum that it should have.
void forge_size(std::vector<std::byte>& png, uint32_t width, uint32_t height) {
    const auto put = [&](size_t at, uint32_t value) {
        for (size_t k = 0; k < 4; ++k) png[at + k] = static_cast<std::byte>(value >> (24 - 8 * k));
    };
    put(16, width);
    put(20, height);
    uint32_t crc = 0xffffffffu;
    for (size_t k = 12; k < 29; ++k) {
        crc ^= std::to_integer<uint32_t>(png[k]);
        for (int bit = 0; bit < 8; ++bit) crc = (crc & 1u) != 0 ? 0xedb88320u ^ crc >> 1 : crc >> 1;
    }
    put(29, ~crc);
}

TEST(Picture, SizesBeyondAllReasonTakeNoMemory) {
    const TempFolder folder;
    write_png(folder / "a.png", 7, 5, random_pixels(7 * 5 * 4, 5));
    std::vector<std::byte> png = bytes_of(folder / "a.png");
    forge_size(png, 7, 5);
    Image image;
    std::string error;
    ASSERT_TRUE(decode_image(png, &image, &error)) << error;
    const uint32_t sizes[][2] = {{65000, 65000}, {16385, 1}, {1, 16385}, {1000000, 1000000}, {0x7fffffff, 0x7fffffff}};
    for (const auto& [width, height] : sizes) {
        forge_size(png, width, height);
        reset_peak_bytes();
        const size_t before = live_bytes();
        EXPECT_FALSE(decode_image(png, &image, &error)) << width << " x " << height;
        EXPECT_NE(error, "");
        EXPECT_LT(peak_bytes() - before, size_t{16} << 20) << width << " x " << height;
    }
}

TEST(Picture, OfOtherFormatsNoneIsDecoded) {
    for (const std::string_view begin : {"GIF89a", "BM", "II*\0", "P6 1 1 255", ""}) {
        const auto* from = reinterpret_cast<const std::byte*>(begin.data());
        std::vector<std::byte> bytes(from, from + begin.size());
        bytes.resize(200);
        Image image;
        std::string error;
        EXPECT_FALSE(decode_image(bytes, &image, &error));
        EXPECT_EQ(error, "not a picture of a known format");
    }
}

TEST(Picture, TruncatedFilesAreRefused) {
    const TempFolder folder;
    write_png(folder / "a.png", 16, 16, random_pixels(16 * 16 * 4, 2));
    const std::vector<std::byte> bytes = bytes_of(folder / "a.png");
    for (size_t size = 0; size + 64 < bytes.size(); size += 13) {
        Image image;
        std::string error;
        EXPECT_FALSE(decode_image(std::span(bytes).first(size), &image, &error)) << size;
        EXPECT_NE(error, "");
        EXPECT_TRUE(image.pixels.empty());
    }
}

TEST(Picture, MutatedFilesDoNoHarm) {
    const uint64_t seed = 31;
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const TempFolder folder;
    write_png(folder / "a.png", 8, 8, random_pixels(8 * 8 * 4, 3));
    const std::vector<std::byte> original = bytes_of(folder / "a.png");
    Rng rng(seed);
    for (int round = 0; round < 300; ++round) {
        std::vector<std::byte> bytes = original;
        bytes[8 + rng.below(static_cast<uint32_t>(bytes.size() - 8))] = static_cast<std::byte>(rng.below(256));
        Image image;
        std::string error;
        if (decode_image(bytes, &image, &error)) {
            EXPECT_EQ(image.pixels.size(), size_t{4} * static_cast<size_t>(image.width) * static_cast<size_t>(image.height));
        } else {
            EXPECT_NE(error, "");
        }
    }
}

TEST(Picture, ExrKeepsFloatsAndIdsByName) {
    const TempFolder folder;
    const float infinity = std::numeric_limits<float>::infinity();
    const std::vector<float> red{0.1f, -2.0f, 1e30f, 0, 1, 2}, depth{1, infinity, 3, 4, 5, 6};
    std::vector<float> ids(6);
    for (uint32_t i = 0; i < 6; ++i) {
        const uint32_t id = 1000000 + i;
        std::memcpy(&ids[i], &id, sizeof id);
    }
    const Channel channels[] = {{"R", red}, {"depth.Z", depth}, {"node.id", ids, true}};
    write_exr(folder / "a.exr", 3, 2, channels);
    const FloatImage image = read_picture(folder / "a.exr");
    EXPECT_EQ(image.width, 3);
    EXPECT_EQ(image.height, 2);
    ASSERT_EQ(image.channels.size(), 3u);
    const auto channel = [&](const std::string& name) {
        const auto found = std::find(image.channels.begin(), image.channels.end(), name);
        EXPECT_NE(found, image.channels.end()) << name;
        std::vector<float> values;
        for (size_t i = 0; i < 6; ++i)
            values.push_back(image.values[i * 3 + static_cast<size_t>(found - image.channels.begin())]);
        return values;
    };
    EXPECT_EQ(channel("R"), red);
    EXPECT_EQ(channel("depth.Z"), depth);
    EXPECT_EQ(channel("node.id"), (std::vector<float>{1000000, 1000001, 1000002, 1000003, 1000004, 1000005}));
}

TEST(Picture, WhatIsTooLargeIsToldItsSizeAndTheLimit) {
    const TempFolder folder;
    const std::pair<const char*, const char*> cases[] = {
        {"-Y 8192 +X 16384", "16384 x 8192 pixels of 3 channels: 402653184 numbers; 268435456 are allowed"},
        {"-Y 1 +X 70000", "70000 x 1 pixels of 3 channels; 65536 pixels a side are allowed"}};
    for (const auto& [size, expected] : cases) {
        const fs::path file = folder.write("a.hdr", std::string("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n") + size + "\n");
        try {
            read_picture(file);
            ADD_FAILURE() << expected;
        } catch (const std::runtime_error& error) {
            EXPECT_EQ(error.what(), file.string() + ": " + expected);
        }
    }
}

/// No file may grow beyond a size: writing more fails, as on a full disk.
class FullDisk {
public:
    explicit FullDisk(rlim_t byte_count) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
        getrlimit(RLIMIT_FSIZE, &was_);
        const rlimit limit{byte_count, was_.rlim_max};
        setrlimit(RLIMIT_FSIZE, &limit);
    }
    ~FullDisk() {
        setrlimit(RLIMIT_FSIZE, &was_);
        std::signal(SIGXFSZ, handler_);
    }

private:
    rlimit was_;
    void (*handler_)(int);
};

TEST(Picture, AFullDiskLeavesNoPartOfAPicture) {
    const TempFolder folder;
    const std::vector<uint8_t> pixels = random_pixels(64 * 64 * 4, 6);
    const std::vector<float> values(64 * 64, 0.5f);
    const Channel channels[] = {{"R", values}, {"node.id", values, true}};
    const auto write = [&](const fs::path& file) {
        if (file.extension() == ".png") write_png(file, 64, 64, pixels);
        if (file.extension() == ".exr") write_exr(file, 64, 64, channels);
    };
    for (const char* name : {"a.png", "a.exr"}) {
        write(folder / name);
        const uintmax_t size = fs::file_size(folder / name);
        for (const uintmax_t space : {uintmax_t{0}, uintmax_t{1}, size / 2, size - 1}) {
            fs::remove(folder / name);
            const FullDisk full(space);
            EXPECT_THROW(write(folder / name), std::runtime_error) << name << ", " << space << " of " << size << " bytes";
            EXPECT_TRUE(fs::is_empty(folder.path())) << name << ", " << space << " of " << size << " bytes";
        }
        {
            const FullDisk full(size);
            write(folder / name);
        }
        EXPECT_EQ(read_picture(folder / name).width, 64);
        fs::remove(folder / name);
    }
}

TEST(Picture, AFailedWriteLeavesNothingBehind) {
    const TempFolder folder;
    const std::vector<uint8_t> pixels(4, 0);
    EXPECT_THROW(write_png(folder / "missing/a.png", 1, 1, pixels), std::runtime_error);
    fs::create_directory(folder / "taken.png");
    EXPECT_THROW(write_png(folder / "taken.png", 1, 1, pixels), std::runtime_error);
    EXPECT_THROW(write_png(folder / "a.png", 2, 2, pixels), std::runtime_error);
    const std::vector<float> one(1, 0.0f);
    const Channel channels[] = {{"R", one}};
    EXPECT_THROW(write_exr(folder / "taken.png", 1, 1, channels), std::runtime_error);
    EXPECT_THROW(write_exr(folder / "a.exr", 2, 1, channels), std::runtime_error);
    EXPECT_THROW(read_picture(folder / "a.exr"), std::runtime_error);
    EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()), 1);
}

}  // namespace
}  // namespace zoe::test
