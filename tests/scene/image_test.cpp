#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

#include <gtest/gtest.h>

#include "engine/math/rng.h"
#include "engine/scene/image.h"
#include "tests/scene/glb_builder.h"

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
    EXPECT_FALSE(decode_image(bytes, &image, &error, 34));
    EXPECT_EQ(error, "7 x 5 pixels, more than the 34 that are left for images");
    EXPECT_EQ(image.pixels.capacity(), 0u);
    EXPECT_EQ(image.width, 0);
    EXPECT_TRUE(decode_image(bytes, &image, &error, 35));
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
