#include "engine/math/parallel.h"

#include <algorithm>
#include <thread>
#include <utility>

#ifdef ZOETROPE_PARALLEL_TBB
#include <memory>

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#else
#include <atomic>
#include <exception>
#include <mutex>
#include <vector>
#endif

namespace zoe {

namespace {

int default_thread_count() {
    return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

int& configured_thread_count() {
    static int count = default_thread_count();
    return count;
}

}  // namespace

int thread_count() {
    return configured_thread_count();
}

#ifdef ZOETROPE_PARALLEL_TBB

namespace {

// An arena holds the threads; the limit lets it have more of them than there are cores without a complaint from TBB.
struct Threads {
    explicit Threads(int count)
        : limit(tbb::global_control::max_allowed_parallelism, std::max(count, default_thread_count())), arena(count) {}
    tbb::global_control limit;
    tbb::task_arena arena;
};

std::unique_ptr<Threads>& threads() {
    static auto threads = std::make_unique<Threads>(configured_thread_count());
    return threads;
}

}  // namespace

void set_thread_count(int count) {
    configured_thread_count() = count > 0 ? count : default_thread_count();
    threads().reset();
    threads() = std::make_unique<Threads>(configured_thread_count());
}

void detail::parallel_ranges(size_t begin, size_t end, size_t grain, RangeFunction function, void* context) {
    if (begin >= end) return;
    grain = std::max<size_t>(grain, 1);
    const size_t range_count = (end - begin + grain - 1) / grain;
    const auto run = [&](size_t range) {
        const size_t b = begin + range * grain;
        function(context, b, std::min(b + grain, end));
    };
    if (range_count == 1 || thread_count() == 1) {
        for (size_t range = 0; range < range_count; ++range) run(range);
        return;
    }
    // Isolated: a thread that waits here must not take up a task of an outer loop, whose scratch memory it may share.
    threads()->arena.execute([&] {
        tbb::this_task_arena::isolate([&] { tbb::parallel_for(size_t{0}, range_count, run, tbb::simple_partitioner()); });
    });
}

#else

void set_thread_count(int count) {
    configured_thread_count() = count > 0 ? count : default_thread_count();
}

namespace {
thread_local bool is_worker = false;  // Nested calls run on the thread that makes them.
}

void detail::parallel_ranges(size_t begin, size_t end, size_t grain, RangeFunction function, void* context) {
    if (begin >= end) return;
    grain = std::max<size_t>(grain, 1);
    const size_t range_count = (end - begin + grain - 1) / grain;
    std::atomic<size_t> next{0};
    std::exception_ptr error;
    std::mutex error_mutex;
    const auto work = [&] {
        for (size_t range; (range = next.fetch_add(1)) < range_count;) {
            const size_t b = begin + range * grain;
            try {
                function(context, b, std::min(b + grain, end));
            } catch (...) {
                const std::lock_guard lock(error_mutex);
                if (!error) error = std::current_exception();
                next = range_count;
            }
        }
    };
    const size_t helper_count = is_worker ? 0 : std::min<size_t>(thread_count(), range_count) - 1;
    std::vector<std::thread> helpers;
    for (size_t k = 0; k < helper_count; ++k) {
        helpers.emplace_back([&] {
            is_worker = true;
            work();
        });
    }
    const bool was_worker = std::exchange(is_worker, true);
    work();
    is_worker = was_worker;
    for (std::thread& helper : helpers) helper.join();
    if (error) std::rethrow_exception(error);
}

#endif

}  // namespace zoe
