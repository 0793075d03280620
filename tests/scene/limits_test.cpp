#include <filesystem>

#include <gtest/gtest.h>

#include "tests/scene/glb_builder.h"
#include "tests/support/allocation_count.h"

namespace zoe::test {
namespace {

namespace fs = std::filesystem;

TEST(GltfLimits, SmallFilesDoNotFillTheMemory) {
    const std::string reason = "far more data than the file holds bytes";
    GlbBuilder shared;  // Many meshes that show one large accessor which no bytes back.
    const int zeros = shared.accessor_of(-1, kFloat, "VEC3", 3000000);
    for (int i = 0; i < 100; ++i) shared.mesh({{"attributes", {{"POSITION", zeros}}}});
    EXPECT_NE(shared.error().find(reason), std::string::npos);

    GlbBuilder repeated;  // Many primitives without indices over the same vertices.
    repeated.mesh({{"attributes", {{"POSITION", repeated.accessor_of(-1, kFloat, "VEC3", 3000000)}}}});
    nlohmann::json& primitives = repeated.json["meshes"][0]["primitives"];
    for (int i = 0; i < 100; ++i) primitives.push_back(primitives[0]);
    EXPECT_NE(repeated.error().find(reason), std::string::npos);

    GlbBuilder targets;  // Morph targets that are filled in for the primitives that name none.
    const int few = targets.accessor_of(-1, kFloat, "VEC3", 3);
    const int many = targets.accessor_of(-1, kFloat, "VEC3", 1000000);
    nlohmann::json with = nlohmann::json::array(), without = nlohmann::json::array();
    for (int i = 0; i < 1000; ++i) {
        with.push_back({{"POSITION", few}});
        without.push_back(nlohmann::json::object());
    }
    targets.push("meshes", {{"primitives",
                             {{{"attributes", {{"POSITION", few}}}, {"targets", with}},
                              {{"attributes", {{"POSITION", many}}}, {"targets", without}}}}});
    EXPECT_NE(targets.error().find(reason), std::string::npos);

    GlbBuilder instances;
    instances.triangle();
    instances.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["TRANSLATION"] =
        instances.accessor_of(-1, kFloat, "VEC3", 4000000);
    EXPECT_NE(instances.error().find("/nodes/0/extensions/EXT_mesh_gpu_instancing"), std::string::npos);
}

// Numbers that a file can name in a few bytes, wherever it names one.
TEST(GltfLimits, NumbersBeyondAllReasonTakeNoMemory) {
    // As many numbers as a small file may yield, in lists that grow; what is beyond them takes nothing.
    constexpr size_t kMostBytes = 1 << 20, kMostBytesOfNumbers = 1 << 26;
    GlbBuilder plain;
    plain.triangle();
    nlohmann::json& accessor = plain.json["accessors"][0];
    const uint16_t index = 0;
    const float value[3] = {};
    accessor["sparse"] = {{"count", 1},
                          {"indices", {{"bufferView", plain.view(&index, sizeof index)}, {"componentType", kUshort}}},
                          {"values", {{"bufferView", plain.view(value, sizeof value)}}}};
    accessor["byteOffset"] = 0;
    plain.json["bufferViews"][0]["byteStride"] = 12;
    plain.json["buffers"] = {{{"byteLength", plain.binary.size()}}};
    ASSERT_EQ(plain.error(), "");
    const auto expect_refused = [](const GlbBuilder& glb, size_t most_bytes) {
        reset_peak_bytes();
        const size_t before = live_bytes();
        EXPECT_NE(glb.error(), "");
        EXPECT_LT(peak_bytes() - before, most_bytes);
    };
    for (const int bits : {24, 31, 32, 40, 53, 63}) {
        const uint64_t number = (uint64_t{1} << bits) - 1;
        const size_t most_bytes = bits == 24 ? kMostBytesOfNumbers : kMostBytes;
        for (const char* place :
             {"/accessors/0/count", "/accessors/0/byteOffset", "/accessors/0/sparse/count", "/bufferViews/0/byteLength",
              "/bufferViews/0/byteOffset", "/bufferViews/0/byteStride", "/buffers/0/byteLength"}) {
            SCOPED_TRACE(testing::Message() << place << " 2^" << bits << " - 1");
            GlbBuilder glb = plain;
            glb.json[nlohmann::json::json_pointer(place)] = number;
            expect_refused(glb, most_bytes);
        }
        SCOPED_TRACE(testing::Message() << "zeros, 2^" << bits << " - 1");
        GlbBuilder zeros = plain;
        zeros.json["accessors"][0] = {{"componentType", kFloat}, {"type", "VEC3"}, {"count", number}};
        expect_refused(zeros, most_bytes);
    }
}

// The default lets a file of a few hundred bytes take some megabytes; who trusts a file may let it have more, or none.
TEST(GltfLimits, FreeNumbersAreAnOption) {
    constexpr uint64_t kCount =
        99'999;  // Vertices, of whole triangles: three numbers each, and one for the corner that it is.
    GlbBuilder glb;
    glb.mesh({{"attributes", {{"POSITION", glb.accessor_of(-1, kFloat, "VEC3", kCount)}}}});
    glb.push("nodes", {{"mesh", 0}});
    ASSERT_LT(glb.glb().size(), 300u);
    reset_peak_bytes();
    const size_t before = live_bytes();
    EXPECT_EQ(glb.load().meshes[0].positions.size(), kCount);
    EXPECT_LT(peak_bytes() - before, 20 * 4 * kCount);
    EXPECT_EQ(glb.load({.max_free_numbers = 5 * kCount}).meshes[0].positions.size(), kCount);
    for (const uint64_t fewer : {uint64_t{0}, 3 * kCount, 4 * kCount}) {
        EXPECT_THROW(glb.load({.max_free_numbers = fewer}), SceneError) << fewer;
    }
    glb.json["accessors"][0]["count"] = 10 * kCount;
    EXPECT_NE(glb.error(), "");
    EXPECT_EQ(glb.load({.max_free_numbers = 50 * kCount}).meshes[0].positions.size(), 10 * kCount);
}

TEST(GltfLimits, BuffersThatNameOneFileShareItsBytes) {
    const TempFolder folder;
    write_file(folder / "a.bin", std::string(1 << 20, '\0'));
    GlbBuilder glb;
    for (int i = 0; i < 1000; ++i) {
        std::string uri = "a.bin";
        for (int k = 0; k < i % 3; ++k) uri = "./" + uri;  // The same file by other names.
        glb.push("buffers", {{"byteLength", i % 2 == 0 ? 1 << 20 : 12}, {"uri", uri}});
    }
    glb.push("bufferViews", {{"buffer", 998}, {"byteOffset", 36}, {"byteLength", 36}});
    glb.mesh({{"attributes", {{"POSITION", glb.accessor_of(0, kFloat, "VEC3", 3)}}}});
    write_file(folder / "scene.gltf", glb.json.dump());
    EXPECT_EQ(load_error(folder / "scene.gltf"), "");

    // More numbers than one megabyte backs, fewer than a thousand would.
    GlbBuilder zeros = glb;
    zeros.mesh({{"attributes", {{"POSITION", zeros.accessor_of(-1, kFloat, "VEC3", 12000000)}}}});
    write_file(folder / "zeros.gltf", zeros.json.dump());
    EXPECT_NE(load_error(folder / "zeros.gltf").find("far more data than the file holds bytes"), std::string::npos);

    glb.json["bufferViews"][0]["buffer"] = 999;  // Its own length counts, not the file's.
    write_file(folder / "scene.gltf", glb.json.dump());
    EXPECT_NE(load_error(folder / "scene.gltf").find("/bufferViews/0"), std::string::npos);
}

TEST(GltfLimits, TheBuffersTogetherHaveALimit) {
    const TempFolder folder;
    write_file(folder / "small.bin", std::string(64, '\0'));
    write_file(folder / "large.bin", "");
    fs::resize_file(folder / "large.bin", (uint64_t{1} << 32) - 64);  // A hole: no bytes on the disk.
    GlbBuilder glb;
    glb.push("buffers", {{"byteLength", 64}, {"uri", "small.bin"}});
    glb.push("buffers", {{"byteLength", 64}, {"uri", "large.bin"}});
    write_file(folder / "scene.gltf", glb.json.dump());
    const std::string error = load_error(folder / "scene.gltf");
    EXPECT_NE(error.find("/buffers/1/uri: large.bin: more than 4294967296 bytes"), std::string::npos) << error;
}

TEST(GltfLimits, InstancesAreAsManyAsTheFileBacks) {
    constexpr size_t kLimit = 100000;
    const auto glb_of = [](size_t count, bool is_backed) {
        GlbBuilder glb;
        glb.triangle();
        const int accessor =
            is_backed ? glb.floats(std::vector<float>(3 * count, 0.0f), "VEC3") : glb.accessor_of(-1, kFloat, "VEC3", count);
        glb.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["TRANSLATION"] = accessor;
        return glb;
    };
    EXPECT_EQ(glb_of(kLimit, false).load().nodes.size(), kLimit + 1);
    const std::string error = glb_of(kLimit + 1, false).error();
    EXPECT_NE(error.find("/nodes/0/extensions/EXT_mesh_gpu_instancing/attributes/TRANSLATION: 100001 instances"),
              std::string::npos)
        << error;
    EXPECT_EQ(glb_of(kLimit + 50000, true).load().nodes.size(), kLimit + 50001);

    GlbBuilder two_nodes = glb_of(60000, false);
    two_nodes.push("nodes", two_nodes.json["nodes"][0]);
    EXPECT_NE(two_nodes.error().find("/nodes/1/"), std::string::npos);
}

TEST(GltfLimits, NodesThatShowZerosAreCounted) {
    GlbBuilder glb;
    glb.mesh({{"attributes", {{"POSITION", glb.accessor_of(-1, kFloat, "VEC3", 300000)}}}});
    for (int i = 0; i < 5; ++i) glb.push("nodes", {{"mesh", 0}});
    EXPECT_EQ(glb.error(), "");
    for (int i = 0; i < 20; ++i) glb.push("nodes", {{"mesh", 0}});
    const std::string error = glb.error();
    EXPECT_NE(error.find("/nodes/"), std::string::npos) << error;
    EXPECT_NE(error.find("far more data than the file holds bytes"), std::string::npos) << error;
}

TEST(GltfLimits, ImagesShareTheirPixelsAndTheirLimit) {
    const TempFolder folder;
    const std::vector<uint8_t> grey(8 * 8 * 4, 128);
    write_png(folder / "a.png", 8, 8, grey);
    GlbBuilder glb;
    for (const char* uri : {"a.png", "./a.png", "a.png", "missing.png", "missing.png"}) {
        const int image = glb.push("images", {{"uri", uri}});
        const int texture = glb.push("textures", {{"source", image}});
        glb.push("materials", {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", texture}}}}}});
    }
    write_file(folder / "scene.gltf", glb.json.dump());
    const Scene whole = load_gltf(folder / "scene.gltf");
    for (size_t i = 0; i < 3; ++i) EXPECT_EQ(whole.images[i].pixels, grey) << i;
    EXPECT_EQ(whole.images[2].width, 8);
    EXPECT_EQ(whole.warnings().size(), 2u) << "the missing ones";

    // The largest are halved, of equal ones the first; every one that was is told of.
    struct Case {
        uint64_t max_pixels;
        int sides[3];
    };
    for (const Case& expected :
         {Case{3 * 64 - 1, {4, 8, 8}}, Case{64, {4, 4, 4}}, Case{12, {2, 2, 2}}, Case{2, {1, 1, 0}}}) {
        const Scene scene = load_gltf(folder / "scene.gltf", {.max_pixels = expected.max_pixels});
        size_t halved = 0;
        for (size_t i = 0; i < 3; ++i) {
            EXPECT_EQ(scene.images[i].width, expected.sides[i]) << i;
            EXPECT_EQ(scene.images[i].pixels, std::vector<uint8_t>(scene.images[i].pixels.size(), 128));
            halved += expected.sides[i] < 8 ? 1 : 0;
        }
        EXPECT_EQ(scene.warnings().size(), 2u + halved);
        EXPECT_EQ(check(scene), "");
    }
}

// Many names for one picture, and many pictures: never much more in memory than what stays.
TEST(GltfLimits, ImagesTakeNoMoreMemoryWhileTheyAreRead) {
    constexpr int kSide = 256;
    constexpr uint64_t kPixels = uint64_t{kSide} * kSide;
    const auto peak_of = [&](int count, bool is_one) {
        const TempFolder folder;
        GlbBuilder glb;
        for (int i = 0; i < count; ++i) {
            const std::string name = is_one ? "a.png" : std::to_string(i) + ".png";
            write_png(folder / name, kSide, kSide, std::vector<uint8_t>(4 * kPixels, static_cast<uint8_t>(i)));
            const int image = glb.push("images", {{"uri", name}});
            const int texture = glb.push("textures", {{"source", image}});
            glb.push("materials", {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", texture}}}}}});
        }
        write_file(folder / "scene.gltf", glb.json.dump());
        reset_peak_bytes();
        const size_t before = live_bytes();
        const Scene scene = load_gltf(folder / "scene.gltf", {.max_pixels = 2 * kPixels});
        uint64_t kept = 0;
        for (const Image& image : scene.images) {
            EXPECT_GT(image.width, 0);
            kept += image.pixels.size() / 4;
        }
        EXPECT_LE(kept, 2 * kPixels);
        EXPECT_GT(kept, kPixels / 2);
        return peak_bytes() - before;
    };
    const size_t of_one = peak_of(1, true);  // With what OpenImageIO takes for itself.
    // Two images and a third more for levels are the limit, and one is in `of_one`, without levels. A third would be too
    // many.
    constexpr size_t kOneImage = 4 * kPixels * 4 / 3;
    for (const bool is_one : {true, false}) EXPECT_LT(peak_of(24, is_one), of_one + kOneImage * 7 / 4) << is_one;
}

/// What a broken file's header says of its size halves no other image.
TEST(GltfLimits, ImagesMakeNoRoomForWhatIsNotThere) {
    const TempFolder folder;
    write_png(folder / "a.png", 64, 64, std::vector<uint8_t>(64 * 64 * 4, 7));
    folder.write("b.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 64 +X 64\n");
    GlbBuilder glb;
    for (const char* const uri : {"a.png", "b.hdr"}) {
        const int texture = glb.push("textures", {{"source", glb.push("images", {{"uri", uri}})}});
        glb.push("materials", {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", texture}}}}}});
    }
    write_file(folder / "scene.gltf", glb.json.dump());
    const Scene scene = load_gltf(folder / "scene.gltf", {.max_pixels = 2 * 64 * 64});
    EXPECT_EQ(scene.images[0].width, 64);
    EXPECT_EQ(scene.images[1].width, 0);
    EXPECT_EQ(scene.warnings().size(), 1u);
}

TEST(GltfLimits, ImagesFarBeyondTheLimitAreNotDecoded) {
    const TempFolder folder;
    write_png(folder / "a.png", 64, 64, std::vector<uint8_t>(64 * 64 * 4, 7));
    GlbBuilder glb;
    glb.push("images", {{"uri", "a.png"}});
    glb.push("textures", {{"source", 0}});
    glb.push("materials", {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
    write_file(folder / "scene.gltf", glb.json.dump());
    const Scene halved = load_gltf(folder / "scene.gltf", {.max_pixels = 64});
    EXPECT_EQ(halved.images[0].width, 8);
    EXPECT_EQ(halved.images[0].halvings, 3);
    EXPECT_EQ(halved.images[0].pixels, std::vector<uint8_t>(8 * 8 * 4, 7));
    const Scene none = load_gltf(folder / "scene.gltf", {.max_pixels = 63});
    EXPECT_EQ(none.images[0].pixels.capacity(), 0u);
    EXPECT_EQ(none.warnings().size(), 1u);
}

}  // namespace
}  // namespace zoe::test
