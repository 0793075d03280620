// A frame's steady state allocates nothing: this program counts every call of operator new.

#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "content/content.h"
#include "engine/frame/frame.h"
#include "engine/math/parallel.h"

// Once inlined, malloc and free look like a mismatch of new and delete.
#pragma GCC diagnostic ignored "-Wmismatched-new-delete"

namespace {
std::atomic<size_t> allocation_count{0};
}

void* operator new(size_t size) {
    ++allocation_count;
    if (void* memory = std::malloc(size > 0 ? size : 1)) return memory;
    throw std::bad_alloc();
}
void* operator new(size_t size, const std::nothrow_t&) noexcept {
    ++allocation_count;
    return std::malloc(size > 0 ? size : 1);
}
void operator delete(void* memory) noexcept {
    std::free(memory);
}
void operator delete(void* memory, size_t) noexcept {
    std::free(memory);
}

namespace zoe {
namespace {

class SteadyState : public testing::TestWithParam<const char*> {};

TEST_P(SteadyState, AllocatesNothing) {
    set_thread_count(1);  // With more, the scheduler allocates its own tasks.
    Content content = make_content(GetParam());
    // One round of the clip: every array reaches its largest size.
    for (int frame = 0; frame < 24; ++frame) advance(content.scene, frame / 24.0);
    const size_t before = allocation_count;
    FrameStats stats;
    for (int frame = 0; frame < 24; ++frame) advance(content.scene, frame / 24.0, &stats);
    EXPECT_EQ(allocation_count - before, 0u);
    EXPECT_GT(stats.refitted + stats.rebuilt + stats.kept, 0u);
    set_thread_count(0);
}

INSTANTIATE_TEST_SUITE_P(Content, SteadyState, testing::Values("static", "rigid", "deforming", "skinned", "default"));

}  // namespace
}  // namespace zoe
