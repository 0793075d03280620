// Pictures of an open shutter, and of as many samples as pixels need, as the demo makes them.

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

#include <gtest/gtest.h>

#include "engine/scene/image.h"
#include "tests/apps/run_program.h"
#include "tests/apps/small_scene.h"
#include "tests/support/read_bytes.h"

namespace zoe::test {
namespace {

using Json = nlohmann::json;

TEST(Exposures, AnOpenShutterBlursWhatMovesAndNothingElse) {
    const TempFolder folder;
    write_small_scene(folder);
    const auto render = [&](std::vector<std::string> more, const std::string& out) {
        more.insert(more.end(), {"--frames", "3", "--fps", "6", "--spp", "32", "--shade", "albedo", "--out", out});
        const Outcome outcome = run_demo(folder.path(), small_pictures(more));
        EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
        return read_picture(folder / out);
    };
    const FloatImage sharp = render({}, "sharp.exr"), none = render({"--shutter", "0"}, "none.exr"),
                     blurred = render({"--shutter", "1"}, "blurred.exr");
    EXPECT_EQ(read_bytes(folder / "sharp.exr"), read_bytes(folder / "none.exr"));
    EXPECT_EQ(sharp.values, none.values);
    // Beside its samples, what an EXR holds is as it is when the shutter opens.
    ASSERT_EQ(sharp.channels, blurred.channels);
    int moved_count = 0;
    for (size_t i = 0; i < sharp.values.size(); ++i) {
        const std::string& channel = sharp.channels[i % sharp.channels.size()];
        if (channel.size() == 1) {
            moved_count += std::abs(sharp.values[i] - blurred.values[i]) > 0.05f;
        } else {
            EXPECT_EQ(sharp.values[i], blurred.values[i]) << channel;
        }
    }
    EXPECT_GT(moved_count, 10);
}

TEST(Exposures, TheFilesCameraSaysHowLongItsShutterIsOpen) {
    const TempFolder folder;
    Json scene = small_scene();
    write_small_scene(folder, scene);
    const std::vector<std::string> told = small_pictures({"--frames", "3", "--shutter", "0.5", "--out", "told.png"});
    ASSERT_EQ(run_demo(folder.path(), told).exit_code, 0);
    scene["cameras"][0]["extras"]["shutter"] = 0.5;
    write_small_scene(folder, scene);
    ASSERT_EQ(run_demo(folder.path(), small_pictures({"--frames", "3", "--out", "own.png"})).exit_code, 0);
    ASSERT_EQ(run_demo(folder.path(), small_pictures({"--frames", "3", "--shutter", "0", "--out", "sharp.png"})).exit_code,
              0);
    EXPECT_EQ(read_bytes(folder / "told.png"), read_bytes(folder / "own.png"));
    EXPECT_NE(read_bytes(folder / "told.png"), read_bytes(folder / "sharp.png"));
}

TEST(Exposures, APixelGetsTheSamplesThatItNeeds) {
    const TempFolder folder;
    write_small_scene(folder);
    const auto run = [&](std::vector<std::string> more) {
        more.insert(more.end(), {"--frames", "3", "--spp", "256", "--out", "noise.exr", "--stats", "stats.json"});
        const Outcome outcome = run_demo(folder.path(), small_pictures(more));
        EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
        return Json::parse(read_bytes(folder / "stats.json"))["frames"][0]["samples"].get<double>();
    };
    const double rough = run({"--noise", "0.2"}), fine = run({"--noise", "0.02"});
    EXPECT_GE(rough, 16.0);
    EXPECT_GT(fine, rough);
    EXPECT_LT(fine, 256.0);
    const std::set<float> counts = channel_values(read_picture(folder / "noise.exr"), "sampleCount");
    EXPECT_GT(counts.size(), 1u);
    EXPECT_GE(*counts.begin(), 16.0f);
    EXPECT_LE(*counts.rbegin(), 256.0f);
    // So little time is for one pass.
    EXPECT_EQ(run({"--time-limit", "0.000001"}), 4.0);
}

}  // namespace
}  // namespace zoe::test
