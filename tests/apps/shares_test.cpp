// A film that several machines render is the film that one renders.

#include <cstdlib>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "tests/apps/run_program.h"
#include "tests/apps/small_scene.h"
#include "tests/support/read_bytes.h"

namespace zoe::test {
namespace {

TEST(Shares, MakeTheSameFilesAsOneRun) {
    const TempFolder folder;
    write_small_scene(folder);
    for (const char* const type : {"png", "exr"}) {
        const std::string name = std::string("/f%d.") + type;
        // Blurred, and of as many samples as each pixel needs.
        const auto frames = [&](std::vector<std::string> more) {
            more.insert(more.end(),
                        {"--frames", "3-9", "--shutter", "0.7", "--slices", "4", "--noise", "0.1", "--spp", "64"});
            return small_pictures(more);
        };
        ASSERT_EQ(run_demo(folder.path(), frames({"--out", "whole" + name})).exit_code, 0);
        for (const char* const share : {"3/3", "1/3", "2/3"}) {
            const Outcome outcome =
                run_demo(folder.path(), frames({"--shard", share, "--threads", "1", "--out", "shares" + name}));
            ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
        }
        for (int frame = 3; frame <= 9; ++frame) {
            const std::string file = "/f" + std::to_string(frame) + "." + type;
            ASSERT_FALSE(read_bytes(folder / ("whole" + file)).empty()) << file;
            EXPECT_TRUE(read_bytes(folder / ("whole" + file)) == read_bytes(folder / ("shares" + file))) << file;
        }
        EXPECT_FALSE(std::filesystem::exists(folder / "shares/contact_sheet.png")) << "of pictures that are not all there";
    }
    // All are there: what is left is what shows them together.
    ASSERT_EQ(run_demo(folder.path(), small_pictures({"--frames", "3-9", "--resume", "--out", "shares/f%d.png"})).exit_code,
              0);
    EXPECT_TRUE(std::filesystem::exists(folder / "shares/contact_sheet.png"));
    // More shares than frames.
    const Outcome none =
        run_demo(folder.path(), small_pictures({"--frames", "0-1", "--shard", "3/3", "--stats", "none.json"}));
    EXPECT_EQ(none.exit_code, 0) << none.err;
    EXPECT_EQ(nlohmann::json::parse(read_bytes(folder / "none.json"))["frames"].size(), 0u);
}

/// The README's lines, of smaller pictures of another scene.
class ReadmeLines : public testing::Test {
protected:
    static constexpr int kFrameCount = 10;

    void SetUp() override {
        write_small_scene(folder_);
        const char* const path = std::getenv("PATH");
        path_ =
            "PATH=" + std::filesystem::path(ZOETROPE_DEMO).parent_path().native() + (path ? std::string(":") + path : "");
        ASSERT_EQ(run("zoetrope-demo " + to_small("fox.glb --frames 0-239", "whole")).exit_code, 0);
        for (int frame = 0; frame < kFrameCount; ++frame) ASSERT_FALSE(bytes("whole", frame).empty()) << frame;
    }

    /// The rest of the line that begins so.
    static std::string line(const std::string& begin) {
        for (const std::string& line : lines(read_bytes(ZOETROPE_SOURCE_DIR "/README.md"))) {
            const size_t at = line.find_first_not_of(' ');
            if (at == 4 && line.substr(at).starts_with(begin)) return line.substr(at);
        }
        ADD_FAILURE() << "the README has no line: " << begin;
        return "";
    }
    static std::string to_small(std::string text, const std::string& out) {
        const std::string scene = "fox.glb --frames 0-239";
        const size_t at = text.find(scene);
        EXPECT_NE(at, std::string::npos) << text;
        if (at == std::string::npos) return text;
        return text.replace(at, scene.size(),
                            "scene.gltf --no-cache --headless --frames 0-" + std::to_string(kFrameCount - 1) +
                                " --size 48x32 --spp 2 --out " + out + "/f%02d.exr");
    }
    Outcome run(const std::string& command, const std::string& variable = "ZOETROPE_NOTHING") const {
        return run_program({"sh", "-c", command}, folder_.path(), {path_, variable, "DISPLAY", "WAYLAND_DISPLAY"});
    }
    std::string bytes(const std::string& out, int frame) const {
        return read_bytes(folder_ / (out + "/f0" + std::to_string(frame) + ".exr"));
    }
    void expect_whole(const std::string& out) const {
        for (int frame = 0; frame < kFrameCount; ++frame)
            EXPECT_TRUE(bytes(out, frame) == bytes("whole", frame)) << out << ", " << frame;
    }

    const TempFolder folder_;
    std::string path_;
};

TEST_F(ReadmeLines, OfGnuParallelMakesTheFilesOfOneRun) {
    if (run("parallel --version </dev/null").exit_code != 0) GTEST_SKIP() << "GNU parallel is not installed";
    const Outcome outcome = run(to_small(line("parallel zoetrope-demo "), "shares") + " </dev/null");
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    expect_whole("shares");
}

/// As Slurm runs each of the array's tasks.
TEST_F(ReadmeLines, OfSlurmMakesTheFilesOfOneRunAndTheLastLineWhatShowsThemTogether) {
    const std::string all = line("sbatch --array=1-8 --wrap "), wrapped = "--wrap '";
    const size_t begin = all.find(wrapped);
    ASSERT_NE(begin, std::string::npos) << all;
    const std::string task = all.substr(begin + wrapped.size(), all.rfind('\'') - begin - wrapped.size());
    for (int id = 1; id <= 8; ++id) {
        const Outcome outcome = run(to_small(task, "shares"), "SLURM_ARRAY_TASK_ID=" + std::to_string(id));
        EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    }
    expect_whole("shares");
    EXPECT_FALSE(std::filesystem::exists(folder_ / "shares/contact_sheet.png"));
    const Outcome last = run(to_small(line("zoetrope-demo fox.glb --frames 0-239 --resume"), "shares"));
    EXPECT_EQ(last.exit_code, 0) << last.err;
    expect_whole("shares");
    EXPECT_TRUE(std::filesystem::exists(folder_ / "shares/contact_sheet.png"));
}

}  // namespace
}  // namespace zoe::test
