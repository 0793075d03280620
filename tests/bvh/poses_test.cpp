
#include <gtest/gtest.h>

#include "engine/bvh/build_poses.h"
#include "engine/bvh/build_sweep.h"
#include "tests/bvh/inputs.h"
#include "tests/math/random_inputs.h"
#include "tests/support/same_bits.h"

namespace zoe::test {
namespace {

/// The tree's SAH with other boxes under the same leaves.
double cost_with(Bvh bvh, std::span<const Aabb> boxes) {
    for (size_t k = bvh.nodes.size(); k-- > 0;) {
        BvhNode& node = bvh.nodes[k];
        Aabb bounds;
        if (node.is_leaf()) {
            for (uint32_t n = 0; n < node.count; ++n) bounds.extend(boxes[bvh.primitives[node.first + n]]);
        } else {
            bounds = bvh.nodes[node.first].bounds();
            bounds.extend(bvh.nodes[node.first + 1].bounds());
        }
        node.lo = bounds.lo;
        node.hi = bounds.hi;
    }
    return sah_cost(bvh);
}

/// Small boxes that fly from one place to another; in between they are on the way.
std::vector<Aabb> flight(int box_count, int pose_count, uint64_t seed) {
    Rng rng(seed);
    std::vector<glm::vec3> from, to;
    for (int k = 0; k < box_count; ++k) {
        from.push_back(random_point(rng, 10.0f));
        to.push_back(random_point(rng, 10.0f));
    }
    std::vector<Aabb> boxes;
    for (int pose = 0; pose < pose_count; ++pose) {
        for (int k = 0; k < box_count; ++k) {
            const glm::vec3 p = glm::mix(from[k], to[k], float(pose) / float(pose_count - 1));
            boxes.push_back({p, p + 0.1f});
        }
    }
    return boxes;
}

TEST(Poses, CostLessOverAllThanATreeOfTheFirst) {
    for (const uint64_t seed : {1, 2, 3}) {
        SCOPED_TRACE(::testing::Message() << "seed " << seed);
        constexpr int kCount = 3000, kPoses = 5;
        const std::vector<Aabb> boxes = flight(kCount, kPoses, seed);
        const auto pose = [&](int k) { return std::span(boxes).subspan(size_t(k) * kCount, kCount); };
        const Bvh over_all = build_poses(boxes, kPoses, {.max_leaf_size = 1}),
                  of_first = build_sweep(pose(0), {.max_leaf_size = 1});
        EXPECT_EQ(validate(over_all, pose(0)), "");
        double all = 0.0, first = 0.0, worst_all = 0.0, worst_first = 0.0;
        for (int k = 0; k < kPoses; ++k) {
            const double a = cost_with(over_all, pose(k)), b = cost_with(of_first, pose(k));
            all += a;
            first += b;
            worst_all = std::max(worst_all, a);
            worst_first = std::max(worst_first, b);
        }
        EXPECT_LT(all, 0.9 * first);
        EXPECT_LT(worst_all, 0.9 * worst_first);
    }
}

TEST(Poses, OfOneKindAreWorthAsMuchAsATreeOfIt) {
    const TestMesh soup = random_soup(4000, 1.0f, 11);
    const std::vector<Aabb> boxes = soup.boxes();
    std::vector<Aabb> poses;
    for (int k = 0; k < 3; ++k) poses.insert(poses.end(), boxes.begin(), boxes.end());
    const Bvh one = build_poses(boxes, 1), three = build_poses(poses, 3);
    EXPECT_LE(sah_cost(one), 1.05 * sah_cost(build_sweep(boxes)));
    ASSERT_EQ(one.nodes.size(), three.nodes.size());
    EXPECT_NEAR(sah_cost(one), sah_cost(three), 1e-9 * sah_cost(one));
}

/// A pose that is not there yet, or too far to count: all its boxes empty.
TEST(Poses, WithoutBoxesDoNotCount) {
    const std::vector<Aabb> boxes = random_soup(1000, 1.0f, 12).boxes();
    std::vector<Aabb> poses = boxes;
    poses.resize(2 * boxes.size());
    const Bvh alone = build_poses(boxes, 1), with_none = build_poses(poses, 2);
    EXPECT_TRUE(has_same_bits(alone.nodes, with_none.nodes));
    EXPECT_EQ(alone.primitives, with_none.primitives);
}

}  // namespace
}  // namespace zoe::test
