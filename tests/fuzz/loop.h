#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/math/rng.h"
#include "tests/fuzz/entries.h"

namespace zoe::test {

/// A reader, what to begin from, and how to change that.
struct FuzzTarget {
    const char* name;
    FuzzEntry entry;
    std::vector<std::string> seeds;
    void (*mutate)(std::string& bytes, std::span<const std::string> others, Rng& rng);
};

struct FuzzCounts {
    uint64_t executed = 0, accepted = 0;
    std::string failure;  ///< What broke first, and in which round; empty where nothing did.
};

/// The input of a round: one of the seeds, changed. The same for the same round, whatever was run before.
std::string fuzz_input(const FuzzTarget& target, uint64_t round);

/// Runs rounds [begin, end) one after another, in this process. Of a promise that is not kept, a crash, a sanitizer's
/// report, a round of more than 30 s of processor time, or one that takes more than the limit on memory, the input is kept
/// as `fuzz-NAME-ROUND` in the folder for temporary files, and named on stderr.
FuzzCounts run_rounds(const FuzzTarget& target, uint64_t begin, uint64_t end);

}  // namespace zoe::test
