#include "engine/math/parallel.h"

#include <atomic>
#include <chrono>
#include <mutex>
#include <set>
#include <stdexcept>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace zoe {
namespace {

/// Sets the number of threads for a test, and back to one a core after it.
class Parallel : public ::testing::TestWithParam<int> {
protected:
    void SetUp() override { set_thread_count(GetParam()); }
    void TearDown() override { set_thread_count(0); }
};

TEST_P(Parallel, EveryIndexIsVisitedExactlyOnceInRangesThatStartAtMultiplesOfTheGrain) {
    for (const size_t begin : {0u, 5u}) {
        for (const size_t count : {0u, 1u, 2u, 63u, 64u, 65u, 1000u, 12345u}) {
            for (const size_t grain : {1u, 3u, 64u, 100000u}) {
                std::vector<std::atomic<int>> visits(begin + count);
                std::atomic<bool> is_aligned = true;
                parallel_for(begin, begin + count, grain, [&](size_t b, size_t e) {
                    if (b >= e || e - b > grain || (b - begin) % grain != 0 || e > begin + count) is_aligned = false;
                    for (size_t i = b; i < e && i < visits.size(); ++i) ++visits[i];
                });
                EXPECT_TRUE(is_aligned) << "begin " << begin << ", count " << count << ", grain " << grain;
                for (size_t i = 0; i < visits.size(); ++i) {
                    ASSERT_EQ(visits[i], i < begin ? 0 : 1) << "index " << i << ", count " << count << ", grain " << grain;
                }
            }
        }
    }
}

TEST_P(Parallel, NestedCallsCoverEverything) {
    constexpr size_t kOuter = 20, kInner = 300;
    std::vector<std::atomic<int>> visits(kOuter * kInner);
    parallel_for(0, kOuter, 1, [&](size_t outer_begin, size_t outer_end) {
        for (size_t outer = outer_begin; outer < outer_end; ++outer) {
            parallel_for(0, kInner, 7, [&](size_t b, size_t e) {
                for (size_t i = b; i < e; ++i) ++visits[outer * kInner + i];
            });
        }
    });
    for (const auto& count : visits) ASSERT_EQ(count, 1);
}

TEST_P(Parallel, CallsNestedThreeDeepDoNotDeadlock) {
    std::atomic<int> leaves = 0;
    parallel_for(0, 8, 1, [&](size_t, size_t) {
        parallel_for(0, 8, 1,
                     [&](size_t, size_t) { parallel_for(0, 8, 1, [&](size_t b, size_t e) { leaves += int(e - b); }); });
    });
    EXPECT_EQ(leaves, 8 * 8 * 8);
}

TEST_P(Parallel, AnExceptionReachesTheCallerAndTheNextCallWorks) {
    for (const size_t thrower : {0u, 17u, 99u}) {
        try {
            parallel_for(0, 100, 1, [&](size_t b, size_t) {
                if (b == thrower) throw std::runtime_error("index " + std::to_string(b));
            });
            FAIL() << "nothing was thrown";
        } catch (const std::runtime_error& error) {
            EXPECT_EQ(error.what(), "index " + std::to_string(thrower));
        }
        std::atomic<size_t> sum = 0;
        parallel_for(0, 100, 10, [&](size_t b, size_t e) { sum += e - b; });
        EXPECT_EQ(sum, 100u);
    }
}

TEST_P(Parallel, AnExceptionInANestedCallReachesTheOutermostCaller) {
    EXPECT_THROW(parallel_for(0, 4, 1,
                              [&](size_t, size_t) {
                                  parallel_for(0, 4, 1, [&](size_t b, size_t) {
                                      if (b == 3) throw std::invalid_argument("inner");
                                  });
                              }),
                 std::invalid_argument);
}

TEST_P(Parallel, UsesNoMoreThreadsThanItMay) {
    std::mutex mutex;
    std::set<std::thread::id> ids;
    parallel_for(0, 64, 1, [&](size_t, size_t) {
        const std::lock_guard lock(mutex);
        ids.insert(std::this_thread::get_id());
    });
    EXPECT_EQ(thread_count(), GetParam());
    EXPECT_LE(ids.size(), size_t(GetParam()));
    if (GetParam() == 1) {
        EXPECT_EQ(*ids.begin(), std::this_thread::get_id()) << "one thread means the caller's";
    }
}

INSTANTIATE_TEST_SUITE_P(Threads, Parallel, ::testing::Values(1, 2, 3, 8),
                         [](const auto& info) { return std::to_string(info.param); });

TEST(ParallelThreads, ZeroMeansOneACore) {
    set_thread_count(0);
    EXPECT_GE(thread_count(), 1);
    EXPECT_LE(thread_count(), int(std::max(1u, std::thread::hardware_concurrency())));
}

TEST(ParallelThreads, TwoThreadsReallyRunAtTheSameTime) {
    set_thread_count(2);
    std::atomic<int> inside = 0, most = 0;
    parallel_for(0, 8, 1, [&](size_t, size_t) {
        const int now = ++inside;
        int seen = most;
        while (now > seen && !most.compare_exchange_weak(seen, now)) {
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
        --inside;
    });
    set_thread_count(0);
    if (std::thread::hardware_concurrency() > 1) {
        EXPECT_EQ(most, 2);
    }
}

TEST(ParallelThreads, TheBodyMayBeConstAndMayBeAReference) {
    std::atomic<int> calls = 0;
    const auto body = [&calls](size_t b, size_t e) { calls += int(e - b); };
    parallel_for(0, 10, 2, body);
    EXPECT_EQ(calls, 10);
}

}  // namespace
}  // namespace zoe
