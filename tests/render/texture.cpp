#include "engine/render/texture.h"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "engine/scene/half.h"

namespace zoe::test {
namespace {

/// 4 x 2 texels: red is 0, 60, 120, 180 from left to right; green is 0 in the top row and 255 in the bottom row.
std::vector<Image> test_images() {
    Image image;
    image.width = 4;
    image.height = 2;
    for (int y = 0; y < 2; ++y) {
        for (int x = 0; x < 4; ++x) {
            for (int value : {60 * x, 255 * y, 0, 255 - 50 * x}) image.pixels.push_back(static_cast<uint8_t>(value));
        }
    }
    return {image};
}

TextureRef nearest(Wrap wrap) {
    TextureRef texture;
    texture.image = ImageId{0};
    texture.wrap_s = texture.wrap_t = wrap;
    texture.is_nearest = true;
    return texture;
}

/// The column whose texel a nearest lookup at u, in the top row, gives.
int column(const TextureRef& texture, float u) {
    const float red = sample_texture(test_images(), texture, {u, 0.25f}).r;
    for (int x = 0; x < 4; ++x) {
        if (red == linear_from_srgb_byte(static_cast<uint8_t>(60 * x))) return x;
    }
    return -1;
}

TEST(Texture, SrgbDecodesByTheStandardsFormula) {
    EXPECT_EQ(linear_from_srgb_byte(0), 0.0f);
    EXPECT_EQ(linear_from_srgb_byte(255), 1.0f);
    EXPECT_NEAR(linear_from_srgb_byte(10), 10.0f / 255.0f / 12.92f, 1e-7f);
    EXPECT_NEAR(linear_from_srgb_byte(188), 0.5f, 0.005f);
}

TEST(Texture, TheOriginIsTheTopLeftCornerAndVGoesDown) {
    const TextureRef texture = nearest(Wrap::kRepeat);
    EXPECT_EQ(sample_texture(test_images(), texture, {0.01f, 0.01f}).g, 0.0f);
    EXPECT_EQ(sample_texture(test_images(), texture, {0.01f, 0.99f}).g, 1.0f);
    EXPECT_EQ(column(texture, 0.01f), 0);
    EXPECT_EQ(column(texture, 0.99f), 3);
}

TEST(Texture, WrapModesRepeatMirrorAndClamp) {
    const float u[] = {-1.1f, -0.6f, -0.1f, 0.1f, 0.4f, 0.9f, 1.1f, 1.6f, 2.1f};
    const int repeat[] = {3, 1, 3, 0, 1, 3, 0, 2, 0};
    const int mirror[] = {3, 2, 0, 0, 1, 3, 3, 1, 0};
    const int clamp[] = {0, 0, 0, 0, 1, 3, 3, 3, 3};
    for (size_t i = 0; i < std::size(u); ++i) {
        EXPECT_EQ(column(nearest(Wrap::kRepeat), u[i]), repeat[i]) << u[i];
        EXPECT_EQ(column(nearest(Wrap::kMirror), u[i]), mirror[i]) << u[i];
        EXPECT_EQ(column(nearest(Wrap::kClamp), u[i]), clamp[i]) << u[i];
    }
}

TEST(Texture, BilinearGivesTexelsAtTheirCentresAndMeansBetween) {
    TextureRef texture = nearest(Wrap::kRepeat);
    texture.is_nearest = false;
    const auto images = test_images();
    EXPECT_FLOAT_EQ(sample_texture(images, texture, {0.375f, 0.25f}).r, linear_from_srgb_byte(60));
    // Half way: the mean of the decoded colours, not of the stored bytes.
    const float mean = 0.5f * (linear_from_srgb_byte(60) + linear_from_srgb_byte(120));
    EXPECT_NEAR(sample_texture(images, texture, {0.5f, 0.25f}).r, mean, 1e-6f);
    EXPECT_NEAR(sample_texture(images, texture, {0.375f, 0.5f}).g, 0.5f, 1e-6f);
    EXPECT_NEAR(sample_texture(images, texture, {0.5f, 0.25f}).a, (205 + 155) / 510.0f, 1e-6f);
    // Across the seam: with the other side, or with itself.
    EXPECT_NEAR(sample_texture(images, texture, {0.0f, 0.25f}).r, 0.5f * linear_from_srgb_byte(180), 1e-6f);
    texture.wrap_s = Wrap::kMirror;
    EXPECT_NEAR(sample_texture(images, texture, {0.0f, 0.25f}).r, 0.0f, 1e-6f);
    EXPECT_NEAR(sample_texture(images, texture, {1.0f, 0.25f}).r, linear_from_srgb_byte(180), 1e-6f);
    texture.wrap_s = Wrap::kClamp;
    EXPECT_NEAR(sample_texture(images, texture, {7.0f, 0.25f}).r, linear_from_srgb_byte(180), 1e-6f);
}

TEST(Texture, TheTransformActsOnTheCoordinates) {
    TextureRef texture = nearest(Wrap::kRepeat);
    texture.image_from_uv = glm::mat3(0.5f, 0, 0, 0, 1, 0, 0.25f, 0, 1);  // u' = 0.5 u + 0.25
    EXPECT_EQ(column(texture, 0.1f), 1);
    EXPECT_EQ(column(texture, 0.9f), 2);
    texture.image_from_uv = glm::mat3(0, 1, 0, 1, 0, 0, 0, 0, 1);  // u' = v, v' = u
    EXPECT_EQ(sample_texture(test_images(), texture, {0.1f, 0.9f}).r, linear_from_srgb_byte(180));
}

TEST(Texture, AnyCoordinateStaysInsideTheImage) {
    const float huge = std::numeric_limits<float>::max(), infinity = std::numeric_limits<float>::infinity();
    for (Wrap wrap : {Wrap::kRepeat, Wrap::kMirror, Wrap::kClamp}) {
        for (bool is_nearest : {true, false}) {
            TextureRef texture = nearest(wrap);
            texture.is_nearest = is_nearest;
            for (float u :
                 {-huge, -1e9f, -1.0f, -1e-9f, -0.0f, 1.0f, 2.0f, 1e9f, huge, infinity, -infinity, std::nanf("")}) {
                const glm::vec4 color = sample_texture(test_images(), texture, {u, -u});
                EXPECT_TRUE(color.r >= 0.0f && color.r <= 1.0f) << u;
            }
        }
    }
}

TEST(Texture, NoTextureAndAMissingImageAreWhite) {
    EXPECT_EQ(sample_texture({}, TextureRef{}, {0.5f, 0.5f}), glm::vec4(1.0f));
    const std::vector<Image> missing(1);
    EXPECT_EQ(sample_texture(missing, nearest(Wrap::kRepeat), {0.5f, 0.5f}), glm::vec4(1.0f));
}

/// A row of texels and its levels, that hold other numbers than its means: those tell which one was looked up.
std::vector<Image> row_of_levels() {
    Image image{.is_color = false, .is_half = true, .width = 4, .height = 1};
    const auto append = [](std::vector<uint8_t>* pixels, std::initializer_list<float> numbers) {
        for (const float number : numbers) {
            const uint16_t half = half_from_float(number);
            for (int c = 0; c < 4; ++c)
                pixels->insert(pixels->end(), {static_cast<uint8_t>(half & 255), static_cast<uint8_t>(half >> 8)});
        }
    };
    append(&image.pixels, {1, 2, 3, 4});
    image.coarser = {{2, 1, {}}, {1, 1, {}}};
    append(&image.coarser[0].pixels, {16, 32});
    append(&image.coarser[1].pixels, {512});
    return {image};
}

TEST(Texture, MinifyingFiltersPickTexelsAndLevelsAsGltfMeansThem) {
    const std::vector<Image> images = row_of_levels();
    constexpr float kU =
        0.25f + 1.0f / 16.0f;  // A quarter into the second of 4 texels, and right of the middle of the first of 2.
    constexpr float kNearest[] = {2.0f, 16.0f, 512.0f}, kLinear[] = {1.75f, 18.0f, 512.0f};
    for (const bool is_nearest : {true, false}) {
        for (const LevelFilter levels : {LevelFilter::kFinest, LevelFilter::kNearest, LevelFilter::kBlended}) {
            TextureRef texture;
            texture.image = ImageId{0};
            texture.wrap_s = texture.wrap_t = Wrap::kClamp;
            texture.is_nearest_minified = is_nearest;
            texture.levels = levels;
            const float* const of = is_nearest ? kNearest : kLinear;
            const auto at = [&](float level) {
                // The image's area is 4 texels: its texels count as half as wide as those of 4 x 4.
                const float uv_width = std::exp2(level) / 2.0f;
                return sample_texture(images, texture, {kU, 0.5f}, uv_width, Texels::kLight).r;
            };
            SCOPED_TRACE(testing::Message() << is_nearest << ", " << int(levels));
            for (const bool is_nearest_magnified : {true, false}) {
                texture.is_nearest = is_nearest_magnified;
                EXPECT_EQ(at(-0.01f), is_nearest_magnified ? kNearest[0] : kLinear[0]);
                EXPECT_EQ(sample_texture(images, texture, {kU, 0.5f}, 0.0f, Texels::kLight).r,
                          is_nearest_magnified ? kNearest[0] : kLinear[0]);
            }
            for (const float level : {0.01f, 0.3f, 0.49f, 0.51f, 0.75f, 1.25f, 1.49f, 1.51f, 1.9f, 2.5f, 9.0f}) {
                const float clamped = std::min(level, 2.0f);
                const auto finer = static_cast<size_t>(clamped);
                const float share = clamped - static_cast<float>(finer);
                const float blended = finer == 2 ? of[2] : (1.0f - share) * of[finer] + share * of[finer + 1];
                const float expected = levels == LevelFilter::kFinest    ? of[0]
                                       : levels == LevelFilter::kNearest ? of[clamped < 0.5f   ? 0
                                                                              : clamped < 1.5f ? 1
                                                                                               : 2]
                                                                         : blended;
                EXPECT_NEAR(at(level), expected, 1e-3f) << level;
            }
        }
    }
}

}  // namespace
}  // namespace zoe::test
