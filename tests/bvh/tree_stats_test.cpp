#include "engine/bvh/tree_stats.h"

#include <gtest/gtest.h>

namespace zoe::test {
namespace {

TEST(TreeStats, AreTheHandCountedOnes) {
    Bvh bvh;
    bvh.nodes = {{{0, 0, 0}, 1, {1, 1, 1}, 0}, {{0, 0, 0}, 0, {0.5f, 1, 1}, 2}, {{0.5f, 0, 0}, 2, {1, 1, 1}, 3}};
    bvh.primitives = {0, 1, 2, 0, 1};  // Two triangles stand on both sides.
    const TreeStats stats = tree_stats(bvh);
    EXPECT_EQ(stats.inner_count, 1u);
    EXPECT_EQ(stats.leaf_count, 2u);
    EXPECT_EQ(stats.depth, 2);
    EXPECT_EQ(stats.reference_count, 5u);
    EXPECT_EQ(stats.duplicate_count, 2u);
    EXPECT_EQ(stats.largest_leaf, 3u);
    EXPECT_EQ(stats.bytes, 3 * 32u + 5 * 4u);
    EXPECT_DOUBLE_EQ(stats.mean_leaf(), 2.5);
    EXPECT_DOUBLE_EQ(stats.sah, (3.0 * 1 + 2.0 * 2 + 2.0 * 3) / 3.0);
}

TEST(TreeStats, OfNothingAreZero) {
    const TreeStats stats = tree_stats({});
    EXPECT_EQ(stats.inner_count + stats.leaf_count + stats.reference_count + stats.largest_leaf, 0u);
    EXPECT_EQ(stats.bytes, 0u);
    EXPECT_EQ(stats.mean_leaf(), 0.0);
}

}  // namespace
}  // namespace zoe::test
