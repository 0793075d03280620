// Surfaces that are as fine as the demo's pictures show.

#include <filesystem>

#include <gtest/gtest.h>

#include "tests/apps/run_program.h"
#include "tests/apps/small_scene.h"
#include "tests/support/read_bytes.h"

namespace zoe::test {
namespace {

using Json = nlohmann::json;

/// A surface that is as fine as its pixels show comes from 11 m to 4 m in a second.
void write_pixel_surface(const TempFolder& folder, const Json& camera = {}) {
    Json json = small_scene();
    json["meshes"][0]["extras"]["subdivision"] = {{"level", 1}, {"pixels", 0.5}, {"boundary", "edge"}};
    json["scenes"][0]["nodes"] = {0, 2};
    json["nodes"][0] = Json::parse(R"({"children": [1], "translation": [0, 0, -6], "scale": [1, 1, 10]})");
    json["nodes"][1] = Json::parse(R"({"mesh": 0})");
    json["accessors"][2]["type"] = "VEC3";
    json["animations"][0]["channels"][0]["target"] = {{"node", 1}, {"path", "translation"}};
    if (!camera.is_null()) json["cameras"][0] = camera;
    write_small_scene(folder, json);
}

TEST(PixelSurfaces, AreAsFineAsTheirPixelsShow) {
    const TempFolder folder;
    write_pixel_surface(folder);
    const auto triangle_count = [&](std::vector<std::string> more) {
        more.insert(more.end(), {"--frames", "0", "--stats", "stats.json"});
        const Outcome outcome = run_demo(folder.path(), small_pictures(more));
        EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
        EXPECT_EQ(outcome.err.find("warning"), std::string::npos) << outcome.err;
        return Json::parse(read_bytes(folder / "stats.json"))["triangles"].get<int>();
    };
    const auto from = [](const char* eye, const char* fov) {
        return std::vector<std::string>{"--eye", eye, "--target", "0,0.3,-6", "--fov", fov};
    };
    EXPECT_GE(triangle_count({"--size", "480x320"}), 4 * triangle_count({})) << "a larger picture";
    const int near = triangle_count(from("0,0.3,2", "40"));
    EXPECT_GE(near, 4 * triangle_count(from("0,0.3,90", "40"))) << "a nearer eye";
    EXPECT_GE(near, 4 * triangle_count(from("0,0.3,2", "150"))) << "a narrower view";
    EXPECT_EQ(triangle_count({"--subdivide", "2"}), 24) << "the level that was told";
}

TEST(PixelSurfaces, DependOnNoFrameBefore) {
    const TempFolder folder;
    write_pixel_surface(folder);
    ASSERT_EQ(
        run_demo(folder.path(), small_pictures({"--frames", "0-23", "--out", "f%d.png", "--stats", "stats.json"})).exit_code,
        0);
    int change_count = 0;
    const Json stats = Json::parse(read_bytes(folder / "stats.json"));
    for (int frame = 1; frame < 24; ++frame) change_count += stats["frames"][frame]["rebuilt"].get<int>() > 0;
    EXPECT_GE(change_count, 1);
    std::vector<std::string> played;
    for (int frame = 0; frame < 24; ++frame) {
        const std::filesystem::path picture = folder / ("f" + std::to_string(frame) + ".png");
        played.push_back(read_bytes(picture));
        if (frame % 3 > 0) std::filesystem::remove(picture);
    }
    ASSERT_EQ(run_demo(folder.path(), small_pictures({"--frames", "0-23", "--out", "f%d.png", "--resume"})).exit_code, 0);
    for (int frame = 0; frame < 24; ++frame) {
        EXPECT_EQ(read_bytes(folder / ("f" + std::to_string(frame) + ".png")), played[frame]) << "frame " << frame;
    }
    ASSERT_EQ(run_demo(folder.path(), small_pictures({"--frames", "22", "--out", "alone.png"})).exit_code, 0);
    EXPECT_EQ(read_bytes(folder / "alone.png"), played[22]);
}

TEST(PixelSurfaces, HaveTheirLevelWhereTheCameraIsOrthographic) {
    const TempFolder folder;
    write_pixel_surface(folder, Json::parse(R"({"type": "orthographic",
                                                "orthographic": {"xmag": 3, "ymag": 2, "znear": 0.1, "zfar": 100}})"));
    const Outcome outcome = run_demo(folder.path(), small_pictures({"--frames", "0", "--stats", "stats.json"}));
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_NE(outcome.err.find("the camera is orthographic"), std::string::npos) << outcome.err;
    EXPECT_EQ(Json::parse(read_bytes(folder / "stats.json"))["triangles"], 6);
}

}  // namespace
}  // namespace zoe::test
