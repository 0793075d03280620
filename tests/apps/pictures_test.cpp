#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

#include <gtest/gtest.h>

#include "apps/common/numbered_path.h"
#include "engine/scene/image.h"
#include "tests/apps/run_program.h"
#include "tests/apps/small_scene.h"
#include "tests/support/read_bytes.h"

namespace zoe::test {
namespace {

using Json = nlohmann::json;

std::vector<std::string> keys(const Json& json) {
    std::vector<std::string> names;
    for (const auto& [key, value] : json.items()) names.push_back(key);
    return names;
}

TEST(Pictures, FrameRangeGivesOnePictureEachThatDiffer) {
    const TempFolder folder;
    write_small_scene(folder);
    const Outcome outcome = run_demo(folder.path(), small_pictures({"--frames", "3-6"}));
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    for (const int frame : {3, 4, 5, 6}) {
        const FloatImage image = read_picture(folder / ("out/frame_000" + std::to_string(frame) + ".png"));
        EXPECT_EQ(image.width, 48);
        EXPECT_EQ(image.height, 32);
    }
    EXPECT_NE(read_bytes(folder / "out/frame_0003.png"), read_bytes(folder / "out/frame_0006.png"));
    const FloatImage sheet = read_picture(folder / "out/contact_sheet.png");
    EXPECT_EQ(sheet.width, 8 + 4 * (48 + 8));
    EXPECT_EQ(sheet.height, 8 + 32 + 8);
    for (const std::string& name : list_files(folder / "out")) {
        EXPECT_TRUE(name.ends_with(".png") || name == "animation.mp4") << name << " is left over";
    }
    EXPECT_FALSE(std::filesystem::exists(folder / "out/frame_0002.png"));
    EXPECT_FALSE(std::filesystem::exists(folder / "out/frame_0007.png"));
}

TEST(Pictures, FilmIsMadeWhereFfmpegIs) {
    const TempFolder folder;
    write_small_scene(folder);
    // An odd size: the film's sides must be even.
    ASSERT_EQ(run_demo(folder.path(), small_pictures({"--frames", "0-3", "--size", "33x21"})).exit_code, 0);
    bool has_ffmpeg = true;
    try {
        has_ffmpeg = run_program({"ffmpeg", "-version"}, folder.path()).exit_code == 0;
    } catch (const std::runtime_error&) {
        has_ffmpeg = false;
    }
    EXPECT_EQ(std::filesystem::exists(folder / "out/animation.mp4"), has_ffmpeg);
    if (has_ffmpeg) {
        EXPECT_GT(std::filesystem::file_size(folder / "out/animation.mp4"), 200u);
    }
}

TEST(Pictures, MissingFfmpegIsAWarning) {
    const TempFolder folder;
    write_small_scene(folder);
    std::filesystem::create_directory(folder / "empty");
    std::vector<std::string> arguments = small_pictures({"--frames", "0-1"});
    arguments.insert(arguments.begin(), ZOETROPE_DEMO);
    const Outcome outcome = run_program(arguments, folder.path(), {"DISPLAY", "PATH=" + (folder / "empty").native()});
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_EQ(outcome.err, "zoetrope-demo: warning: no film was made: ffmpeg is not installed\n");
    EXPECT_FALSE(std::filesystem::exists(folder / "out/animation.mp4"));
}

TEST(Pictures, SingleFrameNeedsNoNumberInItsName) {
    const TempFolder folder;
    write_small_scene(folder);
    const Outcome outcome = run_demo(folder.path(), small_pictures({"--frames", "7", "--out", "one/picture.png"}));
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(list_files(folder / "one"), std::vector<std::string>{"picture.png"});
}

TEST(Pictures, ExrHasTheLayers) {
    const TempFolder folder;
    write_small_scene(folder);
    const Outcome outcome =
        run_demo(folder.path(), small_pictures({"--frames", "0-1", "--spp", "1", "--out", "layers/f%02d.exr"}));
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_TRUE(std::filesystem::exists(folder / "layers/contact_sheet.png"));
    ASSERT_TRUE(std::filesystem::exists(folder / "layers/f01.exr"));
    const FloatImage image = read_picture(folder / "layers/f00.exr");
    std::vector<std::string> channels = image.channels;
    std::sort(channels.begin(), channels.end());
    EXPECT_EQ(channels, (std::vector<std::string>{"A", "B", "G", "R", "albedo.B", "albedo.G", "albedo.R", "backward.u",
                                                  "backward.v", "depth.Z", "node.id", "normal.X", "normal.Y", "normal.Z",
                                                  "primitive.id", "sampleCount"}));

    // The camera is five metres in front of both triangles, which face it.
    const std::set<float> depths = channel_values(image, "depth.Z");
    ASSERT_GE(depths.size(), 2u);
    EXPECT_EQ(*depths.rbegin(), std::numeric_limits<float>::infinity());
    for (const float depth : depths) EXPECT_TRUE(std::isinf(depth) || std::abs(depth - 5.0f) < 1e-4f) << depth;
    const std::set<float> nodes = channel_values(image, "node.id");
    EXPECT_EQ(nodes, (std::set<float>{0.0f, 1.0f, 4294967295.0f}));
    EXPECT_EQ(channel_values(image, "primitive.id"), (std::set<float>{0.0f, 4294967295.0f}));
}

std::string note(const std::filesystem::path& file, const std::string& name) {
    for (const auto& [key, text] : read_picture(file).notes) {
        if (key == name) return text;
    }
    return "";
}

TEST(Pictures, SayWhatTheyShow) {
    const TempFolder folder;
    write_small_scene(folder);
    for (const char* const out : {"out/f%02d.png", "out/f%02d.exr"}) {
        const Outcome outcome = run_demo(folder.path(), small_pictures({"--frames", "6", "--fps", "12", "--out", out}));
        ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    }
    for (const char* const file : {"out/f06.png", "out/f06.exr"}) {
        EXPECT_EQ(note(folder / file, "scene"), "scene.gltf");
        EXPECT_EQ(note(folder / file, "frame"), "6");
        EXPECT_EQ(note(folder / file, "time"), "0.5 s");
        EXPECT_EQ(note(folder / file, "samples"), "2");
        EXPECT_NE(note(folder / file, "camera"), "");
        EXPECT_TRUE(note(folder / file, "Software").starts_with("Zoetrope ")) << note(folder / file, "Software");
    }
}

/// Motion is measured from the frame before: made for it, where it was not made anyway.
TEST(Pictures, MotionDoesNotDependOnTheFramesMadeBefore) {
    const TempFolder folder;
    write_small_scene(folder);
    const auto render = [&](const char* frames, const char* out) {
        const Outcome outcome = run_demo(folder.path(), small_pictures({"--frames", frames, "--out", out}));
        EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    };
    render("3-6", "all/f%d.exr");
    render("6", "alone/f%d.exr");
    EXPECT_FALSE(read_bytes(folder / "all/f6.exr").empty());
    EXPECT_TRUE(read_bytes(folder / "all/f6.exr") == read_bytes(folder / "alone/f6.exr"));
    const FloatImage image = read_picture(folder / "alone/f6.exr");
    const auto across = std::ranges::find(image.channels, "backward.u");
    ASSERT_NE(across, image.channels.end());
    float most = 0.0f;
    for (size_t i = static_cast<size_t>(across - image.channels.begin()); i < image.values.size();
         i += image.channels.size())
        most = std::max(most, std::abs(image.values[i]));
    EXPECT_GT(most, 0.1f) << "pixels: something moves";
}

double brightness(const std::filesystem::path& file) {
    const FloatImage image = read_picture(file);
    double sum = 0.0;
    for (size_t i = 0; i < image.values.size(); ++i) sum += i % image.channels.size() < 3 ? image.values[i] : 0.0f;
    return sum / static_cast<double>(image.values.size());
}

TEST(Pictures, ExposureBrightensAndToneIsChosen) {
    const TempFolder folder;
    write_small_scene(folder);
    const auto render = [&](const std::string& out, std::vector<std::string> more) {
        std::vector<std::string> arguments = small_pictures({"--frames", "0", "--out", out});
        arguments.insert(arguments.end(), more.begin(), more.end());
        const Outcome outcome = run_demo(folder.path(), arguments);
        EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
        return brightness(folder / out);
    };
    const double plain = render("plain.png", {});
    EXPECT_GT(render("bright.png", {"--exposure", "1"}), 1.1 * plain);
    EXPECT_LT(render("dark.png", {"--exposure", "-2"}), 0.9 * plain);
    EXPECT_NE(render("aces.png", {"--tone", "aces"}), plain);
    EXPECT_NE(render("linear.png", {"--tone", "linear"}), plain);
    // An EXR holds the light itself.
    EXPECT_EQ(render("dark.exr", {"--exposure", "-2"}), render("plain.exr", {}));
}

TEST(Pictures, ResumeKeepsWhatIsThereAndMakesTheRest) {
    const TempFolder folder;
    write_small_scene(folder);
    ASSERT_EQ(run_demo(folder.path(), small_pictures({"--frames", "0-2"})).exit_code, 0);
    const std::string frame_1 = read_bytes(folder / "out/frame_0001.png");
    std::filesystem::remove(folder / "out/frame_0001.png");
    const auto written = std::filesystem::last_write_time(folder / "out/frame_0000.png");
    const Outcome outcome =
        run_demo(folder.path(), small_pictures({"--frames", "0-2", "--resume", "--stats", "stats.json"}));
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(read_bytes(folder / "out/frame_0001.png"), frame_1);
    EXPECT_EQ(std::filesystem::last_write_time(folder / "out/frame_0000.png"), written);
    const Json stats = Json::parse(read_bytes(folder / "stats.json"));
    ASSERT_EQ(stats["frames"].size(), 1u);
    EXPECT_EQ(stats["frames"][0]["frame"], 1);

    const Outcome nothing_left =
        run_demo(folder.path(), small_pictures({"--frames", "0-2", "--resume", "--stats", "none.json"}));
    EXPECT_EQ(nothing_left.exit_code, 0) << nothing_left.err;
    EXPECT_EQ(Json::parse(read_bytes(folder / "none.json"))["frames"].size(), 0u);
}

TEST(Pictures, ResumeMakesEmptyPicturesAgain) {
    const TempFolder folder;
    write_small_scene(folder);
    ASSERT_EQ(run_demo(folder.path(), small_pictures({"--frames", "0-2"})).exit_code, 0);
    const std::string frame_1 = read_bytes(folder / "out/frame_0001.png");
    folder.write("out/frame_0001.png", "");
    const Outcome outcome = run_demo(folder.path(), small_pictures({"--frames", "0-2", "--resume"}));
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(read_bytes(folder / "out/frame_0001.png"), frame_1);
    EXPECT_NE(outcome.out.find("(2 were there already)"), std::string::npos) << outcome.out;
}

TEST(Pictures, ResumeWarnsOfPicturesOfAnotherSize) {
    for (const char* const out : {"out/f%d.png", "out/f%d.exr"}) {
        SCOPED_TRACE(out);
        const TempFolder folder;
        write_small_scene(folder);
        ASSERT_EQ(run_demo(folder.path(), small_pictures({"--frames", "0-1", "--out", out})).exit_code, 0);
        const std::string text = "of the pictures that are there, 2 are not 32x48";
        const Outcome same = run_demo(folder.path(), small_pictures({"--frames", "0-2", "--out", out, "--resume"}));
        EXPECT_EQ(same.err.find("of the pictures"), std::string::npos) << same.err;
        std::filesystem::remove(folder / NumberedPath(out)(2).native());
        const Outcome other =
            run_demo(folder.path(), small_pictures({"--frames", "0-2", "--out", out, "--resume", "--size", "32x48"}));
        EXPECT_EQ(other.exit_code, 0) << other.err;
        EXPECT_NE(other.err.find(text), std::string::npos) << other.err;
    }
}

TEST(Pictures, ThreadsDoNotMatter) {
    const TempFolder folder;
    write_small_scene(folder);
    for (const char* const threads : {"1", "2", "5"}) {
        const std::string out = std::string("threads_") + threads + "/f%d.png";
        ASSERT_EQ(run_demo(folder.path(), small_pictures({"--frames", "0-2", "--threads", threads, "--out", out})).exit_code,
                  0);
    }
    for (const char* const name : {"f0.png", "f1.png", "f2.png"}) {
        const std::string one = read_bytes(folder / "threads_1" / name);
        EXPECT_FALSE(one.empty());
        EXPECT_EQ(one, read_bytes(folder / "threads_2" / name));
        EXPECT_EQ(one, read_bytes(folder / "threads_5" / name));
    }
}

TEST(Pictures, LoopingStartsAgainAndNoLoopStays) {
    const TempFolder folder;
    write_small_scene(folder);  // its clip takes one second: 24 frames
    ASSERT_EQ(run_demo(folder.path(), small_pictures({"--frames", "6-36", "--out", "loop/f%d.png"})).exit_code, 0);
    ASSERT_EQ(run_demo(folder.path(), small_pictures({"--frames", "24-36", "--out", "stay/f%d.png", "--no-loop"})).exit_code,
              0);
    const auto pixels = [&](const char* file) { return read_picture(folder / file).values; };
    EXPECT_TRUE(pixels("loop/f6.png") == pixels("loop/f30.png"));
    EXPECT_TRUE(pixels("stay/f24.png") == pixels("stay/f36.png"));
    EXPECT_TRUE(pixels("stay/f36.png") != pixels("loop/f36.png"));
}

TEST(Stats, FieldsAreTheDocumentedOnes) {
    const TempFolder folder;
    write_small_scene(folder);
    const Outcome outcome =
        run_demo(folder.path(),
                 small_pictures({"--frames", "0-3", "--threads", "2", "--stats", "stats.json", "--trace", "trace.json"}));
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const Json stats = Json::parse(read_bytes(folder / "stats.json"));
    EXPECT_EQ(keys(stats),
              (std::vector<std::string>{"frames", "median", "nodes", "p99", "scene", "simd", "threads", "triangles"}));
    EXPECT_EQ(stats["scene"], "scene.gltf");
    EXPECT_EQ(stats["threads"], 2);
    EXPECT_EQ(stats["triangles"], 2);
    EXPECT_EQ(stats["nodes"], Json::parse(R"({"static": 1, "rigid": 1, "deforming": 0, "arbitrary": 0})"));
    ASSERT_EQ(stats["frames"].size(), 4u);

    std::vector<std::string> numbers = {"animate_ms", "build_tlas_ms", "deform_ms", "frame_ms", "hits",
                                        "kept",       "kinds",         "loaded",    "rays",     "rebuilt",
                                        "refitted",   "samples",       "stored",    "trace_ms", "update_blas_ms"};
    EXPECT_EQ(keys(stats["median"]), numbers);
    EXPECT_EQ(keys(stats["p99"]), numbers);
    numbers.insert(numbers.end(), {"frame", "hits_hash"});
    std::sort(numbers.begin(), numbers.end());
    for (int i = 0; i < 4; ++i) {
        const Json& frame = stats["frames"][i];
        SCOPED_TRACE(frame.dump());
        EXPECT_EQ(keys(frame), numbers);
        EXPECT_EQ(frame["frame"], i);
        EXPECT_EQ(frame["samples"], 2.0);
        EXPECT_EQ(keys(frame["kinds"]), (std::vector<std::string>{"diffuse", "primary", "shadow"}));
        EXPECT_EQ(keys(frame["kinds"]["primary"]), (std::vector<std::string>{"ms", "rays"}));
        EXPECT_EQ(frame["kinds"]["primary"]["rays"], 48 * 32 * 2);
        EXPECT_EQ(frame["hits_hash"].get<std::string>().size(), 16u);
        EXPECT_EQ(frame["hits_hash"].get<std::string>().find_first_not_of("0123456789abcdef"), std::string::npos);
        if (i > 0) {
            EXPECT_EQ(frame["kept"], 2);
        }
        double sum_ms = 0.0;
        for (const char* const stage : {"animate_ms", "deform_ms", "update_blas_ms", "build_tlas_ms", "trace_ms"}) {
            EXPECT_TRUE(frame[stage].is_number());
            sum_ms += frame[stage].get<double>();
        }
        EXPECT_NEAR(frame["frame_ms"].get<double>(), sum_ms, 1e-6 * sum_ms);
    }

    const Json trace = Json::parse(read_bytes(folder / "trace.json"));
    std::set<std::string> names;
    for (const Json& event : trace["traceEvents"]) names.insert(event["name"]);
    for (const char* const stage : {"animate", "deform", "update_blas", "build_tlas", "trace"})
        EXPECT_TRUE(names.count(stage)) << stage;
}

TEST(Demo, RunsHeadlessWhereThereIsNoDisplay) {
    const TempFolder folder;
    write_small_scene(folder);
    const Outcome outcome = run_demo(folder.path(), {"scene.gltf", "--size", "32x18", "--spp", "1"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_NE(outcome.out.find("no display"), std::string::npos) << outcome.out;
    EXPECT_TRUE(std::filesystem::exists(folder / "out/frame_0047.png"));
}

TEST(Demo, HelpNamesEveryOptionAndGivesExamples) {
    const TempFolder folder;
    const Outcome outcome = run_demo(folder.path(), {"--help"});
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_EQ(outcome.err, "");
    for (const char* const part :
         {"--headless", "--frames",   "--fps",     "--size",       "--spp",     "--shade",   "--camera",
          "--eye",      "--target",   "--fov",     "--clip",       "--no-loop", "--out",     "--stats",
          "--shutter",  "--slices",   "--noise",   "--time-limit", "--trace",   "--threads", "--resume",
          "--cache",    "--no-cache", "Examples:", "default"}) {
        EXPECT_NE(outcome.out.find(part), std::string::npos) << part;
    }
}

}  // namespace
}  // namespace zoe::test
