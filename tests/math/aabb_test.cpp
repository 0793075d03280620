#include "engine/math/aabb.h"

#include <gtest/gtest.h>

#include "tests/math/random_inputs.h"

namespace zoe::test {
namespace {

TEST(Aabb, DefaultIsEmptyAndTheIdentityOfExtend) {
    const Aabb empty;
    EXPECT_TRUE(empty.is_empty());
    EXPECT_FALSE(empty.is_finite());
    EXPECT_EQ(empty.half_area(), 0.0f);
    const Aabb box{{-1, 2, -3}, {4, 5, 6}};
    for (const Aabb& merged : {merge(empty, box), merge(box, empty)}) {
        EXPECT_EQ(merged.lo, box.lo);
        EXPECT_EQ(merged.hi, box.hi);
    }
    EXPECT_TRUE(merge(empty, empty).is_empty());
}

TEST(Aabb, OnePointIsABoxOfNoAreaThatIsNotEmpty) {
    Aabb box;
    box.extend(glm::vec3(1, 2, 3));
    EXPECT_FALSE(box.is_empty());
    EXPECT_TRUE(box.is_finite());
    EXPECT_EQ(box.half_area(), 0.0f);
    EXPECT_TRUE(box.contains(glm::vec3(1, 2, 3)));
    EXPECT_FALSE(box.contains(glm::vec3(1, 2, std::nextafter(3.0f, 4.0f))));
}

TEST(Aabb, EmptyInOneAxisIsEmpty) {
    for (int axis = 0; axis < 3; ++axis) {
        Aabb box{{0, 0, 0}, {1, 1, 1}};
        box.lo[axis] = 2.0f;
        EXPECT_TRUE(box.is_empty());
        EXPECT_EQ(box.half_area(), 0.0f);
    }
}

TEST(Aabb, NanMakesABoxEmptyAndNotFinite) {
    for (int axis = 0; axis < 3; ++axis) {
        Aabb box{{0, 0, 0}, {1, 1, 1}};
        box.hi[axis] = std::numeric_limits<float>::quiet_NaN();
        EXPECT_TRUE(box.is_empty());
        EXPECT_FALSE(box.is_finite());
        EXPECT_EQ(box.half_area(), 0.0f);
        EXPECT_FALSE(box.contains(glm::vec3(0.5f)));
    }
}

TEST(Aabb, HalfAreaAndCentreAreTheHandComputedOnes) {
    const Aabb box{{-1, 0, 2}, {1, 3, 6}};  // 2 x 3 x 4
    EXPECT_EQ(box.half_area(), 2.0f * 3.0f + 3.0f * 4.0f + 4.0f * 2.0f);
    EXPECT_EQ(box.centre(), glm::vec3(0.0f, 1.5f, 4.0f));
    EXPECT_EQ(box.extent(), glm::vec3(2, 3, 4));
}

TEST(Aabb, CentreDoesNotOverflowWhereTheSumWould) {
    const float huge = std::numeric_limits<float>::max();
    const Aabb box{glm::vec3(0.9f * huge), glm::vec3(huge)};
    EXPECT_TRUE(std::isfinite(box.centre().x));
    EXPECT_TRUE(box.contains(box.centre()));
}

TEST(Aabb, MergeContainsBothAndTouchesOneOfThemOnEverySide) {
    const uint64_t seed = 11;
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Rng rng(seed);
    for (int i = 0; i < 10000; ++i) {
        Aabb a, b;
        for (int k = 0; k < 3; ++k) a.extend(random_point(rng, log_uniform(rng, 1e-6, 1e6)));
        for (int k = 0; k < 3; ++k) b.extend(random_point(rng, log_uniform(rng, 1e-6, 1e6)));
        const Aabb both = merge(a, b);
        ASSERT_TRUE(both.contains(a) && both.contains(b));
        ASSERT_TRUE(both.contains(Aabb{})) << "every box contains the empty one";
        for (int axis = 0; axis < 3; ++axis) {
            ASSERT_TRUE(both.lo[axis] == a.lo[axis] || both.lo[axis] == b.lo[axis]);
            ASSERT_TRUE(both.hi[axis] == a.hi[axis] || both.hi[axis] == b.hi[axis]);
        }
        ASSERT_GE(both.half_area(), a.half_area());
    }
}

}  // namespace
}  // namespace zoe::test
