// A frame's steady state allocates nothing.

#include <string_view>

#include <gtest/gtest.h>

#include "content/content.h"
#include "engine/frame/frame.h"
#include "engine/math/parallel.h"
#include "tests/support/allocation_count.h"

namespace zoe {
namespace {

constexpr int kFrames = 24;

class SteadyState : public testing::TestWithParam<const char*> {};

// settling_rays, measured_rays   a frame, in the first round and in the one that is looked at. Of none, trees of deforming
//                                nodes are never rebuilt; of very many, in every frame.
void expect_no_allocation(const char* name, double settling_rays, double measured_rays) {
    set_thread_count(1);  // With more, the scheduler allocates its own tasks.
    Content content = make_content(name);
    content.scene.rebuild.frame_rays = settling_rays;
    if (measured_rays > 0.0) content.scene.clip_poses = 1;  // Or trees would not wear out.
    size_t allocation_count = 0;
    bool is_any_refitted = false;
    FrameStats stats;
    // In the first round, every array reaches its largest size.
    for (int frame = 0; frame < 2 * kFrames; ++frame) {
        if (frame == kFrames) {
            is_any_refitted = stats.refitted > 0;
            allocation_count = 0;
            stats = {};
            content.scene.rebuild.frame_rays = measured_rays;
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
    // Waves never make the tree of a cloth a tenth worse.
    if (measured_rays > 0.0 && is_any_refitted && std::string_view(name) != "deforming") {
        EXPECT_GT(stats.rebuilt, 0u);
    }
    set_thread_count(0);
}

TEST_P(SteadyState, AllocatesNothing) {
    expect_no_allocation(GetParam(), 0.0, 0.0);
}

TEST_P(SteadyState, AllocatesNothingWhereTreesAreRebuiltForTheFirstTime) {
    expect_no_allocation(GetParam(), 0.0, 1e12);
}

INSTANTIATE_TEST_SUITE_P(Content, SteadyState,
                         testing::Values("static", "rigid", "deforming", "skinned", "dancers", "surface", "arbitrary",
                                         "topology", "instances", "default"));

}  // namespace
}  // namespace zoe
