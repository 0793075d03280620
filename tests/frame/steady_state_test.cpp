// A frame's steady state allocates nothing.

#include <gtest/gtest.h>

#include "content/content.h"
#include "engine/frame/frame.h"
#include "engine/math/parallel.h"
#include "tests/support/allocation_count.h"

namespace zoe {
namespace {

constexpr int kFrames = 24;

class SteadyState : public testing::TestWithParam<const char*> {};

TEST_P(SteadyState, AllocatesNothing) {
    set_thread_count(1);  // With more, the scheduler allocates its own tasks.
    Content content = make_content(GetParam());
    size_t allocation_count = 0;
    FrameStats stats;
    // In the first round, every array reaches its largest size.
    for (int frame = 0; frame < 2 * kFrames; ++frame) {
        if (frame == kFrames) {
            allocation_count = 0;
            stats = {};
        }
        const double time_s = frame % kFrames / 24.0;
        if (content.write) content.write(content.scene, time_s);
        const size_t before = test::allocation_count();
        advance(content.scene, time_s, &stats);
        allocation_count += test::allocation_count() - before;
    }
    EXPECT_EQ(allocation_count, 0u);
    EXPECT_GT(stats.refitted + stats.rebuilt + stats.kept, 0u);
    EXPECT_GE(stats.rebuilt, content.write ? uint32_t(kFrames - 1) : 0u) << "meshes that are written";
    set_thread_count(0);
}

INSTANTIATE_TEST_SUITE_P(Content, SteadyState,
                         testing::Values("static", "rigid", "deforming", "skinned", "dancers", "surface", "arbitrary",
                                         "topology", "instances", "default"));

}  // namespace
}  // namespace zoe
