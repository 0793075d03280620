#include "engine/render/film.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>
#include <glm/vec3.hpp>

#include "engine/render/layers.h"
#include "engine/scene/image.h"
#include "tests/support/temp_folder.h"

namespace zoe::test {
namespace {

/// The bytes of one pixel of a linear colour.
glm::ivec4 encode(const glm::vec3& color, float exposure = 1.0f, int sample_count = 1) {
    Film film(1, 1);
    film.sum[0] = glm::vec4(color * static_cast<float>(sample_count), 0.0f);
    film.sample_count = sample_count;
    const std::vector<uint8_t> bytes = to_rgba8(film, {.exposure = exposure, .tone = Tone::kLinear});
    return {bytes[0], bytes[1], bytes[2], bytes[3]};
}

TEST(Film, ColoursAreEncodedAsSrgb) {
    EXPECT_EQ(encode(glm::vec3(0.0f)), glm::ivec4(0, 0, 0, 255));
    EXPECT_EQ(encode({0.2140f, 0.5029f, 0.0030353f}), glm::ivec4(127, 188, 10, 255));
    EXPECT_EQ(encode(glm::vec3(0.2140f), 1.0f, 7), glm::ivec4(127, 127, 127, 255));
    EXPECT_EQ(encode(glm::vec3(0.1070f), 2.0f), glm::ivec4(127, 127, 127, 255));
}

TEST(Film, WhatIsNotANumberIsBlackAndInfinityIsFull) {
    const float infinity = std::numeric_limits<float>::infinity();
    EXPECT_EQ(encode(glm::vec3(std::nanf(""))), glm::ivec4(0, 0, 0, 255));
    EXPECT_EQ(encode({infinity, 0, 0}), glm::ivec4(255, 0, 0, 255));
    EXPECT_EQ(encode(glm::vec3(-1.0f)), glm::ivec4(0, 0, 0, 255));
}

TEST(Film, ClearGoesBackToNoSamples) {
    Film film(3, 2);
    film.sum[4] = glm::vec4(1.0f);
    film.depth[4] = 1.0f;
    film.node[4] = film.primitive[4] = 7;
    film.sample_count = 5;
    film.clear();
    EXPECT_EQ(film.sample_count, 0);
    EXPECT_EQ(film.pixel(1, 1), glm::vec4(0.0f));
    EXPECT_EQ(film.depth[4], std::numeric_limits<float>::infinity());
    EXPECT_EQ(film.node[4], 0xffffffffu);
    EXPECT_EQ(film.primitive[4], 0xffffffffu);
}

/// The value of a channel, found by its name.
float channel(const FloatImage& image, const std::string& name, int x, int y) {
    const auto found = std::find(image.channels.begin(), image.channels.end(), name);
    EXPECT_NE(found, image.channels.end()) << name;
    const size_t pixel = static_cast<size_t>(y) * static_cast<size_t>(image.width) + static_cast<size_t>(x);
    return image.values[pixel * image.channels.size() + static_cast<size_t>(found - image.channels.begin())];
}

/// What the file says under a name, or nothing.
std::string note(const FloatImage& image, const std::string& name) {
    for (const auto& [key, text] : image.notes) {
        if (key == name) return text;
    }
    return "";
}

TEST(Film, ExrLayersComeBackByName) {
    const TempFolder folder;
    Film film(3, 2);
    film.sample_count = 2;
    film.sum[5] = {2.0f, 4.0f, 6.0f, 1.0f};
    film.depth[5] = 12.5f;
    film.node[5] = 3;
    film.primitive[5] = 70001;
    write_film(film, folder / "film.exr");
    const FloatImage image = read_picture(folder / "film.exr");
    ASSERT_EQ(image.width, 3);
    ASSERT_EQ(image.height, 2);
    EXPECT_EQ(image.channels.size(), 8u);
    EXPECT_EQ(channel(image, "R", 2, 1), 1.0f);
    EXPECT_EQ(channel(image, "G", 2, 1), 2.0f);
    EXPECT_EQ(channel(image, "B", 2, 1), 3.0f);
    EXPECT_EQ(channel(image, "A", 2, 1), 0.5f);
    EXPECT_EQ(channel(image, "depth.Z", 2, 1), 12.5f);
    EXPECT_EQ(channel(image, "node.id", 2, 1), 3.0f);
    EXPECT_EQ(channel(image, "primitive.id", 2, 1), 70001.0f);
    EXPECT_EQ(channel(image, "sampleCount", 0, 1), 2.0f);
    EXPECT_EQ(channel(image, "depth.Z", 0, 0), std::numeric_limits<float>::infinity());
    EXPECT_EQ(channel(image, "node.id", 0, 0), 4294967295.0f);
}

TEST(Film, PixelsThatHadEnoughAreMeansOfTheirOwnSamples) {
    const TempFolder folder;
    Film film(2, 1);
    film.sample_count = 8;
    film.sum = {glm::vec4(4.0f), glm::vec4(4.0f)};
    film.enough = {2, 100};
    EXPECT_EQ(film.pixel(0, 0), glm::vec4(2.0f));
    EXPECT_EQ(film.pixel(1, 0), glm::vec4(0.5f));
    write_film(film, folder / "film.exr");
    const FloatImage image = read_picture(folder / "film.exr");
    EXPECT_EQ(channel(image, "R", 0, 0), 2.0f);
    EXPECT_EQ(channel(image, "R", 1, 0), 0.5f);
    EXPECT_EQ(channel(image, "sampleCount", 0, 0), 2.0f);
    EXPECT_EQ(channel(image, "sampleCount", 1, 0), 8.0f);
    const std::vector<uint8_t> bytes = to_rgba8(film, {.exposure = 0.125f, .tone = Tone::kLinear});
    EXPECT_EQ(glm::ivec3(bytes[0], bytes[1], bytes[2]), glm::ivec3(encode(glm::vec3(0.25f))));
    EXPECT_EQ(glm::ivec3(bytes[4], bytes[5], bytes[6]), glm::ivec3(encode(glm::vec3(0.0625f))));
    film.clear();
    EXPECT_TRUE(film.enough.empty());
}

TEST(Film, LayersAndNotesComeBackToo) {
    const TempFolder folder;
    Film film(2, 1);
    film.sample_count = 1;
    Layers layers;
    layers.width = 2;
    layers.height = 1;
    layers.albedo = {{0.1f, 0.2f, 0.3f}, {0.4f, 0.5f, 0.6f}};
    layers.normal = {{0.0f, 0.0f, 1.0f}, {0.0f, -1.0f, 0.0f}};
    layers.motion = {{1.5f, -2.0f}, {0.0f, 64.0f}};
    write_film(film, folder / "film.exr", {.layers = &layers, .notes = {{"frame", "12"}, {"Software", "this one"}}});
    const FloatImage image = read_picture(folder / "film.exr");
    EXPECT_EQ(image.channels.size(), 16u);
    EXPECT_EQ(channel(image, "albedo.G", 1, 0), 0.5f);
    EXPECT_EQ(channel(image, "albedo.B", 0, 0), 0.3f);
    EXPECT_EQ(channel(image, "normal.Y", 1, 0), -1.0f);
    EXPECT_EQ(channel(image, "backward.u", 0, 0), 1.5f);
    EXPECT_EQ(channel(image, "backward.v", 1, 0), 64.0f);
    EXPECT_EQ(note(image, "frame"), "12");
    EXPECT_EQ(note(image, "Software"), "this one");

    write_film(film, folder / "film.png", {.notes = {{"frame", "12"}, {"scene", "fox.glb"}}});
    const FloatImage png = read_picture(folder / "film.png");
    EXPECT_EQ(note(png, "frame"), "12");
    EXPECT_EQ(note(png, "scene"), "fox.glb");
}

TEST(Film, PngHoldsTheEncodedBytes) {
    const TempFolder folder;
    Film film(2, 1);
    film.sample_count = 1;
    film.sum[1] = {0.2140f, 0.0f, 1e6f, 1.0f};
    write_film(film, folder / "film.png");
    const FloatImage image = read_picture(folder / "film.png");
    const std::vector<uint8_t> expected = to_rgba8(film);
    ASSERT_EQ(image.width, 2);
    for (int x = 0; x < 2; ++x) {
        EXPECT_NEAR(channel(image, "R", x, 0) * 255.0f, expected[static_cast<size_t>(4 * x)], 0.01f);
        EXPECT_NEAR(channel(image, "B", x, 0) * 255.0f, expected[static_cast<size_t>(4 * x + 2)], 0.01f);
    }
}

TEST(Film, OtherNamesAreRefusedAndNothingIsLeftBehind) {
    const TempFolder folder;
    const Film film(1, 1);
    EXPECT_THROW(write_film(film, folder / "film.jpg"), std::runtime_error);
    EXPECT_THROW(write_film(film, folder / "film"), std::runtime_error);
    EXPECT_THROW(write_film(film, folder.path() / "missing" / "film.png"), std::runtime_error);
    EXPECT_THROW(write_film(film, folder.path() / "missing" / "film.exr"), std::runtime_error);
    EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace
}  // namespace zoe::test
