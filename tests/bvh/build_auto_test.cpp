#include "engine/bvh/build_auto.h"

#include <gtest/gtest.h>

namespace zoe::test {
namespace {

TEST(BuildAuto, FewRaysAskForAQuickBuildAndManyForAGoodTree) {
    for (const uint64_t triangles : {100ull, 20'000ull, 1'000'000ull}) {
        SCOPED_TRACE(triangles);
        EXPECT_EQ(choose_builder(triangles, {.rays = 0.0}), BlasBuilder::kBinned);
        EXPECT_EQ(choose_builder(triangles, {.rays = 1e12}), BlasBuilder::kReinserted);
    }
}

TEST(BuildAuto, MoreRaysNeverAskForACheaperBuild) {
    double last_s = 0.0;
    for (double rays = 1.0; rays < 1e12; rays *= 1.5) {
        const double build_s = predicted_build_s(choose_builder(100'000, {.rays = rays}), 100'000);
        EXPECT_GE(build_s, last_s) << rays;
        last_s = build_s;
    }
}

TEST(BuildAuto, KeepsToTheBudgetAndBuildsSomethingWithoutOne) {
    EXPECT_EQ(choose_builder(1'000'000, {.budget_s = 0.0}), BlasBuilder::kBinned);
    for (double budget_s = 0.01; budget_s < 100.0; budget_s *= 1.3) {
        const BlasBuilder builder = choose_builder(1'000'000, {.budget_s = budget_s});
        EXPECT_TRUE(builder == BlasBuilder::kBinned || predicted_build_s(builder, 1'000'000) <= budget_s) << budget_s;
    }
    EXPECT_EQ(choose_builder(1'000'000, {.budget_s = 4.0}), BlasBuilder::kReinserted);
}

}  // namespace
}  // namespace zoe::test
