#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "engine/math/parallel.h"
#include "tests/fuzz/entries.h"
#include "tests/fuzz/mutate.h"
#include "tests/fuzz/seeds.h"

/// libFuzzer's own changes, within the buffer.
extern "C" size_t LLVMFuzzerMutate(uint8_t* data, size_t size, size_t max_size);

/// What libFuzzer calls. A promise that is not kept ends the program, as a crash does, so that the input is kept.
extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    static const bool is_ready = [] {
        zoe::set_thread_count(1);
        return true;
    }();
    const zoe::test::FuzzOutcome outcome = zoe::test::ZOETROPE_FUZZ_ENTRY(std::as_bytes(std::span(data, size)));
    if (is_ready && outcome.broken.empty()) return 0;
    std::fprintf(stderr, "%s\n", outcome.broken.c_str());
    std::abort();
}

/// How libFuzzer makes an input of another: as it would, or as the seeded test does, which knows the format. Where it
/// begins, with nothing, and now and then later, the input is one of the seeds: no folder of them is needed.
extern "C" size_t LLVMFuzzerCustomMutator(uint8_t* data, size_t size, size_t max_size, unsigned seed) {
    static const std::vector<std::string> seeds = zoe::test::ZOETROPE_FUZZ_SEEDS();
    zoe::Rng rng(zoe::mix_bits(uint64_t{seed} + 1));
    std::string input(reinterpret_cast<const char*>(data), size);
    const bool is_too_small = size < 8;  // For a format; before the first seed, libFuzzer tries a byte.
    if (is_too_small || rng.below(64) == 0) {
        input = zoe::test::pick(seeds, rng);
    } else if (rng.below(2) == 0) {
        return LLVMFuzzerMutate(data, size, max_size);
    } else {
        zoe::test::ZOETROPE_FUZZ_MUTATE(input, seeds, rng);
    }
    const size_t made = std::min(input.size(), max_size);
    std::memcpy(data, input.data(), made);
    return made;
}
