// A render that is interrupted, whose disk is full, or whose folder vanishes: it ends soon, and every file is whole.

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <functional>
#include <thread>

#include <gtest/gtest.h>

#include "engine/scene/image.h"
#include "tests/apps/run_program.h"
#include "tests/apps/small_scene.h"

namespace zoe::test {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

/// Waits until something is so. Returns whether it came to be.
bool wait_until(const std::function<bool()>& is_so) {
    for (const Clock::time_point end = Clock::now() + std::chrono::seconds(120); Clock::now() < end;) {
        if (is_so()) return true;
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    return false;
}

size_t count_pictures(const fs::path& folder) {
    size_t count = 0;
    std::error_code error;
    for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
        const std::string name = it->path().filename().string();
        count += !name.starts_with(".") && name.ends_with(".png");
    }
    return count;
}

/// Nothing but whole pictures of a size. Returns how many.
size_t expect_whole_pictures(const fs::path& folder, int width, int height) {
    size_t count = 0;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
        const std::string name = entry.path().filename().string();
        EXPECT_TRUE(name.starts_with("frame_")) << name;
        const FloatImage image = read_picture(entry.path());
        EXPECT_EQ(image.width, width) << name;
        EXPECT_EQ(image.height, height) << name;
        ++count;
    }
    return count;
}

/// Frames that take a few milliseconds each, without end.
std::vector<std::string> many_frames() {
    return demo_command(
        {"scene.gltf", "--headless", "--frames", "0-99999", "--size", "64x36", "--spp", "1", "--out", "out/frame_%05d.png"});
}

class Interrupt : public testing::TestWithParam<int> {};

TEST_P(Interrupt, BetweenFramesLeavesWholePictures) {
    const TempFolder folder;
    write_small_scene(folder, small_scene());
    RunningProgram demo(many_frames(), folder.path(), kNoDisplay);
    ASSERT_TRUE(wait_until([&] { return count_pictures(folder / "out") >= 3; }));
    demo.send(GetParam());
    const Outcome outcome = demo.wait();
    EXPECT_EQ(outcome.exit_code, 130) << outcome.err;
    EXPECT_NE(outcome.err.find("--resume goes on after them"), std::string::npos) << outcome.err;
    EXPECT_GE(expect_whole_pictures(folder / "out", 64, 36), 3u);
}

// Hours of samples in one large frame; the quickest of a few tries, because a test machine does other things, too.
TEST_P(Interrupt, ALongFrameEndsWithinATenthOfASecond) {
    const TempFolder folder;
    write_small_scene(folder, small_scene());
    std::chrono::duration<double, std::milli> quickest(1e9);
    for (int tries = 0; tries < 5 && quickest.count() > 100.0; ++tries) {
        RunningProgram demo(demo_command({"scene.gltf", "--headless", "--frames", "0", "--size", "1280x720", "--spp",
                                          "65536", "--out", "out/frame_%05d.png"}),
                            folder.path(), kNoDisplay);
        ASSERT_TRUE(wait_until([&] { return demo.catches(GetParam()); }));
        std::this_thread::sleep_for(std::chrono::milliseconds(50 + 37 * tries));  // Somewhere in the frame.
        const Clock::time_point sent = Clock::now();
        demo.send(GetParam());
        const Outcome outcome = demo.wait();
        quickest = std::min<std::chrono::duration<double, std::milli>>(quickest, Clock::now() - sent);
        EXPECT_EQ(outcome.exit_code, 130) << outcome.err;
        EXPECT_EQ(lines(outcome.err).size(), 1u) << outcome.err;
        EXPECT_EQ(list_files(folder / "out"), std::vector<std::string>{});
    }
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    constexpr double kMost_ms = 2000.0;
#else
    constexpr double kMost_ms = 100.0;
#endif
    EXPECT_LT(quickest.count(), kMost_ms);
}

INSTANTIATE_TEST_SUITE_P(Signals, Interrupt, testing::Values(SIGINT, SIGTERM),
                         [](const auto& info) { return info.param == SIGINT ? "Int" : "Term"; });

