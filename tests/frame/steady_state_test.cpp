// A frame's steady state allocates nothing.

#include <gtest/gtest.h>

#include "content/content.h"
#include "engine/frame/frame.h"
#include "engine/math/parallel.h"
#include "tests/support/allocation_count.h"

namespace zoe {
namespace {

class SteadyState : public testing::TestWithParam<const char*> {};

TEST_P(SteadyState, AllocatesNothing) {
    set_thread_count(1);  // With more, the scheduler allocates its own tasks.
    Content content = make_content(GetParam());
    // One round of the clip: every array reaches its largest size.
    for (int frame = 0; frame < 24; ++frame) advance(content.scene, frame / 24.0);
    const size_t before = test::allocation_count();
    FrameStats stats;
    for (int frame = 0; frame < 24; ++frame) advance(content.scene, frame / 24.0, &stats);
    EXPECT_EQ(test::allocation_count() - before, 0u);
    EXPECT_GT(stats.refitted + stats.rebuilt + stats.kept, 0u);
    set_thread_count(0);
}

INSTANTIATE_TEST_SUITE_P(Content, SteadyState,
                         testing::Values("static", "rigid", "deforming", "skinned", "arbitrary", "topology", "instances",
                                         "default"));

}  // namespace
}  // namespace zoe
