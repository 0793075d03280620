#include <filesystem>
#include <limits>

#include <gtest/gtest.h>

#include "tests/apps/run_program.h"
#include "tests/apps/small_scene.h"

namespace zoe::test {
namespace {

const std::vector<std::string> kQuick = {"--headless", "--frames", "0", "--size", "32x18", "--spp", "1"};

std::vector<std::string> with(std::vector<std::string> arguments, const std::vector<std::string>& more) {
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
}

/// Runs, and expects one clear line, the exit code, and no file that was not there before.
void expect_refused(const TempFolder& folder, const std::vector<std::string>& arguments, int exit_code,
                    const std::string& part) {
    const std::vector<std::string> before = list_files(folder.path());
    const Outcome outcome = run_demo(folder.path(), arguments);
    EXPECT_EQ(outcome.exit_code, exit_code) << outcome.err;
    EXPECT_EQ(outcome.out, "");
    EXPECT_EQ(lines(outcome.err).size(), 1u) << outcome.err;
    EXPECT_TRUE(outcome.err.starts_with("zoetrope-demo: ")) << outcome.err;
    EXPECT_NE(outcome.err.find(part), std::string::npos) << "'" << part << "' is not in: " << outcome.err;
    EXPECT_EQ(list_files(folder.path()), before);
}

void expect_bad_scene(const TempFolder& folder, const std::string& scene) {
    SCOPED_TRACE(scene);
    expect_refused(folder, with({scene}, kQuick), 1, scene);
}

TEST(BadScene, MissingFileIsRefused) {
    const TempFolder folder;
    expect_bad_scene(folder, "nowhere.glb");
    expect_bad_scene(folder, "nowhere/at_all.gltf");
    expect_bad_scene(folder, "wave_%04d.glb");
}

TEST(BadScene, FolderIsRefused) {
    const TempFolder folder;
    std::filesystem::create_directory(folder / "folder.glb");
    expect_bad_scene(folder, "folder.glb");
    expect_bad_scene(folder, ".");
}

TEST(BadScene, WithoutSurfacesHasNoLevel) {
    const TempFolder folder;
    write_small_scene(folder);
    expect_refused(folder, with({"scene.gltf", "--subdivide", "2"}, kQuick), 2, "no subdivision surface");
    expect_refused(folder, with({"rigid-2", "--subdivide", "2"}, kQuick), 2, "no subdivision surface");
    folder.write("flat.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    EXPECT_EQ(run_demo(folder.path(), with({"flat.obj", "--subdivide", "2"}, kQuick)).exit_code, 0);
}

TEST(BadScene, UnknownNameListsTheScenes) {
    const TempFolder folder;
    expect_refused(folder, with({"no_such_scene"}, kQuick), 1, "default");
}

TEST(BadScene, EmptyFileIsRefused) {
    const TempFolder folder;
    folder.write("empty.glb", "");
    folder.write("empty.gltf", "");
    expect_bad_scene(folder, "empty.glb");
    expect_bad_scene(folder, "empty.gltf");
}

TEST(BadScene, TextNamedGlbIsRefused) {
    const TempFolder folder;
    folder.write("text.glb", "This is not a scene.\nIt has two lines.\n");
    expect_bad_scene(folder, "text.glb");
}

TEST(BadScene, TruncatedGlbIsRefused) {
    const TempFolder folder;
    const std::string glb = small_glb();
    for (const size_t size :
         {size_t{3}, size_t{11}, size_t{12}, size_t{19}, size_t{40}, glb.size() / 2, glb.size() - 60, glb.size() - 1}) {
        folder.write("truncated.glb", glb.substr(0, size));
        SCOPED_TRACE(size);
        expect_bad_scene(folder, "truncated.glb");
    }
}

TEST(BadScene, MissingBufferIsRefused) {
    const TempFolder folder;
    folder.write("scene.gltf", small_scene().dump());
    expect_bad_scene(folder, "scene.gltf");
}

TEST(BadScene, UriThatLeavesTheFolderIsRefused) {
    const TempFolder folder;
    folder.write("outside.bin", small_buffer());
    const std::string absolute = (folder / "outside.bin").native();
    for (const std::string& uri : {std::string("../outside.bin"), std::string("deeper/../../outside.bin"), absolute,
                                   "file://" + absolute, std::string("%2e%2e/outside.bin")}) {
        SCOPED_TRACE(uri);
        nlohmann::json json = small_scene();
        json["buffers"][0]["uri"] = uri;
        folder.write("inside/scene.gltf", json.dump());
        expect_bad_scene(folder, "inside/scene.gltf");
    }
}

TEST(BadScene, SceneWithoutMeshIsRefused) {
    const TempFolder folder;
    nlohmann::json json = small_scene();
    json["nodes"] = {{{"name", "empty"}}, {{"name", "empty too"}}, {{"camera", 0}}};
    write_small_scene(folder, json);
    expect_bad_scene(folder, "scene.gltf");
    folder.write("scene.gltf", R"({"asset": {"version": "2.0"}})");
    expect_bad_scene(folder, "scene.gltf");
}

TEST(BadScene, SceneWithoutFiniteTrianglesIsRefused) {
    const TempFolder folder;
    write_small_scene(folder);
    folder.write("scene.bin", small_buffer(std::numeric_limits<float>::quiet_NaN()));
    expect_bad_scene(folder, "scene.gltf");
    folder.write("scene.bin", small_buffer(std::numeric_limits<float>::infinity()));
    expect_bad_scene(folder, "scene.gltf");
}

TEST(BadScene, NanVerticesBesideFiniteTrianglesAreAWarning) {
    const TempFolder folder;
    nlohmann::json json = small_scene();
    json["buffers"][0]["byteLength"] = 112;
    json["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", 76}, {"byteLength", 36}});
    json["accessors"].push_back(json["accessors"][0]);
    json["accessors"][3]["bufferView"] = 3;
    json["meshes"].push_back(json["meshes"][0]);
    json["meshes"][1]["primitives"][0]["attributes"]["POSITION"] = 3;
    json["nodes"][1]["mesh"] = 1;
    write_small_scene(folder, json);
    folder.write("scene.bin", small_buffer(std::numeric_limits<float>::quiet_NaN()) + small_buffer().substr(0, 36));
    const Outcome outcome = run_demo(folder.path(), with({"scene.gltf"}, kQuick));
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    ASSERT_GE(lines(outcome.err).size(), 1u);
    for (const std::string& line : lines(outcome.err)) EXPECT_TRUE(line.starts_with("zoetrope-demo: warning: ")) << line;
    EXPECT_TRUE(std::filesystem::exists(folder / "out/frame_0000.png"));
}

TEST(BadScene, SceneThatIsHiddenByZeroScalePlays) {
    const TempFolder folder;
    nlohmann::json json = small_scene();
    for (const int node : {0, 1}) json["nodes"][node]["scale"] = {0, 0, 0};
    write_small_scene(folder, json);
    const Outcome outcome = run_demo(folder.path(), with({"scene.gltf"}, kQuick));
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_TRUE(std::filesystem::exists(folder / "out/frame_0000.png"));
}

TEST(BadSky, WhatIsNoPictureIsRefused) {
    const TempFolder folder;
    write_small_scene(folder);
    folder.write("text.exr", "no picture at all");
    for (const char* const sky : {"nowhere.hdr", "text.exr"}) {
        expect_refused(folder, with({"scene.gltf", "--sky", sky}, kQuick), 1, sky);
    }
}

TEST(BadOutput, FolderInAPicturesPlaceIsRefusedBeforeTheWork) {
    const TempFolder folder;
    write_small_scene(folder);
    std::filesystem::create_directories(folder / "out/frame_0001.png");
    expect_refused(folder, {"scene.gltf", "--frames", "0-1"}, 1, "out/frame_0001.png");
    expect_refused(folder, {"scene.gltf", "--frames", "0-1", "--resume"}, 1, "out/frame_0001.png");
}

TEST(BadOutput, ScreenshotWithoutADisplayIsRefused) {
    const TempFolder folder;
    write_small_scene(folder);
    expect_refused(folder, {"scene.gltf", "--screenshot", "window.png"}, 1, "no display");
}

TEST(BadOutput, FolderThatCannotBeMadeIsRefused) {
    const TempFolder folder;
    write_small_scene(folder);
    folder.write("blocked", "a file where a folder should be");
    expect_refused(folder, with({"scene.gltf", "--out", "blocked/frame_%04d.png"}, kQuick), 1, "blocked");
    expect_refused(folder, with({"scene.gltf", "--out", "/proc/zoetrope/frame_%04d.png"}, kQuick), 1, "/proc/zoetrope");
}

TEST(BadOutput, StatsThatCannotBeWrittenAreRefusedBeforeTheWork) {
    const TempFolder folder;
    write_small_scene(folder);
    std::filesystem::create_directory(folder / "out");
    expect_refused(folder, with({"scene.gltf", "--stats", "nowhere/stats.json"}, kQuick), 1, "nowhere/stats.json");
    expect_refused(folder, with({"scene.gltf", "--trace", "out"}, kQuick), 1, "out");
}

TEST(BadUsage, EachBadOptionIsOneLineAndCodeTwo) {
    const TempFolder folder;
    write_small_scene(folder);
    const std::vector<std::vector<std::string>> cases = {
        {"--frames", "5-2"},
        {"--frames", "-3"},
        {"--frames", "1-2-3"},
        {"--frames", "many"},
        {"--frames", "0-99999999999"},
        {"--frames", "0-999999999"},
        {"--size", "0x0"},
        {"--size", "640"},
        {"--size", "640x"},
        {"--size", "-640x360"},
        {"--size", "1000000x1000000"},
        {"--size", "16384x16384"},
        {"--spp", "0"},
        {"--shutter", "-0.1"},
        {"--shutter", "1.1"},
        {"--shutter", "nan"},
        {"--slices", "0"},
        {"--slices", "3"},
        {"--slices", "2048"},
        {"--slices", "-1"},
        {"--noise", "0"},
        {"--noise", "1.5"},
        {"--noise", "nan"},
        {"--time-limit", "0"},
        {"--time-limit", "inf"},
        {"--shard", "0/4"},
        {"--shard", "5/4"},
        {"--shard", "3"},
        {"--shard", "-1/4"},
        {"--exposure", "nan"},
        {"--exposure", "33"},
        {"--tone", "film"},
        {"--spp", "many"},
        {"--fps", "0"},
        {"--fps", "nan"},
        {"--fps", "-24"},
        {"--shade", "wonderful"},
        {"--threads", "-1"},
        {"--eye", "1,2,3"},
        {"--eye", "1,2", "--target", "0,0,0"},
        {"--sun", "91,0"},
        {"--sun", "30"},
        {"--sun", "nan,0"},
        {"--sun", "30,0", "--sky", "plain"},
        {"--sky", "1,-1,1"},
        {"--eye", "1,2,nan", "--target", "0,0,0"},
        {"--eye", "1,2,3", "--target", "1,2,3"},
        {"--eye", "1,2,3", "--target", "0,0,0", "--fov", "180"},
        {"--eye", "1,2,3", "--target", "0,0,0", "--camera", "0"},
        {"--fov", "40"},
        {"--out", "frame.png", "--frames", "0-1"},
        {"--out", "frame_%s.png"},
        {"--out", "frame_%d_%d.png"},
        {"--out", "frame_%n.png"},
        {"--out", "frame_%999999d.png"},
        {"--out", "frame_%d.jpg"},
        {"--out", "folder_%d/frame.png"},
        {"--out", "folder/"},
        {"--clip", "no such clip"},
        {"--clip", "1"},
        {"--camera", "no such camera"},
        {"--camera", "1"},
        {"--no-such-option"},
        {"another_scene.glb"},
        {"--screenshot", "window.png"},
        {"--screenshot", ""},
        {"--out", ""},
        {"--stats", ""},
        {"--trace", ""},
        {"--cache", ""},
        {"--spp", ""},
        {"--fps", ""},
        {"--threads", ""},
        {"--build-budget", ""},
        {"--after", ""},
        {"--spp", "4", "--spp", ""},
        {"--cache", "trees", "--no-cache"},
    };
    for (const std::vector<std::string>& options : cases) {
        std::string all;
        for (const std::string& option : options) all += option + " ";
        SCOPED_TRACE(all);
        expect_refused(folder, with({"scene.gltf", "--headless"}, options), 2, "");
    }
}

TEST(BadUsage, UnknownClipAndCameraListWhatThereIs) {
    const TempFolder folder;
    write_small_scene(folder);
    expect_refused(folder, with({"scene.gltf", "--clip", "x"}, kQuick), 2, "0 'turn'");
    expect_refused(folder, with({"scene.gltf", "--camera", "x"}, kQuick), 2, "0 'front'");
}

}  // namespace
}  // namespace zoe::test
