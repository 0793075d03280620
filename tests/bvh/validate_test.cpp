#include <functional>

#include <gtest/gtest.h>

#include "engine/bvh/build_sweep.h"
#include "tests/bvh/inputs.h"

namespace zoe::test {
namespace {

/// Breaks a good tree in one way; `validate` must notice.
class Validate : public ::testing::Test {
protected:
    std::vector<Aabb> boxes_ = random_soup(200, 1.0f, 71).boxes();
    Bvh bvh_ = build_sweep(boxes_);

    size_t first_leaf() const {
        for (size_t k = 0; k < bvh_.nodes.size(); ++k) {
            if (bvh_.nodes[k].is_leaf()) return k;
        }
        return 0;
    }
    size_t last_inner() const {
        for (size_t k = bvh_.nodes.size(); k-- > 0;) {
            if (!bvh_.nodes[k].is_leaf()) return k;
        }
        return 0;
    }
    size_t leaf_with_several() const {
        for (size_t k = 0; k < bvh_.nodes.size(); ++k) {
            if (bvh_.nodes[k].count > 1) return k;
        }
        return 0;
    }
    std::string result() const { return validate(bvh_, boxes_); }
};

TEST_F(Validate, AcceptsAGoodTree) {
    EXPECT_EQ(result(), "");
    EXPECT_EQ(validate({}, {}), "");
}

TEST_F(Validate, SeesABoxThatIsTooSmallOnAnySide) {
    const Bvh good = bvh_;
    for (const size_t k : {first_leaf(), last_inner(), size_t{0}}) {
        for (int axis = 0; axis < 3; ++axis) {
            bvh_ = good;
            bvh_.nodes[k].lo[axis] = std::nextafter(bvh_.nodes[k].lo[axis], 1e30f);
            EXPECT_NE(result(), "") << "lo, node " << k << ", axis " << axis;
            bvh_ = good;
            bvh_.nodes[k].hi[axis] = std::nextafter(bvh_.nodes[k].hi[axis], -1e30f);
            EXPECT_NE(result(), "") << "hi, node " << k << ", axis " << axis;
        }
    }
}

TEST_F(Validate, SeesABoxThatIsNan) {
    const Bvh good = bvh_;
    for (const size_t k : {first_leaf(), last_inner(), size_t{0}}) {
        bvh_ = good;
        bvh_.nodes[k].hi.y = std::numeric_limits<float>::quiet_NaN();
        EXPECT_NE(result(), "") << "node " << k;
    }
}

TEST_F(Validate, SeesAnEmptiedBox) {
    bvh_.nodes[first_leaf()].lo = glm::vec3(std::numeric_limits<float>::infinity());
    bvh_.nodes[first_leaf()].hi = glm::vec3(-std::numeric_limits<float>::infinity());
    EXPECT_NE(result(), "");
}

TEST_F(Validate, SeesALostPrimitive) {
    --bvh_.nodes[leaf_with_several()].count;
    EXPECT_NE(result(), "");
}

TEST_F(Validate, SeesAPrimitiveThatIsNotListed) {
    bvh_.primitives.pop_back();
    EXPECT_NE(result(), "");
}

TEST_F(Validate, SeesADuplicatedPrimitive) {
    bvh_.primitives[3] = bvh_.primitives[4];
    EXPECT_NE(result(), "");
}

TEST_F(Validate, SeesAPrimitiveOutOfRange) {
    bvh_.primitives[3] = 200;
    EXPECT_NE(result(), "");
}

TEST_F(Validate, SeesOverlappingLeaves) {
    const size_t k = leaf_with_several();
    BvhNode& leaf = bvh_.nodes[k];
    if (leaf.first > 0) {
        --leaf.first;
    } else {
        ++leaf.count;
    }
    EXPECT_NE(result(), "");
}

TEST_F(Validate, SeesALeafThatReachesPastTheEnd) {
    for (BvhNode& node : bvh_.nodes) {
        if (node.is_leaf() && node.first + node.count == boxes_.size()) node.count += 1000000;
    }
    EXPECT_NE(result(), "");
    bvh_.nodes[first_leaf()] = {glm::vec3(-1e9f), 0xffffffffu, glm::vec3(1e9f), 0xffffffffu};
    EXPECT_NE(result(), "") << "the sum overflows";
}

TEST_F(Validate, SeesBadLinks) {
    const Bvh good = bvh_;
    const size_t k = last_inner();
    for (const uint32_t link : {0u, uint32_t(k), uint32_t(bvh_.nodes.size() - 1), uint32_t(bvh_.nodes.size()), 0xfffffffeu,
                                0xffffffffu, good.nodes[k].first - 1}) {
        bvh_ = good;
        bvh_.nodes[k].first = link;
        EXPECT_NE(result(), "") << "link " << link;
    }
}

TEST_F(Validate, SeesANodeWithTwoParentsAndOneWithNone) {
    // Both children of the root's last inner child point to the same pair.
    std::vector<uint32_t> inner;
    for (uint32_t k = 1; k < bvh_.nodes.size(); ++k) {
        if (!bvh_.nodes[k].is_leaf()) inner.push_back(k);
    }
    ASSERT_GE(inner.size(), 2u);
    bvh_.nodes[inner[0]].first = bvh_.nodes[inner[1]].first;
    EXPECT_NE(result(), "");
}

TEST_F(Validate, SeesAnUnreachableNode) {
    bvh_.nodes.push_back(bvh_.nodes.back());
    EXPECT_NE(result(), "");
}

TEST_F(Validate, SeesAMissingTree) {
    bvh_.nodes.clear();
    EXPECT_NE(result(), "");
    bvh_.primitives.clear();
    EXPECT_NE(result(), "") << "boxes without a tree";
}

TEST_F(Validate, SeesBoxesThatMoved) {
    boxes_[17].hi.x += 100.0f;
    EXPECT_NE(result(), "");
}

}  // namespace
}  // namespace zoe::test
