#include "engine/scene/half.h"

#include <cmath>

#include <gtest/gtest.h>

namespace zoe::test {
namespace {

TEST(Half, EveryHalfComesBackAndNumbersBetweenGoToTheNearest) {
    EXPECT_EQ(float_from_half(1), 0x1p-24f);
    EXPECT_EQ(float_from_half(kHalfOne), 1.0f);
    EXPECT_EQ(float_from_half(kHalfLargest), 65504.0f);
    for (uint16_t half = 0; half <= kHalfLargest; ++half) {
        const float number = float_from_half(half);
        ASSERT_EQ(half_from_float(number), half);
        if (half == kHalfLargest) break;
        const auto after = static_cast<uint16_t>(half + 1);
        const float middle = 0.5f * (number + float_from_half(after));
        ASSERT_EQ(half_from_float(middle), half % 2 == 0 ? half : after) << half;
        ASSERT_EQ(half_from_float(std::nextafter(middle, 0.0f)), half);
        ASSERT_EQ(half_from_float(std::nextafter(middle, 1e30f)), after);
    }
}

}  // namespace
}  // namespace zoe::test
