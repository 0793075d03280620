#include "engine/scene/image_levels.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "engine/math/parallel.h"
#include "engine/math/rng.h"
#include "engine/scene/srgb.h"

namespace zoe::test {
namespace {

Image random_image(int width, int height, bool is_color, Rng& rng) {
    Image image;
    image.is_color = is_color;
    image.width = width;
    image.height = height;
    for (int i = 0; i < 4 * width * height; ++i) image.pixels.push_back(static_cast<uint8_t>(rng.below(256)));
    return image;
}

/// Mean of a channel, in light where that is what is averaged.
double mean(std::span<const uint8_t> pixels, size_t channel, bool is_color) {
    double sum = 0.0;
    for (size_t i = channel; i < pixels.size(); i += 4) {
        sum += is_color && channel < 3 ? static_cast<double>(linear_from_srgb_byte(pixels[i])) : pixels[i] / 255.0;
    }
    return sum * 4.0 / static_cast<double>(pixels.size());
}

TEST(ImageLevels, EveryLevelHasTheMeanOfTheImage) {
    const uint64_t seed = 41;
    SCOPED_TRACE(seed);
    Rng rng(seed);
    for (const auto& [width, height] : {std::pair(64, 64), {37, 91}, {1, 50}, {129, 2}, {3, 3}}) {
        for (bool is_color : {true, false}) {
            Image image = random_image(width, height, is_color, rng);
            make_levels(&image);
            ASSERT_FALSE(image.coarser.empty());
            EXPECT_EQ(image.coarser.back().width, 1);
            EXPECT_EQ(image.coarser.back().height, 1);
            int w = width, h = height;
            for (const ImageLevel& level : image.coarser) {
                EXPECT_EQ(level.width, (w + 1) / 2);
                EXPECT_EQ(level.height, (h + 1) / 2);
                w = level.width;
                h = level.height;
                for (size_t c = 0; c < 4; ++c) {
                    // Every level rounds to bytes: half a step each, which in light is largest where it is bright.
                    EXPECT_NEAR(mean(level.pixels, c, is_color), mean(image.pixels, c, is_color), 0.012) << w << " x " << h;
                }
            }
        }
    }
}

TEST(ImageLevels, ATexelIsTheMeanOfFourInLight) {
    const ImageLevel image{2, 2, {0, 0, 0, 0, 255, 255, 255, 255, 0, 0, 0, 0, 255, 255, 255, 255}};
    EXPECT_EQ(halved(image, true, false).pixels, (std::vector<uint8_t>{188, 188, 188, 128}));
    EXPECT_EQ(halved(image, false, false).pixels, (std::vector<uint8_t>{128, 128, 128, 128}));
}

TEST(ImageLevels, BytesOfLightAreTheStandards) {
    for (int i = 0; i < 256; ++i) EXPECT_EQ(srgb_byte_from_linear(linear_from_srgb_byte(static_cast<uint8_t>(i))), i);
    for (float x = 0.0f; x <= 1.0f; x += 1.0f / 4096.0f) {
        const double encoded = x <= 0.0031308f ? 12.92 * x : 1.055 * std::pow(static_cast<double>(x), 1.0 / 2.4) - 0.055;
        EXPECT_NEAR(srgb_byte_from_linear(x), encoded * 255.0, 0.51) << x;
    }
    for (int i = 0; i < 255; ++i) {
        const float step = linear_from_srgb((static_cast<float>(i) + 0.5f) / 255.0f);
        EXPECT_EQ(srgb_byte_from_linear(std::nextafter(step, 0.0f)), i);
        EXPECT_EQ(srgb_byte_from_linear(step), i + 1);
    }
    EXPECT_EQ(srgb_byte_from_linear(-1.0f), 0);
    EXPECT_EQ(srgb_byte_from_linear(std::numeric_limits<float>::quiet_NaN()), 0);
    EXPECT_EQ(srgb_byte_from_linear(std::numeric_limits<float>::infinity()), 255);
}

TEST(ImageLevels, ThreadsDoNotMatter) {
    Rng rng(43);
    Image one = random_image(200, 150, true, rng), two = one;
    set_thread_count(1);
    make_levels(&one);
    set_thread_count(2);
    make_levels(&two);
    set_thread_count(0);
    EXPECT_EQ(one, two);
}

TEST(ImageLevels, ImagesAreHalvedUntilTheyFitAndNoFurther) {
    const uint64_t seed = 42;
    SCOPED_TRACE(seed);
    Rng rng(seed);
    for (int round = 0; round < 30; ++round) {
        std::vector<Image> images;
        uint64_t total = 0;
        for (int i = 0; i < 6; ++i) {
            images.push_back(
                random_image(1 + static_cast<int>(rng.below(60)), 1 + static_cast<int>(rng.below(60)), true, rng));
            make_levels(&images.back());
            total += images.back().pixels.size() / 4;
        }
        const std::vector<Image> before = images;
        const uint64_t limit = 6 + rng.below(static_cast<uint32_t>(total));
        fit_images(&images, limit);
        uint64_t left = 0, largest = 0, last_dropped = UINT64_MAX;
        for (size_t i = 0; i < images.size(); ++i) {
            left += images[i].pixels.size() / 4;
            largest = std::max<uint64_t>(largest, images[i].pixels.size() / 4);
            const int halvings = images[i].halvings;
            if (halvings == 0) {
                EXPECT_EQ(images[i], before[i]);
                continue;
            }
            EXPECT_EQ(images[i].pixels, before[i].coarser[static_cast<size_t>(halvings) - 1].pixels);
            const size_t dropped =
                halvings == 1 ? before[i].pixels.size() : before[i].coarser[static_cast<size_t>(halvings) - 2].pixels.size();
            last_dropped = std::min<uint64_t>(last_dropped, dropped / 4);
        }
        EXPECT_LE(left, limit);
        EXPECT_LE(largest, last_dropped) << "something smaller was halved first";
    }
}

TEST(ImageLevels, RoomIsMadeAsIfTheImageWereThere) {
    const uint64_t seed = 44;
    SCOPED_TRACE(seed);
    Rng rng(seed);
    for (int round = 0; round < 30; ++round) {
        std::vector<Image> images;
        for (int i = 0; i < 4; ++i) {
            images.push_back(
                random_image(1 + static_cast<int>(rng.below(60)), 1 + static_cast<int>(rng.below(60)), true, rng));
            make_levels(&images.back());
        }
        Image added;
        added.width = images.back().width;
        added.height = images.back().height;
        std::vector<Image> expected = images;
        images.pop_back();
        const uint64_t limit = 8 + rng.below(6000);
        fit_images(&expected, limit);
        EXPECT_EQ(make_room(added, &images, limit), expected.back().halvings);
        expected.pop_back();
        EXPECT_EQ(images, expected);
    }
}

TEST(ImageLevels, CopiesAreWhatFittingCopiesWouldLeave) {
    const uint64_t seed = 45;
    SCOPED_TRACE(seed);
    Rng rng(seed);
    for (int round = 0; round < 30; ++round) {
        const std::vector<size_t> originals{0, 1, 0, 3, 1, 0};
        std::vector<Image> images(originals.size());
        for (size_t i : {0, 1, 3}) {
            images[i] = random_image(1 + static_cast<int>(rng.below(20)), 1 + static_cast<int>(rng.below(20)), true, rng);
            make_levels(&images[i]);
        }
        std::vector<Image> expected;
        for (size_t i = 0; i < originals.size(); ++i) {
            expected.push_back(images[originals[i]]);
            expected.back().name = images[i].name = std::to_string(i);
        }
        const uint64_t limit = rng.below(1000);
        copy_and_fit(originals, &images, limit);
        fit_images(&expected, limit);
        EXPECT_EQ(images, expected) << limit;
    }
}

}  // namespace
}  // namespace zoe::test
