#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <new>
#include <set>
#include <thread>

#include <fmt/format.h>

#include "apps/bench/bench_scenes.h"
#include "apps/bench/hashes.h"
#include "apps/bench/machine.h"
#include "apps/bench/options.h"
#include "apps/bench/peer_embree.h"
#include "apps/bench/play.h"
#include "apps/bench/report.h"
#include "apps/bench/trees.h"
#include "apps/bench/trees_report.h"
#include "apps/common/interrupt.h"
#include "apps/common/open_scene.h"
#include "apps/common/progress.h"
#include "apps/common/usage_error.h"
#include "apps/common/write_file.h"

namespace zoe {
namespace {

constexpr const char* kProgram = "zoetrope-bench";
/// Of a scene, in the file of disagreements.
constexpr size_t kMaxWritten = 100;

int fail(int exit_code, const std::string& message) {
    std::fputs(fmt::format("{}: {}\n", kProgram, one_line(message)).c_str(), stderr);  // fmt::print throws on a full disk
    return exit_code;
}

/// Finds out before long work what would stop it after.
void check_outputs(const Options& options, const std::vector<BenchScene>& scenes) {
    for (const BenchScene& scene : scenes) {
        if (options.written_hashes && scene.name.find_first_of(" \t\n") != std::string::npos)
            throw UsageError(
                fmt::format("--write-hashes: a line of its file cannot hold a name with a space: {}", scene.name));
    }
    std::set<std::filesystem::path> names;
    const auto add = [&](const std::string& file) {
        std::error_code ignored;
        const std::filesystem::path name = std::filesystem::weakly_canonical(std::filesystem::absolute(file), ignored);
        if (!names.insert(ignored ? std::filesystem::path(file) : name).second)
            throw UsageError(fmt::format("{}: two files of the command line are this one", file));
    };
    if (options.expected_hashes) add(*options.expected_hashes);
    for (const BenchScene& scene : scenes) names.insert(std::filesystem::absolute(scene.scene));
    for (const std::optional<std::string>* file :
         {&options.json, &options.csv, &options.disagreements, &options.written_hashes}) {
        if (!*file) continue;
        add(**file);
        try {
            require_writable(**file);
        } catch (const std::runtime_error& error) {
            throw UsageError(error.what());
        }
    }
    std::error_code ignored;
    if (options.written_hashes && std::filesystem::is_regular_file(*options.written_hashes, ignored))
        read_hashes(*options.written_hashes);  // a broken file is told now
}

/// The hash file's lines for this machine's vector instructions.
std::vector<SceneHashes> expected_hashes(const Options& options) {
    if (!options.expected_hashes) return {};
    std::vector<SceneHashes> lines = lines_for_this_target(read_hashes(*options.expected_hashes));
    if (lines.empty()) {
        throw std::runtime_error(fmt::format("{}: no hashes for {}", *options.expected_hashes, simd_target()));
    }
    return lines;
}

std::vector<BenchScene> choose_scenes(const Options& options, const std::vector<SceneHashes>& expected) {
    std::vector<BenchScene> scenes;
    if (options.expected_hashes) {
        for (const SceneHashes& line : expected) {
            BenchScene scene = find_bench_scene(line.scene);
            scene.frame_count = static_cast<int>(line.hashes.size());
            scene.size = line.size;
            scene.repeats = 1;
            scenes.push_back(std::move(scene));
        }
        return scenes;
    }
    if (options.scenes.empty() && options.compares_trees) {
        scenes = {find_bench_scene("static"), find_bench_scene("deforming")};
    } else if (options.scenes.empty()) {
        scenes.assign(bench_scenes().begin(), bench_scenes().end());
    }
    for (const std::string& name : options.scenes) scenes.push_back(find_bench_scene(name));
    for (BenchScene& scene : scenes) {
        if (options.frames) scene.frame_count = *options.frames;
        if (options.size) scene.size = *options.size;
        if (options.repeats) scene.repeats = *options.repeats;
    }
    return scenes;
}

Played play_with_progress(const BenchScene& scene, const PlayConfig& config) {
    Progress progress(scene.name, 1.0);
    return play(scene, config, [&](double share, const std::string& detail) { progress.update(share, detail); });
}

std::string disagreements_text(const Played& played) {
    std::string text = fmt::format("# {}\n", played.run.scene);
    const size_t count = std::min(played.disagreements.size(), kMaxWritten);
    for (size_t k = 0; k < count; ++k) text += describe(played.disagreements[k], played.verdicts[k]) + "\n";
    return text;
}

using Machine = std::vector<std::pair<std::string, std::string>>;

void run_trees(const Options& options, const std::vector<BenchScene>& scenes, const PlayConfig& config,
               const Machine& machine) {
    std::vector<TreeComparison> comparisons;
    for (const BenchScene& scene : scenes) {
        Progress progress(scene.name, 1.0);
        comparisons.push_back(
            compare_trees(scene, config, [&](double share, const std::string& detail) { progress.update(share, detail); }));
        fmt::print("{}", trees_table(comparisons.back()));
        std::fflush(stdout);
        if (options.json) write_file(*options.json, trees_json(comparisons, machine));
    }
    fmt::print("{}", trees_summary(comparisons));
}

/// Returns the exit code.
int run(const Options& options) {
    set_thread_count(options.threads);
    const std::vector<SceneHashes> expected = expected_hashes(options);
    const std::vector<BenchScene> scenes = choose_scenes(options, expected);
    const int core_count = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
    if (options.has_peer && thread_count() > core_count) {
        throw UsageError(fmt::format("--threads {}: with --peer embree at most {}: Embree runs no more threads than cores",
                                     thread_count(), core_count));
    }
    check_outputs(options, scenes);
    catch_interrupts();

    const PlayConfig config{.is_exact = options.is_exact, .has_peer = options.has_peer, .peer = options.peer};
    Machine machine = describe_machine();
    if (options.has_peer) machine.emplace_back("peer", EmbreePeer::version());
    fmt::print("{}", machine_text(machine));
    if (options.compares_trees) {
        run_trees(options, scenes, config, machine);
        return 0;
    }
    fmt::print("\n{}", stages_heading(options.has_peer));
    std::vector<RunStats> runs;
    std::vector<SceneHashes> hashes;
    std::string disagreements, differences;
    const auto write_results = [&] {
        if (options.json) write_file(*options.json, bench_json(runs, machine));
        if (options.csv) write_file(*options.csv, csv(runs));
        if (options.disagreements) write_file(*options.disagreements, disagreements);
    };
    for (size_t k = 0; k < scenes.size(); ++k) {
        Played played;
        try {
            played = play_with_progress(scenes[k], config);
        } catch (...) {
            if (!runs.empty()) write_results();  // what is done is not lost
            throw;
        }
        fmt::print("{}", stages_line(played.run));
        std::fflush(stdout);
        disagreements += disagreements_text(played);
        hashes.push_back(hashes_of(played.run, scenes[k].size));
        if (options.expected_hashes) differences += describe_difference(expected[k], hashes.back());
        runs.push_back(std::move(played.run));
    }
    fmt::print("\n{}", rays_table(runs));
    write_results();
    if (options.written_hashes) write_hashes(*options.written_hashes, hashes);
    if (options.expected_hashes) {
        fmt::print(stderr, "{}", differences);
        if (!differences.empty()) return 1;
        fmt::print("\nall hits are what {} expects\n", *options.expected_hashes);
    }
    return 0;
}

}  // namespace
}  // namespace zoe

int main(int argc, char** argv) {
    using namespace zoe;
    try {
        const std::optional<Options> options = parse_options(argc, argv);
        if (!options) return 0;
        if (options->is_list) {
            fmt::print("{}", list_bench_scenes());
            return 0;
        }
        return run(*options);
    } catch (const UsageError& error) {
        return fail(2, error.what());
    } catch (const Interrupted& error) {
        return fail(kInterruptedCode, error.what());
    } catch (const std::bad_alloc&) {
        return fail(1, "out of memory");
    } catch (const std::exception& error) {
        return fail(1, error.what());
    }
}
