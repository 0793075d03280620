#include "apps/chart/clip_ways.h"

#include <algorithm>
#include <limits>

#include <gtest/gtest.h>

#include "engine/math/rng.h"

namespace zoe::chart {
namespace {

ClipTrees random_trees(Rng& rng, size_t frame_count) {
    ClipTrees trees{.triangle_count = 100, .rays = 10.0, .build_work = 100.0, .refit_work = 5.0};
    for (size_t built = 0; built < frame_count; ++built) {
        trees.readings.emplace_back();
        trees.ray_work.emplace_back();
        for (size_t frame = built; frame < frame_count; ++frame) {
            const double cost = 1.0 + (frame > built ? 0.01 + 20.0 * rng.uniform() : 0.0);
            trees.readings.back().push_back({cost, 1.0});
            trees.ray_work.back().push_back(cost);
        }
    }
    return trees;
}

/// rebuilt    a bit a frame but the first.
double work_of(const ClipTrees& trees, uint32_t rebuilt) {
    double work = trees.trace_work(0, 0);
    size_t built = 0;
    for (size_t frame = 1; frame < trees.frame_count(); ++frame) {
        const bool is_rebuilt = (rebuilt >> (frame - 1) & 1) != 0;
        if (is_rebuilt) built = frame;
        work += (is_rebuilt ? trees.build_work : trees.refit_work) + trees.trace_work(built, frame);
    }
    return work;
}

TEST(ClipWays, HindsightIsTheLeastOfAllChoices) {
    for (uint64_t seed = 1; seed <= 50; ++seed) {
        SCOPED_TRACE(::testing::Message() << "seed " << seed);
        Rng rng(seed);
        const size_t frame_count = 1 + rng.below(9);
        const ClipTrees trees = random_trees(rng, frame_count);
        const uint32_t choice_count = 1u << (frame_count - 1);
        double least = std::numeric_limits<double>::infinity();
        for (uint32_t choice = 0; choice < choice_count; ++choice) least = std::min(least, work_of(trees, choice));
        EXPECT_NEAR(in_hindsight(trees), least, 1e-9 * least);
        EXPECT_NEAR(always_refitted(trees), work_of(trees, 0), 1e-9 * least);
        EXPECT_NEAR(always_rebuilt(trees), work_of(trees, choice_count - 1), 1e-9 * least);
    }
}

TEST(ClipWays, TheSensorGoesFromAlwaysRefittingToAlwaysRebuilding) {
    Rng rng(7);
    const ClipTrees trees = random_trees(rng, 30);
    EXPECT_EQ(by_sensor(trees, 1e9), always_refitted(trees)) << "seed 7";
    const double refits = 29 * trees.refit_work;  // It refits before it chooses.
    EXPECT_NEAR(by_sensor(trees, 1e-9), always_rebuilt(trees) + refits, 1e-6) << "seed 7";
    EXPECT_GE(by_sensor(trees, 1.0), in_hindsight(trees)) << "seed 7";
}

}  // namespace
}  // namespace zoe::chart
