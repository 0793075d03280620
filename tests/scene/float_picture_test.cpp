// Pictures of floats as textures: EXR and HDR.

#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>

#include <gtest/gtest.h>

#include "engine/math/rng.h"
#include "engine/scene/decode_image.h"
#include "engine/scene/half.h"
#include "engine/scene/image_levels.h"
#include "tests/scene/glb_builder.h"
#include "tests/support/allocation_count.h"

namespace zoe::test {
namespace {

namespace fs = std::filesystem;

std::string read_text(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

/// An EXR of channels with one name of a letter each; values [pixel][channel].
std::string make_exr(int width, int height, const std::vector<std::string>& names, const std::vector<float>& values) {
    const TempFolder folder;
    std::vector<std::vector<float>> planes(names.size());
    for (size_t i = 0; i < values.size(); ++i) planes[i % names.size()].push_back(values[i]);
    std::vector<Channel> channels;
    for (size_t c = 0; c < names.size(); ++c) channels.push_back({names[c], planes[c]});
    write_exr(folder / "a.exr", width, height, channels);
    return read_text(folder / "a.exr");
}

/// An HDR of 4 bytes a pixel: red, green, blue, exponent.
std::string make_hdr(int width, int height, const std::string& rgbe, const std::string& axes = "-Y {} +X {}") {
    std::string size = axes;
    for (const int side : {height, width}) size.replace(size.find("{}"), 2, std::to_string(side));
    return "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n" + size + "\n" + rgbe;
}

/// The reason why a picture is refused; empty where it is not.
std::string decode(const std::string& bytes, Image* image, uint64_t max_pixels = UINT64_MAX) {
    std::string error;
    const bool is_read = decode_image(std::as_bytes(std::span(bytes.data(), bytes.size())), image, &error, max_pixels);
    EXPECT_EQ(is_read, error.empty());
    EXPECT_EQ(is_read, !image->pixels.empty());
    return error;
}

std::vector<float> numbers_of(const std::vector<uint8_t>& pixels) {
    std::vector<uint16_t> halves(pixels.size() / 2);
    std::memcpy(halves.data(), pixels.data(), pixels.size());
    std::vector<float> numbers;
    for (const uint16_t half : halves) numbers.push_back(float_from_half(half));
    return numbers;
}

TEST(FloatPicture, NumbersAreKeptAsTheyAre) {
    const std::vector<float> values{0.25f, 5.0f, 65504.0f, 0.5f, 0.0f, 1.0f, 0x1p-24f, 1.0f};
    Image image{.is_light = true};
    EXPECT_EQ(decode(make_exr(2, 1, {"R", "G", "B", "A"}, values), &image), "");
    EXPECT_TRUE(image.is_half);
    EXPECT_EQ(image.width, 2);
    EXPECT_EQ(image.replaced, 0u);
    EXPECT_EQ(numbers_of(image.pixels), values);

    EXPECT_EQ(decode(make_hdr(2, 1, {'\x80', '\x40', 0, '\x81', '\xa0', '\x80', '\x20', '\x83'}), &image), "");
    EXPECT_EQ(numbers_of(image.pixels), (std::vector<float>{1, 0.5f, 0, 1, 5, 4, 1, 1}));
}

TEST(FloatPicture, NumbersThatTexelsDoNotHaveAreReplacedAndCounted) {
    const float infinity = std::numeric_limits<float>::infinity(), none = std::numeric_limits<float>::quiet_NaN();
    const std::vector<float> values{none, infinity, -infinity, none, -1.0f, 7e4f, 5.0f, 2.0f, -0.0f, 1e-30f, 1.0f, -1e-9f};
    const std::string bytes = make_exr(3, 1, {"R", "G", "B", "A"}, values);
    Image image{.is_light = true};
    EXPECT_EQ(decode(bytes, &image), "");
    EXPECT_EQ(numbers_of(image.pixels), (std::vector<float>{0, 65504, 0, 0, 0, 65504, 5, 1, 0, 0, 1, 0}));
    EXPECT_EQ(image.replaced, 7u);  // What is -1e-9 is a zero as a half.
    image.is_light = false;
    EXPECT_EQ(decode(bytes, &image), "");
    EXPECT_EQ(numbers_of(image.pixels), (std::vector<float>{0, 1, 0, 0, 0, 1, 1, 1, 0, 0, 1, 0}));
    EXPECT_EQ(image.replaced, 8u);
}

TEST(FloatPicture, ChannelsAreFoundByTheirNames) {
    Image image{.is_light = true};
    EXPECT_EQ(decode(make_exr(1, 1, {"A", "B", "G", "R", "Z"}, {0.5f, 1, 2, 3, 9}), &image), "");
    EXPECT_EQ(numbers_of(image.pixels), (std::vector<float>{3, 2, 1, 0.5f}));
    EXPECT_EQ(decode(make_exr(1, 1, {"Y", "A"}, {3, 0.5f}), &image), "");
    EXPECT_EQ(numbers_of(image.pixels), (std::vector<float>{3, 3, 3, 0.5f}));
    EXPECT_EQ(decode(make_exr(1, 1, {"R"}, {3}), &image), "");
    EXPECT_EQ(numbers_of(image.pixels), (std::vector<float>{3, 3, 3, 1}));
    const std::vector<std::string> others[] = {{"Z"}, {"R", "G"}, {"G", "B"}, {"Y", "RY", "BY"}, {"diffuse.R"}};
    for (const std::vector<std::string>& names : others) {
        const std::string error = decode(make_exr(1, 1, names, std::vector<float>(names.size(), 1)), &image);
        EXPECT_EQ(error, "an EXR whose channels are neither R, G and B nor one of R and Y") << names[0];
    }
}

TEST(FloatPicture, TilesGiveWhatLinesGive) {
    const fs::path seeds = fs::path(ZOETROPE_SOURCE_DIR) / "tests/fuzz/seeds";
    Image lines, tiles;
    lines.is_light = tiles.is_light = true;
    EXPECT_EQ(decode(read_text(seeds / "lines.exr"), &lines), "");
    EXPECT_EQ(decode(read_text(seeds / "tiled.exr"), &tiles), "");
    EXPECT_EQ(tiles.width, 10);
    EXPECT_EQ(tiles.height, 6);
    EXPECT_EQ(tiles, lines);
}

/// Puts words over what stands after a text and `skip` bytes.
std::string forged(std::string bytes, const std::string& after, size_t skip, const std::vector<int32_t>& words) {
    const size_t at = bytes.find(after);
    EXPECT_NE(at, std::string::npos);
    std::memcpy(&bytes[at + after.size() + skip], words.data(), 4 * words.size());
    return bytes;
}

/// An EXR with one more attribute, before all others.
std::string with_attribute(const std::string& exr, const std::string& name, const std::string& type,
                           const std::string& value) {
    const auto size = static_cast<uint32_t>(value.size());
    std::string attribute = name + '\0' + type + '\0';
    for (int shift = 0; shift < 32; shift += 8) attribute += static_cast<char>(size >> shift & 255);
    return exr.substr(0, 8) + attribute + value + exr.substr(8);
}

TEST(FloatPicture, HeadersThatAskForTooMuchOrForOthersAreRefused) {
    using namespace std::string_literals;
    const std::string exr = make_exr(4, 3, {"R", "G", "B"}, std::vector<float>(36, 0.5f));
    const std::string tiled = read_text(fs::path(ZOETROPE_SOURCE_DIR) / "tests/fuzz/seeds/tiled.exr");
    const std::string data = "dataWindow\0box2i\0\x10\0\0\0"s, tile = "tiles\0tiledesc\0\x09\0\0\0"s;
    const std::string shown = "displayWindow\0box2i\0\x10\0\0\0"s, magic = "\x76\x2f\x31\x01";
    constexpr int32_t kFar = std::numeric_limits<int32_t>::max();
    const std::pair<std::string, std::string> cases[] = {
        {forged(exr, data, 0, {0, 0, 16384, 0}), "16385 x 1 pixels; 16384 a side are allowed"},
        {forged(exr, data, 0, {0, 0, 0, 16384}), "1 x 16385 pixels; 16384 a side are allowed"},
        {forged(exr, data, 0, {-kFar, -kFar, kFar, kFar}), "4294967295 x 4294967295 pixels; 16384 a side are allowed"},
        {forged(exr, data, 0, {3, 3, 0, 0}), "-2 x -2 pixels; 16384 a side are allowed"},
        {forged(exr, shown, 0, {0, 0, 7, 2}), "an EXR that holds another window than it shows"},
        {forged(exr, magic, 0, {0x1002}), "an EXR of several parts"},
        {forged(exr, magic, 0, {0x802}), "a deep EXR"},
        {forged(exr, magic, 0, {3}), "an EXR of another version than 2"},
        {forged(exr, magic, 0, {0x202}), "an EXR of tiles that does not say their size"},
        {forged(exr, "channels\0chlist\0"s, 0, {kFar}), "an EXR whose header is damaged"},
        {forged(exr, "\0B\0"s, 0, {0}), "an EXR with a channel of whole numbers"},
        {forged(exr, "\0B\0"s, 8, {2, 2}), "an EXR with a channel of fewer pixels"},
        {forged(tiled, tile, 0, {1, 1}), "an EXR of tiles of 1 x 1 pixels; multiples of 16 up to 512 are read"},
        {forged(tiled, tile, 0, {16, 528}), "an EXR of tiles of 16 x 528 pixels; multiples of 16 up to 512 are read"},
        {forged(forged(tiled, data, 0, {0, 0, 9999, 9999}), shown, 0, {0, 0, 9999, 9999}),
         "an EXR of more tiles than its bytes have room for"},
        {make_exr(1, 1, {"R", "G", "B", "C", "D", "E", "F", "H", "I", "J", "K", "L", "M", "N", "O", "P", "Q"},
                  std::vector<float>(17)),
         "an EXR of more than 16 channels"},
        {exr.substr(0, 60), "an EXR whose header is damaged"},
        // OpenEXR would read four bytes of it, and take the rest for attributes.
        {with_attribute(exr, "other", "float", "\0\0\0\0owner\0string\0\xf0\xff\xff\x7f"s),
         "an EXR whose header is damaged"},
        {with_attribute(exr, "other", "m44d", "short"), "an EXR whose header is damaged"},
        {with_attribute(exr, "other", "floatvector", "12345"), "an EXR whose header is damaged"},
        {with_attribute(exr, "other", "chlist", "\0"s), "an EXR whose header is damaged"},
        {with_attribute(exr, "other", "preview", "\x02\0\0\0\x02\0\0\0four"s), "an EXR whose header is damaged"},
        {with_attribute(exr, "channels", "chlist", "\0"s), "an EXR that says something twice"},
        {make_hdr(1, 1, "abcd", "-Y {} -X {}"), "an HDR picture that is turned or mirrored"},
        {make_hdr(20000, 2'000'000'000, ""), "20000 x 2000000000 pixels; 16384 a side are allowed"},
    };
    Image image;
    EXPECT_EQ(decode(exr, &image), "");
    EXPECT_NE(decode(with_attribute(exr, "other", "string", "anything"), &image), "an EXR whose header is damaged");
    for (const auto& [bytes, expected] : cases) {
        reset_peak_bytes();
        const size_t before = live_bytes();
        EXPECT_EQ(decode(bytes, &image), expected);
        EXPECT_LT(peak_bytes() - before, size_t{1} << 20) << expected;
        EXPECT_EQ(image, Image{});
    }
}

TEST(FloatPicture, DecodingTakesLittleMoreThanTheImage) {
    constexpr size_t kSide = 1536, kBuffer = size_t{64} << 20;  // OpenImageIO converts in one of those, of any picture.
    const std::string bytes = make_exr(kSide, kSide, {"R", "G", "B"}, std::vector<float>(kSide * kSide * 3, 0.5f));
    Image image;
    EXPECT_EQ(decode(bytes, &image), "");  // So that libraries have what they keep.
    for (const int halvings : {0, 1}) {
        image = {};
        reset_peak_bytes();
        const size_t before = live_bytes();
        EXPECT_EQ(decode(bytes, &image, 2 * kSide * kSide - static_cast<size_t>(halvings)), "");
        EXPECT_EQ(image.halvings, halvings);
        EXPECT_LT(peak_bytes() - before, image.pixels.size() + kBuffer + (size_t{6} << 20)) << halvings;
    }
}

TEST(FloatPicture, EveryPrefixIsRefused) {
    Rng rng(61);
    std::vector<float> values(20 * 20 * 3);
    for (float& value : values) value = rng.uniform();
    std::string rgbe(20 * 20 * 4, '\0');
    for (char& byte : rgbe) byte = static_cast<char>(rng.below(256));
    for (const std::string& bytes : {make_exr(20, 20, {"R", "G", "B"}, values), make_hdr(20, 20, rgbe)}) {
        Image image;
        EXPECT_EQ(decode(bytes, &image), "");
        for (size_t size = 0; size < bytes.size(); size += 1 + size / 50) {
            EXPECT_NE(decode(bytes.substr(0, size), &image), "") << size;
        }
    }
}

TEST(FloatPicture, LevelsAverageNumbers) {
    Image image{.is_half = true, .width = 2, .height = 1};
    for (const float number : {0.0f, 1.0f, 9.0f, 0.5f, 1.0f, 3.0f, 0.0f, 1.0f}) {
        const uint16_t half = half_from_float(number);
        for (const int shift : {0, 8}) image.pixels.push_back(static_cast<uint8_t>(half >> shift));
    }
    make_levels(&image);
    ASSERT_EQ(image.coarser.size(), 1u);
    EXPECT_EQ(numbers_of(image.coarser[0].pixels), (std::vector<float>{0.5f, 2.0f, 4.5f, 0.75f}));
    EXPECT_EQ(image.pixels.size(), 16u);
    // The largest stays one.
    const uint16_t largest[] = {kHalfLargest, kHalfLargest, kHalfLargest, kHalfLargest};
    ImageLevel bright{3, 3, std::vector<uint8_t>(9 * sizeof largest)};
    for (size_t i = 0; i < 9; ++i) std::memcpy(&bright.pixels[i * sizeof largest], largest, sizeof largest);
    for (const float number : numbers_of(halved(bright, true, true).pixels)) EXPECT_EQ(number, 65504.0f);
}

TEST(FloatPicture, PixelsCountTwiceWhereTheyAreHalved) {
    Rng rng(62);
    std::vector<float> values(8 * 6);
    double mean = 0.0;
    for (float& value : values) mean += double(value = rng.uniform()) / 48.0;
    const std::string bytes = make_exr(8, 6, {"Y"}, values);
    Image image;
    EXPECT_EQ(decode(bytes, &image, 96), "");
    EXPECT_EQ(image.halvings, 0);
    EXPECT_EQ(decode(bytes, &image, 95), "");
    EXPECT_EQ(image.halvings, 1);
    EXPECT_EQ(image.width, 4);
    EXPECT_EQ(image.height, 3);
    double half_mean = 0.0;
    const std::vector<float> numbers = numbers_of(image.pixels);
    ASSERT_EQ(numbers.size(), 48u);
    for (size_t i = 0; i < 48; i += 4) half_mean += double(numbers[i]) / 12.0;
    EXPECT_NEAR(half_mean, mean, 1e-3);
    EXPECT_NE(decode(bytes, &image, 1), "");
}

std::string base64(const std::string& bytes) {
    const std::string letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (size_t i = 0; i < bytes.size(); i += 3) {
        uint32_t word = 0;
        for (size_t k = 0; k < 3; ++k) word = word << 8 | (i + k < bytes.size() ? static_cast<uint8_t>(bytes[i + k]) : 0u);
        for (size_t k = 0; k < 4; ++k) text += i + k > bytes.size() ? '=' : letters[word >> (18 - 6 * k) & 63];
    }
    return text;
}

// From a file, a buffer view and a data URI, shown in each way.
TEST(FloatPicture, ScenesShowThem) {
    const float none = std::numeric_limits<float>::quiet_NaN();
    const std::string exr = make_exr(2, 1, {"R", "G", "B"}, {5, none, 0.5f, 0.25f, 1, -1});
    const TempFolder folder;
    folder.write("a.exr", exr);
    folder.write("broken.exr", exr.substr(0, exr.size() - 5));
    GlbBuilder glb;
    glb.push("images", {{"uri", "a.exr"}});
    glb.push("images", {{"bufferView", glb.view(exr.data(), exr.size())}, {"mimeType", "image/x-exr"}});
    glb.push("images", {{"uri", "data:image/x-exr;base64," + base64(exr)}});
    glb.push("images", {{"uri", "broken.exr"}});
    for (int i = 0; i < 4; ++i) glb.push("textures", {{"source", i}});
    glb.push("materials", {{"emissiveTexture", {{"index", 0}}}, {"emissiveFactor", {1, 1, 1}}});
    glb.push("materials", {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 1}}}}}});
    glb.push("materials", {{"normalTexture", {{"index", 2}}}});
    glb.push("materials", {{"emissiveTexture", {{"index", 3}}}});
    folder.write("scene.glb", glb.glb());
    const Scene scene = load_gltf(folder / "scene.glb");
    EXPECT_EQ(check(scene), "");
    EXPECT_EQ(numbers_of(scene.images[0].pixels), (std::vector<float>{5, 0, 0.5f, 1, 0.25f, 1, 0, 1}));
    for (size_t i : {1, 2}) {
        EXPECT_EQ(numbers_of(scene.images[i].pixels), (std::vector<float>{1, 0, 0.5f, 1, 0.25f, 1, 0, 1})) << i;
    }
    EXPECT_TRUE(scene.images[3].pixels.empty());
    const char* expected[] = {"/images/0 (a.exr): 2 of its numbers are not from 0 to 65504, or of alpha to 1: replaced",
                              "/images/1: 3 of its numbers are not from 0 to 1: replaced",
                              "/images/2 (data URI): 3 of its numbers are not from 0 to 1: replaced",
                              "/images/3 (broken.exr): "};
    ASSERT_EQ(scene.warnings().size(), std::size(expected));
    auto warning = scene.warnings().begin();
    for (const char* text : expected) {
        EXPECT_NE(warning->first.find(text), std::string::npos) << warning->first;
        EXPECT_EQ(warning++->second, 1u);
    }
}

