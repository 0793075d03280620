#include <filesystem>

#include <gtest/gtest.h>

#include "engine/math/rng.h"
#include "tests/scene/glb_builder.h"

namespace zoe::test {
namespace {

namespace fs = std::filesystem;

/// Loads bytes; whatever they are, the outcome is a sound scene or one line that names the file.
bool loads_or_explains(const TempFolder& folder, const std::string& bytes) {
    const fs::path file = folder / "scene.glb";
    write_file(file, bytes);
    try {
        const Scene scene = load_gltf(file);
        EXPECT_EQ(check(scene), "");
        return true;
    } catch (const SceneError& error) {
        const std::string message = error.what();
        EXPECT_EQ(message.find(file.string() + ": "), 0u) << message;
        EXPECT_EQ(message.find('\n'), std::string::npos) << message;
        return false;
    }
}

TEST(GltfFile, WhatIsNoGltfIsRefusedInOneLine) {
    const TempFolder folder;
    EXPECT_NE(load_error(folder / "missing.glb").find("there is no such file"), std::string::npos);
    EXPECT_NE(load_error(folder.path()).find("it is a directory"), std::string::npos);
    for (const char* text : {"", "g", "glTF", "hello, world", "{", "[]", "null", "{}", "{\"asset\":1}", "\xff\xfe"}) {
        EXPECT_FALSE(loads_or_explains(folder, text)) << text;
        write_file(folder / "scene.gltf", text);
        EXPECT_NE(load_error(folder / "scene.gltf"), "") << text;
    }
}

TEST(GltfFile, EveryTruncationIsRefused) {
    const TempFolder folder;
    const std::string glb = make_rich_glb().glb();
    ASSERT_TRUE(loads_or_explains(folder, glb));
    for (size_t size = 0; size < glb.size(); ++size) {
        EXPECT_FALSE(loads_or_explains(folder, glb.substr(0, size))) << size;
    }
}

TEST(GltfFile, EveryTruncatedGltfIsRefused) {
    const TempFolder folder;
    GlbBuilder glb;
    glb.triangle();
    glb.json["buffers"] = {{{"byteLength", 36},
                            {"uri",
                             "data:application/octet-stream;base64,"
                             "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}}};
    const std::string text = glb.json.dump();
    write_file(folder / "scene.gltf", text);
    EXPECT_EQ(load_error(folder / "scene.gltf"), "");
    EXPECT_EQ(load_gltf(folder / "scene.gltf").meshes[0].positions[1], glm::vec3(1, 0, 0));
    for (size_t size = 0; size < text.size(); ++size) {
        write_file(folder / "scene.gltf", text.substr(0, size));
        EXPECT_NE(load_error(folder / "scene.gltf"), "") << size;
    }
}

TEST(GltfFile, MutationsLoadOrAreRefused) {
    const uint64_t seed = 20250314;
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const TempFolder folder;
    const std::string original = make_rich_glb().glb();
    Rng rng(seed);
    int loaded = 0;
    for (int round = 0; round < 4000; ++round) {
        std::string bytes = original;
        const uint32_t change_count = 1 + rng.below(4);
        for (uint32_t i = 0; i < change_count; ++i) {
            const uint32_t at = rng.below(static_cast<uint32_t>(bytes.size()));
            switch (rng.below(4)) {
                case 0:
                    bytes[at] = static_cast<char>(rng.below(256));
                    break;
                case 1:
                    bytes[at] = static_cast<char>('0' + rng.below(10));
                    break;
                case 2:
                    bytes[at] = static_cast<char>(bytes[at] ^ 1 << rng.below(8));
                    break;
                default:
                    std::swap(bytes[at], bytes[rng.below(static_cast<uint32_t>(bytes.size()))]);
            }
        }
        loaded += loads_or_explains(folder, bytes);
        if (HasFailure()) FAIL() << "round " << round;
    }
    EXPECT_GT(loaded, 100);
    EXPECT_LT(loaded, 3900);
}

TEST(GltfFile, MutatedNumbersInTheJsonLoadOrAreRefused) {
    const uint64_t seed = 577215;
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const TempFolder folder;
    const GlbBuilder original = make_rich_glb();
    const nlohmann::json flat = original.json.flatten();
    const std::vector<nlohmann::json> values = {0,
                                                1,
                                                2,
                                                3,
                                                -1,
                                                255,
                                                65535,
                                                2147483647,
                                                4294967296.0,
                                                1e300,
                                                0.5,
                                                true,
                                                nullptr,
                                                "",
                                                "x",
                                                nlohmann::json::array(),
                                                nlohmann::json::object()};
    Rng rng(seed);
    for (const auto& [pointer, unused] : flat.items()) {
        for (const nlohmann::json& value : values) {
            GlbBuilder glb = original;
            glb.json[nlohmann::json::json_pointer(pointer)] = value;
            if (rng.below(2) == 0) {
                auto other = flat.begin();
                std::advance(other, rng.below(static_cast<uint32_t>(flat.size())));
                const nlohmann::json::json_pointer at(other.key());
                if (glb.json.contains(at)) glb.json[at] = values[rng.below(static_cast<uint32_t>(values.size()))];
            }
            loads_or_explains(folder, glb.glb());
            if (HasFailure()) FAIL() << pointer << " = " << value;
        }
    }
}

TEST(GltfFile, DeepJsonIsRefused) {
    const TempFolder folder;
    for (const size_t depth : {300u, 100000u}) {
        for (const char bracket : {'[', '{'}) {
            std::string text = "{\"asset\":{\"version\":\"2.0\"},\"extras\":";
            for (size_t i = 0; i < depth; ++i) text += bracket == '[' ? "[" : "{\"a\":";
            write_file(folder / "deep.gltf", text);
            EXPECT_NE(load_error(folder / "deep.gltf").find("nested deeper"), std::string::npos);
        }
    }
}

TEST(GltfFile, LyingGlbLengthsAreRefused) {
    const TempFolder folder;
    const std::string glb = make_rich_glb().glb();
    const size_t json_size = static_cast<size_t>(static_cast<unsigned char>(glb[12])) |
                             static_cast<size_t>(static_cast<unsigned char>(glb[13])) << 8;
    std::string longer = glb;
    longer[20 + json_size] = static_cast<char>(longer[20 + json_size] + 8);
    EXPECT_FALSE(loads_or_explains(folder, longer)) << "a BIN chunk eight bytes too long";
    std::string header = glb;
    header[8] = static_cast<char>(header[8] + 4);
    EXPECT_FALSE(loads_or_explains(folder, header));
    std::string version = glb;
    version[4] = 1;
    EXPECT_FALSE(loads_or_explains(folder, version));
    EXPECT_TRUE(loads_or_explains(folder, glb + "rest"));
}

TEST(GltfFile, VersionsOtherThanTwoAreRefused) {
    for (const char* version : {"1.0", "3.0", "two", "2", "2.0.1", ""}) {
        GlbBuilder glb;
        glb.json["asset"]["version"] = version;
        EXPECT_NE(glb.error().find("/asset/version"), std::string::npos) << version;
    }
    GlbBuilder later;
    later.json["asset"] = {{"version", "2.1"}, {"minVersion", "2.0"}};
    EXPECT_EQ(later.error(), "");
    later.json["asset"]["minVersion"] = "2.1";
    EXPECT_NE(later.error().find("/asset/minVersion"), std::string::npos);
}

TEST(GltfFile, WhatAFileSaysIsShownInOnePlainLine) {
    const TempFolder folder;
    const std::string hostile = "a\nb\r\x1b[2J\x7f\xc2\x9b\t" + std::string("\0c", 2) + std::string(5000, 'x');
    const auto expect_plain = [](const std::string& text) {
        EXPECT_NE(text, "");
        EXPECT_LT(text.size(), 2000u);
        EXPECT_EQ(text.find("\xc2\x9b"), std::string::npos);
        for (const char c : text) EXPECT_TRUE(static_cast<unsigned char>(c) >= ' ' && c != '\x7f') << text;
    };
    GlbBuilder version, required, mode, uri, used;
    version.json["asset"]["version"] = hostile;
    required.json["extensionsRequired"] = {hostile};
    mode.push("accessors", {{"componentType", kFloat}, {"count", 1}, {"type", hostile}});
    uri.push("buffers", {{"byteLength", 1}, {"uri", hostile}});
    for (const GlbBuilder& glb : {version, required, mode, uri}) expect_plain(glb.error());
    GlbBuilder attribute;
    attribute.triangle();
    attribute.json["meshes"][0]["primitives"][0]["attributes"][hostile] = 77;
    expect_plain(attribute.error());
    used.triangle();
    used.json["extensionsUsed"] = {hostile};
    const Scene scene = used.load();
    ASSERT_EQ(scene.warnings().size(), 1u);
    expect_plain(scene.warnings().begin()->first);
}

TEST(GltfFile, RequiredExtensionsThatAreNotSupportedAreNamed) {
    for (const char* name : {"KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_texture_basisu", "VENDOR_x"}) {
        GlbBuilder glb;
        glb.triangle();
        glb.json["extensionsUsed"] = {name};
        EXPECT_EQ(glb.load().warnings().size(), 1u);
        glb.json["extensionsRequired"] = {name};
        const std::string error = glb.error();
        EXPECT_NE(error.find("/extensionsRequired/0"), std::string::npos) << error;
        EXPECT_NE(error.find(name), std::string::npos) << error;
    }
}

TEST(GltfFile, BuffersAreReadInsideTheFolderOnly) {
    const TempFolder folder;
    fs::create_directories(folder / "in/side");
    const std::string data(36, '\0');
    write_file(folder / "secret.bin", data);
    write_file(folder / "in/a b.bin", data);
    write_file(folder / "in/side/deep.bin", data);
    fs::create_symlink(folder / "secret.bin", folder / "in/link.bin");
    fs::create_directory_symlink(folder.path(), folder / "in/up");
    GlbBuilder glb;
    glb.triangle();
    const auto error = [&](const std::string& uri) {
        glb.json["buffers"] = {{{"byteLength", 36}, {"uri", uri}}};
        write_file(folder / "in/scene.gltf", glb.json.dump());
        return load_error(folder / "in/scene.gltf");
    };
    EXPECT_EQ(error("a%20b.bin"), "");
    EXPECT_EQ(error("a b.bin"), "");
    EXPECT_EQ(error("./side/deep.bin"), "");
    for (const std::string& uri :
         {std::string("../secret.bin"), std::string("side/../../secret.bin"), std::string("%2e%2e/secret.bin"),
          std::string("%2E%2E%2Fsecret.bin"), (folder / "secret.bin").string(), std::string("link.bin"),
          std::string("up/secret.bin"), "file://" + (folder / "secret.bin").string(), std::string("http://host/secret.bin"),
          std::string("missing.bin"), std::string("side"), std::string(""), std::string("/dev/zero"),
          std::string("data:application/octet-stream;base64,AAAA"), std::string("data:application/octet-stream;base64,A*"),
          std::string("data:nothing")}) {
        const std::string message = error(uri);
        EXPECT_NE(message.find("/buffers/0"), std::string::npos) << uri << ": " << message;
    }
}

TEST(GltfFile, ImagesOutsideTheFolderAreNotRead) {
    const TempFolder folder;
    fs::create_directories(folder / "in");
    const std::vector<uint8_t> white(4 * 4, 255);
    write_png(folder / "secret.png", 2, 2, white);
    write_png(folder / "in/mine.png", 2, 2, white);
    GlbBuilder glb;
    glb.push("images", {{"uri", "../secret.png"}});
    glb.push("images", {{"uri", "mine.png"}});
    glb.push("textures", {{"source", 0}});
    glb.push("textures", {{"source", 1}});
    glb.push("materials", {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
    glb.push("materials", {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 1}}}}}});
    write_file(folder / "in/scene.gltf", glb.json.dump());
    const Scene scene = load_gltf(folder / "in/scene.gltf");
    EXPECT_TRUE(scene.images[0].pixels.empty());
    EXPECT_EQ(scene.images[1].pixels, white);
    EXPECT_EQ(scene.warnings().size(), 1u);
    EXPECT_TRUE(load_gltf(folder / "in/scene.gltf", {.load_images = false}).images[1].pixels.empty());
}

}  // namespace
}  // namespace zoe::test
