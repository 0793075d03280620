#include <filesystem>
#include <fstream>
#include <iterator>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "apps/bench/peer_embree.h"
#include "engine/bvh/traverse.h"
#include "tests/apps/run_program.h"
#include "tests/support/temp_folder.h"

namespace zoe::test {
namespace {

using Json = nlohmann::json;

Outcome run_bench(const TempFolder& folder, std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), ZOETROPE_BENCH);
    return run_program(arguments, folder.path());
}

std::string read(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

/// Expects one clear line, the exit code, and no file that was not there before.
void expect_refused(const TempFolder& folder, const std::vector<std::string>& arguments, int exit_code,
                    const std::string& part) {
    SCOPED_TRACE(part);
    const std::vector<std::string> before = list_files(folder.path());
    const Outcome outcome = run_bench(folder, arguments);
    EXPECT_EQ(outcome.exit_code, exit_code) << outcome.err;
    EXPECT_EQ(outcome.out, "");
    EXPECT_EQ(lines(outcome.err).size(), 1u) << outcome.err;
    EXPECT_TRUE(outcome.err.starts_with("zoetrope-bench: ")) << outcome.err;
    EXPECT_NE(outcome.err.find(part), std::string::npos) << "'" << part << "' is not in: " << outcome.err;
    EXPECT_EQ(list_files(folder.path()), before);
}

const std::vector<std::string> kSmall = {"instances-20", "--frames", "2", "--size", "16x16", "--repeats", "1"};

std::vector<std::string> small(const std::vector<std::string>& more) {
    std::vector<std::string> arguments = kSmall;
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
}

TEST(BenchBadInput, IsOneLineAndExitCodeTwo) {
    const TempFolder folder;
    expect_refused(folder, {"no_such_scene"}, 2, "default, static, rigid");
    expect_refused(folder, {"default", "rigid-0"}, 2, "rigid-0");
    expect_refused(folder, {"rigid-5*0"}, 2, "rigid-5*0: after the * stands how many copies, from 1 to 10000");
    expect_refused(folder, {"nowhere.glb*3"}, 2, "nowhere.glb");
    expect_refused(folder, {"--threads", "0"}, 2, "--threads");
    expect_refused(folder, {"--threads", "many"}, 2, "--threads");
    for (const char* const option : {"--threads", "--frames", "--repeats", "--size", "--peer", "--json"})
        expect_refused(folder, small({option, ""}), 2, std::string(option) + ": its value is empty");
    expect_refused(folder, {"--frames", "0"}, 2, "--frames");
    expect_refused(folder, {"--repeats", "0"}, 2, "--repeats");
    expect_refused(folder, {"--size", "0x10"}, 2, "--size");
    expect_refused(folder, {"--peer", "other"}, 2, "embree");
    expect_refused(folder, {"--peer-robust"}, 2, "--peer embree");
    expect_refused(folder, small({"--json", "a.json", "--csv", "./a.json"}), 2, "two files");
    expect_refused(folder, {"--expect-hashes", "h.txt", "--repeats", "3"}, 2, "--repeats does not go with");
    expect_refused(folder, small({"--json", "/proc/a.json"}), 2, "/proc/a.json: cannot be written");
    expect_refused(folder, {"--trees", "--csv", "x.csv"}, 2, "--csv does not go with --trees");
    expect_refused(folder, {"--trees", "--exact"}, 2, "--exact does not go with --trees");
    expect_refused(folder, {"--peer", "embree", "--peer-quality", "best"}, 2, "medium or high");
    expect_refused(folder, {"--no-such-option"}, 2, "--no-such-option");
    expect_refused(folder, {"rigid", "--expect-hashes", "h.txt"}, 2, "--expect-hashes");
    expect_refused(folder, {std::string(300, 'x')}, 2, "default, static, rigid");
    expect_refused(folder, small({"--json", "same", "--csv", "same"}), 2, "same");
}

TEST(BenchBadInput, FilesThatCannotBeWrittenAreToldBeforeAnythingRuns) {
    const TempFolder folder;
    std::filesystem::create_directory(folder / "folder");
    for (const char* const option : {"--json", "--csv", "--write-hashes"}) {
        expect_refused(folder, small({option, "nowhere/at/all.txt"}), 2, "nowhere/at/all.txt");
        expect_refused(folder, small({option, "folder"}), 2, "folder");
        expect_refused(folder, small({option, ""}), 2, option);
    }
}

TEST(BenchBadInput, MissingFilesAreTold) {
    const TempFolder folder;
    expect_refused(folder, {"nowhere.glb"}, 2, "nowhere.glb");
    expect_refused(folder, {"--expect-hashes", "nowhere.txt"}, 1, "nowhere.txt");
}

TEST(BenchBadInput, BrokenHashFilesNameTheLine) {
    const TempFolder folder;
    const std::string simd = simd_target();
    folder.write("short.txt", "# a comment\n" + simd + " rigid-2 16x16\n");
    folder.write("digits.txt", simd + " rigid-2 16x16 0123456789abcdeg\n");
    folder.write("size.txt", simd + " rigid-2 16 0123456789abcdef\n");
    folder.write("other.txt", "another_target rigid-2 16x16 0123456789abcdef\n");
    folder.write("empty.txt", "");
    expect_refused(folder, {"--expect-hashes", "short.txt"}, 1, "short.txt: line 2");
    expect_refused(folder, {"--expect-hashes", "digits.txt"}, 1, "digits.txt: line 1: '0123456789abcdeg'");
    expect_refused(folder, {"--expect-hashes", "size.txt"}, 1, "size.txt: line 1");
    expect_refused(folder, {"--expect-hashes", "other.txt"}, 1, "other.txt: no hashes for");
    expect_refused(folder, {"--expect-hashes", "empty.txt"}, 1, "empty.txt: no hashes for");
}

TEST(Bench, ListAndHelpExplain) {
    const TempFolder folder;
    const Outcome list = run_bench(folder, {"--list"});
    EXPECT_EQ(list.exit_code, 0);
    for (const char* const name : {"default", "static", "rigid", "deforming", "skinned", "character", "arbitrary",
                                   "topology", "mixed", "instances-1000", "instances-10000", "instances-100000"})
        EXPECT_NE(list.out.find(std::string("\n  ") + name + " "), std::string::npos) << name;
    const Outcome help = run_bench(folder, {"--help"});
    EXPECT_EQ(help.exit_code, 0);
    for (const char* const option : {"--list", "--frames", "--repeats", "--threads", "--size", "--peer", "--peer-robust",
                                     "--peer-quality", "--peer-two-level", "--exact", "--json", "--csv", "--expect-hashes"})
        EXPECT_NE(help.out.find(option), std::string::npos) << option;
}

/// Every field that DESIGN names, a number unless told otherwise.
void expect_numbers(const Json& frame) {
    for (const char* const field : {"animate_ms", "deform_ms", "update_blas_ms", "build_tlas_ms", "trace_ms", "frame_ms",
                                    "kept", "refitted", "rebuilt", "rays", "hits"}) {
        ASSERT_TRUE(frame.contains(field)) << field;
        EXPECT_TRUE(frame[field].is_number()) << field;
    }
    for (const char* const kind : {"primary", "diffuse", "shadow"}) {
        EXPECT_TRUE(frame["kinds"][kind]["rays"].is_number()) << kind;
        EXPECT_TRUE(frame["kinds"][kind]["ms"].is_number()) << kind;
    }
}

void expect_peer_numbers(const Json& peer) {
    for (const char* const field : {"update_ms", "build_tlas_ms", "trace_ms", "frame_ms", "rays", "disagreements"})
        EXPECT_TRUE(peer[field].is_number()) << field;
    for (const char* const kind : {"primary", "diffuse", "shadow"})
        EXPECT_TRUE(peer["kinds"][kind]["ms"].is_number()) << kind;
}

TEST(Bench, JsonHasEveryField) {
    const TempFolder folder;
    const Outcome outcome = run_bench(folder, small({"--json", "x.json", "--csv", "x.csv", "--threads", "1"}));
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const Json json = Json::parse(read(folder / "x.json"));
    for (const char* const field : {"processor", "compiler", "flags", "simd", "commit"})
        EXPECT_TRUE(json["machine"][field].is_string()) << field;
    ASSERT_EQ(json["scenes"].size(), 1u);
    const Json& scene = json["scenes"][0];
    EXPECT_EQ(scene["scene"], "instances-20");
    EXPECT_EQ(scene["threads"], 1);
    EXPECT_EQ(scene["size"], "16x16");
    EXPECT_EQ(scene["repeats"], 1);
    EXPECT_EQ(scene["nodes"]["rigid"], 20);
    EXPECT_EQ(scene["triangles"], 20 * 80);
    expect_numbers(scene["warm_up"]);
    ASSERT_EQ(scene["frames"].size(), 2u);
    for (const Json& frame : scene["frames"]) {
        expect_numbers(frame);
        EXPECT_EQ(frame["hits_hash"].get<std::string>().size(), 16u);
        EXPECT_EQ(frame["kinds"]["primary"]["rays"], 256);
        EXPECT_GT(frame["hits"], 0);
        double sum = 0.0;
        for (const char* const stage : {"animate_ms", "deform_ms", "update_blas_ms", "build_tlas_ms", "trace_ms"})
            sum += frame[stage].get<double>();
        EXPECT_NEAR(frame["frame_ms"].get<double>(), sum, 1e-9);
        EXPECT_FALSE(frame.contains("peer"));
    }
    EXPECT_EQ(scene["frames"][0]["frame"], 1);
    expect_numbers(scene["median"]);
    expect_numbers(scene["p99"]);

    const std::vector<std::string> table = lines(read(folder / "x.csv"));
    ASSERT_EQ(table.size(), 3u);
    const auto commas = [](const std::string& line) { return std::ranges::count(line, ','); };
    EXPECT_EQ(commas(table[1]), commas(table[0]));
    EXPECT_EQ(commas(table[2]), commas(table[0]));
}

TEST(Bench, CopiesStandSideBySide) {
    const TempFolder folder;
    const Outcome outcome =
        run_bench(folder, {"rigid-5*3", "--frames", "2", "--size", "16x16", "--repeats", "1", "--json", "x.json"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const Json scene = Json::parse(read(folder / "x.json"))["scenes"][0];
    EXPECT_EQ(scene["scene"], "rigid-5*3");
    EXPECT_EQ(scene["nodes"]["rigid"], 15);
    EXPECT_EQ(scene["triangles"], 15 * 1000);
    for (const Json& frame : scene["frames"]) EXPECT_GT(frame["hits"], 0);
}

TEST(Bench, ThePeerRunsTheSameFrames) {
    if (!is_embree_available()) GTEST_SKIP() << "built without Embree";
    const TempFolder folder;
    const Outcome outcome =
        run_bench(folder, {"mixed-1", "--frames", "2", "--size", "48x48", "--peer", "embree", "--peer-robust", "--json",
                           "x.json", "--csv", "x.csv", "--disagreements", "d.txt"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_NE(outcome.out.find("robust"), std::string::npos);
    const Json json = Json::parse(read(folder / "x.json"));
    const Json& scene = json["scenes"][0];
    EXPECT_GT(scene["peer"]["tried"].size(), 1u);
    EXPECT_TRUE(scene["peer"]["configuration"].is_string());
    EXPECT_TRUE(scene["peer"]["ratios"]["frame"].is_number());
    uint64_t disagreements = scene["warm_up"]["peer"]["disagreements"].get<uint64_t>();
    for (const Json& frame : scene["frames"]) {
        expect_peer_numbers(frame["peer"]);
        EXPECT_EQ(frame["peer"]["rays"], frame["rays"]);
        disagreements += frame["peer"]["disagreements"].get<uint64_t>();
    }
    expect_peer_numbers(scene["median"]["peer"]);
    const Json& verdicts = scene["peer"]["disagreements"];
    EXPECT_EQ(verdicts["peer_right"], 0) << verdicts;
    EXPECT_EQ(verdicts["neither_right"], 0) << verdicts;
    uint64_t verdict_count = 0;
    for (const auto& [name, count] : verdicts.items()) verdict_count += count.get<uint64_t>();
    EXPECT_EQ(verdict_count, disagreements);
    EXPECT_LT(disagreements, 20u) << verdicts;
    EXPECT_TRUE(read(folder / "d.txt").starts_with("# mixed-1\n"));
}

TEST(Bench, TreesAreComparedAndAgree) {
    const TempFolder folder;
    std::vector<std::string> arguments = {"--trees", "arbitrary-500", "instances-20", "--size", "32x32", "--json", "x.json"};
    if (is_embree_available()) arguments.insert(arguments.end(), {"--peer", "embree", "--peer-robust"});
    const Outcome outcome = run_bench(folder, arguments);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const Json trees = Json::parse(read(folder / "x.json"))["trees"];
    ASSERT_EQ(trees.size(), 2u);
    for (const Json& scene : trees) {
        EXPECT_GT(scene["triangles"], 499);
        EXPECT_EQ(scene["rays"]["primary"], 32 * 32);
        size_t peer_count = 0;
        for (const Json& row : scene["rows"]) {
            SCOPED_TRACE(row.dump());
            for (const char* const field :
                 {"build_ms", "bytes", "primary_ms", "primary_single_ms", "diffuse_ms", "shadow_ms"})
                EXPECT_GT(row[field], 0.0) << field;
            EXPECT_LT(row["disagreements"], 5);
            peer_count += row["is_peer"].get<bool>();
            EXPECT_GT(row["bytes_per_triangle"], 10.0);
            if (row["is_peer"]) {
                uint64_t verdict_count = 0;
                for (const auto& [name, count] : row["verdicts"].items()) verdict_count += count.get<uint64_t>();
                EXPECT_EQ(row["disagreements"], verdict_count);
                EXPECT_EQ(row["verdicts"]["peer_right"], 0);
                EXPECT_EQ(row["verdicts"]["not_judged"], 0);
                continue;
            }
            const Json& binary = row["binary"];
            EXPECT_GT(binary["sah"], 1.0);
            EXPECT_GT(binary["epo"], 0.0);
            EXPECT_FALSE(binary["epo_is_sampled"]);
            EXPECT_GE(binary["depth"], row["depth"]);
            EXPECT_EQ(binary["references"].get<uint64_t>() - binary["duplicates"].get<uint64_t>(), scene["triangles"]);
            EXPECT_GE(row["nodes_per_ray"], 1.0);
            EXPECT_GT(row["sah"], 0.0);
            EXPECT_EQ(row["disagreements"], 0);
        }
        EXPECT_EQ(scene["rows"][0]["tree"], "median split");
        EXPECT_EQ(peer_count, is_embree_available() ? 3u : 0u);
    }
    for (const char* const claim : {"sweep against median split: ", "binned against sweep: "})
        EXPECT_NE(outcome.out.find(claim), std::string::npos) << claim;
    EXPECT_EQ(outcome.out.find("nan"), std::string::npos) << outcome.out;
}

TEST(Bench, HashesAreTheSameOnAnyNumberOfThreadsAndADifferenceIsFound) {
    const TempFolder folder;
    ASSERT_EQ(run_bench(folder, small({"--threads", "1", "--write-hashes", "h.txt"})).exit_code, 0);
    EXPECT_EQ(run_bench(folder, {"--exact", "--expect-hashes", "h.txt"}).exit_code, 0) << "another tree, the same hits";
    const Outcome same = run_bench(folder, {"--expect-hashes", "h.txt", "--threads", "2"});
    EXPECT_EQ(same.exit_code, 0) << same.err;

    std::string text = read(folder / "h.txt");
    const size_t target = text.find("\n") + 1;
    folder.write("all.txt", "* " + text.substr(text.find(' ', target) + 1));
    EXPECT_EQ(run_bench(folder, {"--expect-hashes", "all.txt"}).exit_code, 0) << "a line for all targets";
    const size_t last_digit = text.size() - 2;
    text[last_digit] = text[last_digit] == '0' ? '1' : '0';
    folder.write("h.txt", text);
    const Outcome other = run_bench(folder, {"--expect-hashes", "h.txt"});
    EXPECT_EQ(other.exit_code, 1);
    EXPECT_NE(other.err.find("instances-20, frame 2"), std::string::npos) << other.err;
}

TEST(Bench, HashesOfTheBenchmarksOwnScenesAreThoseOfTheirOwnSizes) {
    const TempFolder folder;
    const Outcome written =
        run_bench(folder, {"skinned", "--frames", "1", "--size", "16x16", "--repeats", "1", "--write-hashes", "h.txt"});
    ASSERT_EQ(written.exit_code, 0) << written.err;
    const Outcome same = run_bench(folder, {"--expect-hashes", "h.txt"});
    EXPECT_EQ(same.exit_code, 0) << same.err;
}

TEST(Bench, WhatIsDoneIsWrittenWhereALaterSceneIsBroken) {
    const TempFolder folder;
    folder.write("broken.glb", "no scene");
    const Outcome outcome = run_bench(folder, small({"broken.glb", "--json", "x.json"}));
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_EQ(Json::parse(read(folder / "x.json"))["scenes"].size(), 1u);
}

TEST(Bench, OwnLinesGoBeforeThoseForAllTargets) {
    const TempFolder folder;
    ASSERT_EQ(run_bench(folder, small({"--write-hashes", "h.txt"})).exit_code, 0);
    const std::string wrong = "* instances-20 16x16 0123456789abcdef 0123456789abcdef\n";
    folder.write("all.txt", wrong);
    EXPECT_EQ(run_bench(folder, {"--expect-hashes", "all.txt"}).exit_code, 1);
    folder.write("own.txt", wrong + read(folder / "h.txt"));
    const Outcome own = run_bench(folder, {"--expect-hashes", "own.txt"});
    EXPECT_EQ(own.exit_code, 0) << own.err;
}

TEST(Bench, WritingHashesKeepsOtherTargets) {
    const TempFolder folder;
    const std::string simd = simd_target();
    folder.write("h.txt", "another_target rigid-2 16x16 0123456789abcdef\n" + simd + " rigid-2 16x16 0123456789abcdef\n");
    ASSERT_EQ(run_bench(folder, small({"--write-hashes", "h.txt"})).exit_code, 0);
    const std::string text = read(folder / "h.txt");
    EXPECT_NE(text.find("another_target rigid-2 16x16 0123456789abcdef\n"), std::string::npos) << text;
    EXPECT_EQ(text.find(simd + " rigid-2"), std::string::npos) << text;
    EXPECT_NE(text.find(simd + " instances-20 16x16 "), std::string::npos) << text;
}

}  // namespace
}  // namespace zoe::test