TEST(InterruptedAtOnce, WhatIsEndedWithoutAWordIsTakenUpAgain) {
    const TempFolder folder;
    write_small_scene(folder, small_scene());
    {
        RunningProgram demo(many_frames(), folder.path(), kNoDisplay);
        ASSERT_TRUE(wait_until([&] { return count_pictures(folder / "out") >= 3; }));
        demo.send(SIGKILL);
        EXPECT_EQ(demo.wait().exit_code, 128 + SIGKILL);
    }
    // Under its own name, no picture is half done; one may be under another.
    for (const fs::directory_entry& entry : fs::directory_iterator(folder / "out")) {
        const std::string name = entry.path().filename().string();
        if (!name.starts_with("frame_")) continue;
        EXPECT_EQ(read_picture(entry.path()).width, 64) << name;
    }
    const size_t count = count_pictures(folder / "out");
    const Outcome again =
        run_demo(folder.path(), {"scene.gltf", "--headless", "--frames", "0-" + std::to_string(count + 1), "--size", "64x36",
                                 "--spp", "1", "--out", "out/frame_%05d.png", "--resume"});
    EXPECT_EQ(again.exit_code, 0) << again.err;
    EXPECT_NE(again.out.find("(" + std::to_string(count) + " were there already)"), std::string::npos) << again.out;
}

TEST(Trouble, AFolderThatVanishesIsAnErrorThatNamesThePicture) {
    const TempFolder folder;
    write_small_scene(folder, small_scene());
    RunningProgram demo(many_frames(), folder.path(), kNoDisplay);
    ASSERT_TRUE(wait_until([&] { return count_pictures(folder / "out") >= 3; }));
    ASSERT_TRUE(wait_until([&] {
        std::error_code error;  // Pictures may come while others go.
        fs::remove_all(folder / "out", error);
        return !fs::exists(folder / "out");
    }));
    const Outcome outcome = demo.wait();
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_EQ(lines(outcome.err).size(), 1u) << outcome.err;
    EXPECT_NE(outcome.err.find("out/frame_"), std::string::npos) << outcome.err;
    EXPECT_FALSE(fs::exists(folder / "out"));
}

// No file may grow beyond some blocks of 512 bytes: writing more fails, as on a full disk.
TEST(Trouble, AFullDiskLeavesNoPartOfAPicture) {
    for (const char* extension : {".png", ".exr"}) {
        const TempFolder folder;
        write_small_scene(folder, small_scene());
        const std::vector<std::string> arguments = {"scene.gltf",
                                                    "--no-cache",
                                                    "--headless",
                                                    "--frames",
                                                    "0",
                                                    "--size",
                                                    "64x36",
                                                    "--spp",
                                                    "1",
                                                    "--out",
                                                    std::string("out/frame_%05d") + extension};
        const Outcome whole = run_demo(folder.path(), arguments);
        ASSERT_EQ(whole.exit_code, 0) << whole.err;
        const fs::path picture = folder / ("out/frame_00000" + std::string(extension));
        const uintmax_t size = fs::file_size(picture);
        fs::remove(picture);
        for (uintmax_t blocks = 0; blocks * 512 < size; blocks += 1 + size / 512 / 6) {
            std::vector<std::string> limited = {"sh", "-c",
                                                "trap '' XFSZ; ulimit -f " + std::to_string(blocks) + "; exec \"$@\"", "sh"};
            const std::vector<std::string> command = demo_command(arguments);
            limited.insert(limited.end(), command.begin(), command.end());
            const Outcome outcome = run_program(limited, folder.path(), kNoDisplay);
            EXPECT_EQ(outcome.exit_code, 1) << blocks << " blocks of " << size << " bytes";
            EXPECT_TRUE(fs::is_empty(folder / "out")) << blocks << " blocks of " << size << " bytes";
        }
    }
}

}  // namespace
}  // namespace zoe::test
