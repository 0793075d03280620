#include "apps/bench/timed_parallel.h"

#include "apps/bench/stopwatch.h"
#include "apps/common/interrupt.h"
#include "engine/math/parallel.h"

// A few instructions that do nothing where no valgrind watches; no library.
#if __has_include(<valgrind/callgrind.h>)
#include <valgrind/callgrind.h>
#else
#define CALLGRIND_START_INSTRUMENTATION
#define CALLGRIND_STOP_INSTRUMENTATION
#define CALLGRIND_DUMP_STATS_AT(label) static_cast<void>(label)
#endif

namespace zoe {

double timed_parallel(size_t count, size_t grain, const std::function<void(size_t, size_t)>& work) {
    CALLGRIND_START_INSTRUMENTATION;
    Stopwatch watch;
    parallel_for(0, count, grain, [&](size_t begin, size_t end) {
        if (!is_interrupted()) work(begin, end);
    });
    const double ms = watch.restart_ms();
    CALLGRIND_STOP_INSTRUMENTATION;
    if (is_interrupted()) throw Interrupted("interrupted");
    return ms;
}

void write_instruction_count(const std::string& label) {
    CALLGRIND_DUMP_STATS_AT(label.c_str());
}

}  // namespace zoe
