#include "apps/demo/pace.h"

#include <gtest/gtest.h>

#include "engine/math/rng.h"

namespace zoe {
namespace {

constexpr double kPixels = 640.0 * 360.0, kFrameMs = 1000.0 / 24.0;

/// Plays pictures that take so long a pixel, give or take a share by chance.
/// Returns    the last divisor, and how often it changed in the second half.
std::pair<int, int> play(double ms_a_pixel, double other_ms, double noise, uint64_t seed) {
    Pace pace;
    Rng rng(seed);
    int divisor = 0, changes = 0;
    for (int frame = 0; frame < 200; ++frame) {
        const int now = pace.choose_divisor(kPixels, other_ms);
        if (frame >= 100 && now != divisor) ++changes;
        divisor = now;
        const double pixels = kPixels / (divisor * divisor);
        pace.note(pixels, pixels * ms_a_pixel * (1.0 + noise * (2.0 * rng.uniform() - 1.0)));
    }
    return {divisor, changes};
}

TEST(Pace, PicturesAreInTimeAndNotSmallerThanNeedBe) {
    for (const double full_ms : {1.0, 20.0, 60.0, 150.0, 360.0, 900.0, 4000.0}) {
        const auto [divisor, changes] = play(full_ms / kPixels, 2.0, 0.0, 1);
        EXPECT_EQ(changes, 0) << full_ms;
        const auto takes_ms = [&](int d) { return 2.0 + full_ms / (d * d); };
        EXPECT_LE(takes_ms(divisor), kFrameMs) << full_ms;
        if (divisor > 1) {
            EXPECT_GT(takes_ms(divisor - 1), 0.85 * kFrameMs) << full_ms;
        }
    }
}

TEST(Pace, TimesThatVaryALittleDoNotChangeTheSize) {
    for (uint64_t seed = 1; seed <= 20; ++seed) {
        SCOPED_TRACE(seed);
        EXPECT_LE(play(360.0 / kPixels, 2.0, 0.1, seed).second, 1);
        for (double full_ms = 20.0; full_ms < 1500.0; full_ms *= 1.1) {
            EXPECT_LE(play(full_ms / kPixels, 2.0, 0.2, seed).second, 3) << full_ms;
        }
    }
}

TEST(Pace, HoweverLongTheRestTakesSomethingIsSeen) {
    EXPECT_EQ(play(1e-6, 1e6, 0.0, 1).first, 1);
    EXPECT_EQ(play(1e6, 1e6, 0.0, 1).first, 12);
}

}  // namespace
}  // namespace zoe
