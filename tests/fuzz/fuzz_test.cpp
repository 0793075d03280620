// Files that are broken in any way load or are refused: a seeded mutation of small files, the same on every machine.

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string_view>

#include <gtest/gtest.h>

#include "engine/math/parallel.h"
#include "tests/fuzz/files.h"
#include "tests/fuzz/loop.h"
#include "tests/fuzz/mutate.h"
#include "tests/fuzz/seeds.h"
#include "tests/support/assets.h"
#include "tests/support/long_run.h"

namespace zoe::test {
namespace {

namespace fs = std::filesystem;

struct Rounds {
    uint64_t begin = 0, end = 0;
};

/// $ZOETROPE_FUZZ_ROUNDS, BEGIN-END, where it is set: the rounds of every target. A round makes the same input wherever it
/// is run, so that several processes can share the work, and one round be looked at alone.
Rounds rounds_of(uint64_t few, uint64_t many) {
    const char* const text = std::getenv("ZOETROPE_FUZZ_ROUNDS");
    if (text == nullptr) return {0, is_long_run() ? many : few};
    Rounds rounds;
    const std::string_view view = text;
    const char* const last = view.data() + view.size();
    const std::from_chars_result begin = std::from_chars(view.data(), last, rounds.begin);
    const bool has_dash = begin.ec == std::errc{} && begin.ptr != last && *begin.ptr == '-';
    if (!has_dash || std::from_chars(begin.ptr + 1, last, rounds.end).ptr != last) {
        ADD_FAILURE() << "ZOETROPE_FUZZ_ROUNDS is '" << text << "'; it must be BEGIN-END";
    }
    return rounds;
}

/// Runs the rounds; some inputs must load and some be refused, or nothing was tried.
void fuzz(const FuzzTarget& target, Rounds rounds) {
    set_thread_count(1);
    for (const std::string& seed : target.seeds) {
        const FuzzOutcome outcome = target.entry(as_bytes(seed));
        EXPECT_TRUE(outcome.is_accepted) << target.name << ": a seed of " << seed.size() << " bytes does not load";
        EXPECT_EQ(outcome.broken, "");
    }
    const FuzzCounts counts = run_rounds(target, rounds.begin, rounds.end);
    EXPECT_EQ(counts.failure, "");
    std::printf("%s: rounds %llu to %llu, %llu loaded\n", target.name, static_cast<unsigned long long>(rounds.begin),
                static_cast<unsigned long long>(rounds.begin + counts.executed),
                static_cast<unsigned long long>(counts.accepted));
    if (counts.executed >= 200) {
        EXPECT_GT(counts.accepted, counts.executed / 50);
        EXPECT_LT(counts.accepted, counts.executed - counts.executed / 50);
    }
    set_thread_count(0);
}

TEST(Fuzz, GltfLoadsOrIsRefused) {
    fuzz({"gltf", fuzz_gltf, gltf_seeds(), mutate_gltf}, rounds_of(3000, 3'000'000));
}

TEST(Fuzz, ImagesLoadOrAreRefused) {
    fuzz({"image", fuzz_image, image_seeds(), mutate_image}, rounds_of(3000, 3'000'000));
}

TEST(Fuzz, SequencesLoadOrAreRefused) {
    fuzz({"sequence", fuzz_sequence, sequence_seeds(), mutate_sequence}, rounds_of(500, 1'000'000));
}

TEST(Fuzz, TreesLoadOrAreRefused) {
    fuzz({"tree_file", fuzz_tree_file, tree_seeds(), mutate_tree}, rounds_of(10000, 10'000'000));
}

// Models that others made hold what the seeds do not. Large ones would take the time of many small ones.
TEST(Fuzz, AssetsLoadOrAreRefused) {
    const auto assets = assets_folder(ZOETROPE_SOURCE_DIR);
    if (!assets) GTEST_SKIP() << kNoAssets;
    std::vector<std::string> seeds;
    for (const std::string& name : gltf_files(*assets)) {
        if (fs::file_size(*assets / name) > 20000) continue;
        std::string bytes = read_bytes(*assets / name);
        if (fuzz_gltf(as_bytes(bytes)).is_accepted) seeds.push_back(std::move(bytes));
    }
    if (seeds.empty()) GTEST_SKIP() << "no small model that stands alone";
    fuzz({"assets", fuzz_gltf, seeds, mutate_gltf}, rounds_of(1000, 1'000'000));
}

TEST(Fuzz, EveryPrefixIsRefusedOrLoads) {
    const auto expect_sound = [](FuzzEntry entry, const std::string& bytes) {
        for (size_t size = 0; size < bytes.size(); ++size) {
            const FuzzOutcome outcome = entry(as_bytes(bytes).first(size));
            ASSERT_EQ(outcome.broken, "") << size << " of " << bytes.size() << " bytes";
        }
    };
    for (const std::string& seed : gltf_seeds()) {
        expect_sound(fuzz_gltf, seed);
        if (!seed.starts_with("glTF")) continue;
        for (size_t size = 0; size < seed.size(); ++size) {
            ASSERT_FALSE(fuzz_gltf(as_bytes(seed).first(size)).is_accepted) << size << " of " << seed.size() << " bytes";
        }
    }
    for (const std::string& seed : image_seeds()) expect_sound(fuzz_image, seed);
    for (const std::string& seed : tree_seeds()) expect_sound(fuzz_tree_file, seed.substr(0, 3000));
}

// Inputs that broke something once, named by the reader that they are for: gltf-..., image-..., sequence-..., tree_file-...
TEST(Fuzz, WhatBrokeOnceStaysMended) {
    const std::pair<std::string_view, FuzzEntry> entries[] = {
        {"gltf-", fuzz_gltf}, {"image-", fuzz_image}, {"sequence-", fuzz_sequence}, {"tree_file-", fuzz_tree_file}};
    for (const fs::directory_entry& file :
         fs::directory_iterator(fs::path(ZOETROPE_SOURCE_DIR) / "tests/fuzz/regressions")) {
        const std::string name = file.path().filename().string();
        const auto found = std::ranges::find_if(entries, [&](const auto& entry) { return name.starts_with(entry.first); });
        if (found == std::end(entries)) continue;
        const std::string bytes = read_bytes(file.path());
        EXPECT_EQ(found->second(as_bytes(bytes)).broken, "") << name;
    }
}

TEST(Fuzz, ARoundIsTheSameWhereverItIsRun) {
    const FuzzTarget target{"gltf", fuzz_gltf, gltf_seeds(), mutate_gltf};
    std::vector<std::string> inputs;
    for (uint64_t round = 0; round < 50; ++round) inputs.push_back(fuzz_input(target, round));
    for (uint64_t round = 50; round-- > 0;) EXPECT_EQ(fuzz_input(target, round), inputs[round]);
    std::ranges::sort(inputs);
    EXPECT_GT(std::unique(inputs.begin(), inputs.end()) - inputs.begin(), 45);
}

}  // namespace
}  // namespace zoe::test
