#include <csignal>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>
#include <glm/geometric.hpp>

#include "apps/common/contact_sheet.h"
#include "apps/common/numbered_path.h"
#include "apps/common/parse.h"
#include "apps/common/picture.h"
#include "apps/common/program_pipe.h"
#include "apps/common/progress.h"
#include "apps/common/stats_json.h"
#include "apps/common/usage_error.h"
#include "apps/common/write_file.h"
#include "apps/demo/orbit.h"
#include "tests/apps/run_program.h"
#include "tests/support/temp_folder.h"

namespace zoe::test {
namespace {

TEST(NumberedPath, FillsInTheNumberAsPrintfDoes) {
    EXPECT_EQ(NumberedPath("out/frame_%04d.png")(7), "out/frame_0007.png");
    EXPECT_EQ(NumberedPath("out/frame_%04d.png")(123456), "out/frame_123456.png");
    EXPECT_EQ(NumberedPath("%d.exr")(12), "./12.exr");
    EXPECT_EQ(NumberedPath("/%3d.exr")(1), "/  1.exr");
    EXPECT_EQ(NumberedPath("100%%_%d.png")(1), "./100%_1.png");
    EXPECT_EQ(NumberedPath("a/b/c.png")(1), "a/b/c.png");
    EXPECT_FALSE(NumberedPath("c%%d.png").has_number());
    EXPECT_EQ(NumberedPath("out/frame_%04d.png").extension(), ".png");
    EXPECT_EQ(NumberedPath("out/frame_%04d.png").folder(), "out");
}

TEST(Parse, FramesSizesAndPoints) {
    EXPECT_EQ(parse_frames("3-7").count(), 5);
    EXPECT_EQ(parse_frames("9").first, 9);
    EXPECT_EQ(parse_frames("5-1000004").count(), kMaxFrameCount);
    EXPECT_THROW(parse_frames("5-1000005"), UsageError);
    EXPECT_EQ(parse_size("640x360").height, 360);
    EXPECT_EQ(parse_point("1,-2.5,3e1", "--eye"), glm::dvec3(1.0, -2.5, 30.0));
    EXPECT_EQ(parse_point("16777217.5,0,0", "--eye").x, 16777217.5) << "finer than a float";
    EXPECT_EQ(parse_numbers("1,-2.5", 2), (std::vector<double>{1.0, -2.5}));
    for (const char* const text : {"", "1", "1,", "1,2,3", "1,x", "1,nan", "sky.hdr"}) EXPECT_FALSE(parse_numbers(text, 2));
    EXPECT_THROW(parse_frames(""), UsageError);
    EXPECT_THROW(parse_frames("-"), UsageError);
    EXPECT_THROW(parse_frames("+1-2"), UsageError);
    EXPECT_THROW(parse_point("1,2,3,4", "--eye"), UsageError);
    EXPECT_THROW(parse_point("1,2,inf", "--eye"), UsageError);
    EXPECT_EQ(parse_point("0,0,25e15", "--eye").z, 25e15);
    EXPECT_EQ(parse_point("0,-1e18,0", "--eye").y, -1e18);
    try {
        parse_point("1e30,0,0", "--eye");
        FAIL() << "taken";
    } catch (const UsageError& error) {
        EXPECT_NE(std::string(error.what()).find("too far"), std::string::npos) << error.what();
    }
}

TEST(Percentile, IsTheNearestRank) {
    EXPECT_EQ(percentile({}, 0.5), 0.0);
    EXPECT_EQ(percentile({3.0}, 0.99), 3.0);
    EXPECT_EQ(percentile({4.0, 1.0, 3.0, 2.0}, 0.5), 2.5);
    EXPECT_EQ(percentile({3.0, 1.0, 2.0}, 0.5), 2.0);
    std::vector<double> hundred;
    for (int i = 100; i > 0; --i) hundred.push_back(i);
    EXPECT_EQ(percentile(hundred, 0.99), 99.0);
}

TEST(Spread, HasTheFirstAndTheLast) {
    EXPECT_EQ(spread(3, 12), (std::vector<size_t>{0, 1, 2}));
    EXPECT_EQ(spread(1, 12), (std::vector<size_t>{0}));
    const std::vector<size_t> many = spread(1000, 12);
    EXPECT_EQ(many.size(), 12u);
    EXPECT_EQ(many.front(), 0u);
    EXPECT_EQ(many.back(), 999u);
}

TEST(Shrink, KeepsTheMean) {
    Picture picture{6, 2, std::vector<uint8_t>(6 * 2 * 4)};
    for (size_t i = 0; i < picture.rgba.size(); ++i) picture.rgba[i] = static_cast<uint8_t>(i / 4 % 6 < 3 ? 30 : 90);
    const Picture half = shrink(picture, 2);
    EXPECT_EQ(half.width, 2);
    EXPECT_EQ(half.height, 1);
    EXPECT_EQ(half.rgba, (std::vector<uint8_t>{30, 30, 30, 30, 90, 90, 90, 90}));
    EXPECT_EQ(shrink(picture, 6).rgba, picture.rgba);
}

TEST(WriteFile, LeavesNothingBehindOnFailure) {
    const TempFolder folder;
    write_file(folder / "a.txt", "one");
    write_file(folder / "a.txt", "two");
    EXPECT_EQ(std::filesystem::file_size(folder / "a.txt"), 3u);
    std::filesystem::create_directory(folder / "b.txt");
    EXPECT_THROW(write_file(folder / "b.txt", "text"), std::runtime_error);
    EXPECT_EQ(list_files(folder.path()), (std::vector<std::string>{"a.txt", "b.txt"}));
}

TEST(WriteFile, LinkStaysAndWhatItLeadsToIsWritten) {
    const TempFolder folder;
    folder.write("deep/target.txt", "old");
    std::filesystem::create_symlink("deep/target.txt", folder / "link.txt");
    std::filesystem::create_symlink("link.txt", folder / "link_to_link.txt");
    std::filesystem::create_symlink("deep/new.txt", folder / "dangling.txt");
    std::filesystem::create_symlink("nowhere/new.txt", folder / "to_nowhere.txt");
    std::filesystem::create_symlink("cycle.txt", folder / "cycle.txt");
    for (const char* const name : {"link_to_link.txt", "dangling.txt"}) {
        require_writable(folder / name);
        write_file(folder / name, "longer");
        EXPECT_TRUE(std::filesystem::is_symlink(folder / name)) << name;
        EXPECT_EQ(std::filesystem::file_size(folder / name), 6u) << name;
    }
    EXPECT_TRUE(std::filesystem::is_symlink(folder / "link.txt"));
    for (const char* const name : {"to_nowhere.txt", "cycle.txt"}) {
        EXPECT_THROW(require_writable(folder / name), std::runtime_error) << name;
        EXPECT_THROW(write_file(folder / name, "text"), std::runtime_error) << name;
    }
    EXPECT_EQ(list_files(folder.path()),
              (std::vector<std::string>{"cycle.txt", "dangling.txt", "deep", "deep/new.txt", "deep/target.txt", "link.txt",
                                        "link_to_link.txt", "to_nowhere.txt"}));
}

TEST(WriteFile, PipesAndDevicesAreWrittenInto) {
    const TempFolder folder;
    const std::filesystem::path pipe = folder / "pipe";
    ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
    const int reader = open(pipe.c_str(), O_RDONLY | O_NONBLOCK);
    ASSERT_GE(reader, 0);
    require_writable(pipe);
    write_file(pipe, "text");
    char bytes[8] = {};
    EXPECT_EQ(read(reader, bytes, sizeof bytes), 4);
    EXPECT_STREQ(bytes, "text");
    close(reader);
    EXPECT_TRUE(std::filesystem::is_fifo(pipe));

    std::filesystem::create_symlink("/dev/null", folder / "null");
    std::filesystem::create_symlink("/dev/full", folder / "full");
    require_writable(folder / "null");
    write_file(folder / "null", "text");
    EXPECT_THROW(write_file(folder / "full", "text"), std::runtime_error);
    EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
    EXPECT_EQ(list_files(folder.path()), (std::vector<std::string>{"full", "null", "pipe"}));
}

TEST(ProgramPipe, TellsHowAProgramEnded) {
    const std::vector<uint8_t> bytes(1 << 20, 'x');
    ProgramPipe reader({"cat"});
    ASSERT_TRUE(reader.is_running());
    EXPECT_TRUE(reader.write(bytes));
    EXPECT_EQ(reader.close(), "");
    ProgramPipe refuser({"false"});
    ASSERT_TRUE(refuser.is_running());
    refuser.write(bytes);  // fails, and must not end this program
    EXPECT_EQ(refuser.close(), "ended with code 1");
    ProgramPipe missing({"no-such-program-anywhere"});
    EXPECT_FALSE(missing.is_running());
    EXPECT_EQ(missing.start_error(), ENOENT);
}

TEST(Duration, ReadsAsAClockDoes) {
    EXPECT_EQ(format_duration(7.0), "0:07");
    EXPECT_EQ(format_duration(750.0), "12:30");
    EXPECT_EQ(format_duration(3723.0), "1:02:03");
}

TEST(Orbit, SeesWhatTheViewSaw) {
    const Aabb bounds{glm::vec3(-1.0f, 0.0f, -1.0f), glm::vec3(1.0f, 2.0f, 1.0f)};
    const View view = look_at({3.0f, 2.0f, 4.0f}, {0.0f, 1.0f, 0.0f}, 50.0f, 1.5f);
    const Orbit orbit = orbit_from_view(view, bounds);
    const ViewChoice::LookAt same = orbit.look_at();
    EXPECT_LT(glm::distance(same.eye, view.origin), 1e-4f);
    EXPECT_NEAR(same.fov_degrees, 50.0f, 1e-3f);
    EXPECT_LT(glm::distance(glm::normalize(same.target - same.eye), -view.axis_z), 1e-5f);
}

TEST(Orbit, TurnsAroundItsTargetAndPansAcross) {
    Orbit orbit;
    orbit.target = {1.0f, 2.0f, 3.0f};
    orbit.distance = 4.0f;
    orbit.turn(150.0f, 70.0f, 400.0f);
    EXPECT_NEAR(glm::distance(orbit.look_at().eye, orbit.target), 4.0f, 1e-5f);
    orbit.turn(0.0f, 1e6f, 400.0f);
    EXPECT_LT(orbit.pitch, 1.5708f);  // never over the top

    Orbit level;
    level.pan(100.0f, 0.0f, 400.0f);  // to the right: the scene follows the mouse
    EXPECT_LT(level.target.x, 0.0f);
    EXPECT_NEAR(level.target.y, 0.0f, 1e-6f);
    level = {};
    level.pan(0.0f, 100.0f, 400.0f);
    EXPECT_GT(level.target.y, 0.0f);
    level = {};
    level.zoom(1.0f);
    EXPECT_NEAR(level.distance, 0.9f, 1e-6f);
}

}  // namespace
}  // namespace zoe::test