TEST(FloatPicture, TheyShareTheLimitOfImages) {
    const TempFolder folder;
    folder.write("a.exr", make_exr(8, 8, {"Y"}, std::vector<float>(64, 0.5f)));
    write_png(folder / "a.png", 8, 8, std::vector<uint8_t>(256, 128));
    GlbBuilder glb;
    for (const char* uri : {"a.png", "a.exr", "./a.exr"}) {
        glb.push("textures", {{"source", glb.push("images", {{"uri", uri}})}});
        glb.push("materials", {{"emissiveTexture", {{"index", int(glb.json["textures"].size()) - 1}}}});
    }
    folder.write("scene.glb", glb.glb());
    struct Case {
        uint64_t max_pixels;
        int sides[3];
    };
    for (const Case& expected : {Case{320, {8, 8, 8}}, Case{319, {8, 4, 8}}, Case{223, {8, 4, 4}}, Case{127, {4, 4, 4}}}) {
        const Scene scene = load_gltf(folder / "scene.glb", {.max_pixels = expected.max_pixels});
        EXPECT_LE(byte_count(scene.images), expected.max_pixels * 4 * 3 / 2);
        for (size_t i = 0; i < 3; ++i) EXPECT_EQ(scene.images[i].width, expected.sides[i]) << i;
        EXPECT_EQ(check(scene), "");
    }
}

}  // namespace
}  // namespace zoe::test
