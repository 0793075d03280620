#include "engine/math/rng.h"

#include <array>
#include <bit>
#include <set>

#include <gtest/gtest.h>

namespace zoe {
namespace {

TEST(Rng, GivesThePublishedNumbersOfSplitMix64) {
    Rng from_zero(0);
    EXPECT_EQ(from_zero.next(), 0xe220a8397b1dcdafull);
    EXPECT_EQ(from_zero.next(), 0x6e789e6aa1b965f4ull);
    EXPECT_EQ(from_zero.next(), 0x06c45d188009454full);
    Rng rng(1234567);
    EXPECT_EQ(rng.next(), 6457827717110365317ull);
    EXPECT_EQ(rng.next(), 3203168211198807973ull);
}

TEST(Rng, UniformStaysBelowOneAndFillsItsBinsEvenly) {
    const uint64_t seed = 1;
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Rng rng(seed);
    constexpr int kBins = 100, kDraws = 1000000;
    std::array<int, kBins> bins{};
    for (int i = 0; i < kDraws; ++i) {
        const float u = rng.uniform();
        ASSERT_GE(u, 0.0f);
        ASSERT_LT(u, 1.0f);
        ++bins[static_cast<int>(u * kBins)];
    }
    double chi_square = 0.0;
    const double expected = double{kDraws} / kBins;
    for (const int count : bins) chi_square += (count - expected) * (count - expected) / expected;
    // 99 degrees of freedom: mean 99, standard deviation 14; five of them either way.
    EXPECT_LT(chi_square, 99 + 5 * 14.1);
    EXPECT_GT(chi_square, 99 - 5 * 14.1);
}

TEST(Rng, UniformBetweenBoundsStaysBetweenThem) {
    Rng rng(2);
    for (int i = 0; i < 100000; ++i) {
        const float u = rng.uniform(-3.0f, 5.0f);
        ASSERT_GE(u, -3.0f);
        ASSERT_LE(u, 5.0f);
    }
}

TEST(Rng, BelowReachesEveryValueAndNoOther) {
    Rng rng(3);
    for (const uint32_t n : {1u, 2u, 3u, 7u, 100u}) {
        std::set<uint32_t> seen;
        for (int i = 0; i < 5000; ++i) {
            const uint32_t value = rng.below(n);
            ASSERT_LT(value, n);
            seen.insert(value);
        }
        EXPECT_EQ(seen.size(), n);
    }
    for (int i = 0; i < 1000; ++i) ASSERT_LT(rng.below(0xffffffffu), 0xffffffffu);
}

TEST(Rng, NeighbouringSeedsAndKeysShareNoPattern) {
    // Flipping any input bit flips about half of the output bits.
    for (int bit = 0; bit < 64; ++bit) {
        int flipped = 0;
        constexpr int kTrials = 1000;
        for (uint64_t i = 1; i <= kTrials; ++i) {
            const uint64_t x = i * 0x9e3779b97f4a7c15ull;
            flipped += std::popcount(mix_bits(x) ^ mix_bits(x ^ (uint64_t{1} << bit)));
        }
        EXPECT_NEAR(flipped / double{kTrials}, 32.0, 2.0) << "input bit " << bit;
    }
}

}  // namespace
}  // namespace zoe
