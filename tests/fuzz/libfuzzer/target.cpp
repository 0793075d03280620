#include <cstdio>
#include <cstdlib>

#include "engine/math/parallel.h"
#include "tests/fuzz/entries.h"

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
