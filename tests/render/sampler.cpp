#include "engine/render/sampler.h"

#include <set>
#include <vector>

#include <gtest/gtest.h>

namespace zoe::test {
namespace {

TEST(Sampler, EveryAlignedRunOfSamplesHasOnePointInEachBoxOfEveryShape) {
    Rng rng(1);
    for (int round = 0; round < 40; ++round) {
        const uint32_t pixel = static_cast<uint32_t>(rng.next());
        const uint64_t which = dimension(static_cast<Use>(rng.below(10)), rng.below(5), rng.below(3));
        const uint32_t bits = rng.below(9);
        const uint32_t count = 1u << bits;
        const uint32_t first = rng.below(8) * count;
        for (uint32_t bits_x = 0; bits_x <= bits; ++bits_x) {
            std::set<std::pair<uint32_t, uint32_t>> boxes;
            for (uint32_t i = 0; i < count; ++i) {
                const glm::vec2 u = uniform_2d({pixel, first + i}, which);
                boxes.emplace(static_cast<uint32_t>(u.x * static_cast<float>(1u << bits_x)),
                              static_cast<uint32_t>(u.y * static_cast<float>(1u << (bits - bits_x))));
            }
            EXPECT_EQ(boxes.size(), count) << "pixel " << pixel << " bits " << bits << " of which x has " << bits_x;
        }
    }
}

TEST(Sampler, EveryRunOfSamplesIsSpreadOverTheSlicesOfTheShutter) {
    Rng rng(2);
    for (int round = 0; round < 200; ++round) {
        const uint32_t pixel = static_cast<uint32_t>(rng.next()), turn = rng.below(100), bits = rng.below(11);
        const uint32_t count = 1u << bits, first = turn * count;
        std::vector<uint32_t> slice_of(count, count);  // by sample
        for (uint32_t slice = 0; slice < count; ++slice) {
            const uint32_t sample = sample_in_slice(pixel, turn, slice, count);
            ASSERT_TRUE(sample >= first && sample < first + count) << "pixel " << pixel << " slice " << slice;
            ASSERT_EQ(slice_of[sample - first], count) << "two slices have sample " << sample;
            slice_of[sample - first] = slice;
        }
        const uint32_t run_bits = rng.below(bits + 1), run = 1u << run_bits, stride = count / run;
        for (uint32_t begin = 0; begin < count; begin += run) {
            std::set<uint32_t> strata;
            for (uint32_t i = begin; i < begin + run; ++i) {
                strata.insert(slice_of[i] / stride);
                EXPECT_EQ(slice_of[i] % stride, slice_of[begin] % stride);
            }
            EXPECT_EQ(strata.size(), run);
        }
    }
    // No slice is any pixel's favourite, nor two pixels' alike.
    std::vector<int> first_slices(16);
    for (uint32_t pixel = 0; pixel < 16000; ++pixel) {
        for (uint32_t slice = 0; slice < 16; ++slice) first_slices[slice] += sample_in_slice(pixel, 3, slice, 16) == 48;
    }
    for (const int count : first_slices) EXPECT_NEAR(count, 1000, 5 * 31);
}

TEST(Sampler, NumbersLieInTheHalfOpenUnitInterval) {
    for (uint32_t i = 0; i < 10000; ++i) {
        const glm::vec2 u = uniform_2d({i * 7919u, i}, dimension(Use::kDirection, i & 3));
        EXPECT_TRUE(u.x >= 0.0f && u.x < 1.0f && u.y >= 0.0f && u.y < 1.0f);
    }
}

/// Mean product of two centred uniform numbers over pixels: 0 where they know nothing of each other, 1/12 where equal.
template <typename First, typename Second>
double covariance(First first, Second second) {
    double sum = 0.0;
    constexpr uint32_t kCount = 40000;
    for (uint32_t pixel = 0; pixel < kCount; ++pixel) sum += (first(pixel) - 0.5) * (second(pixel) - 0.5);
    return sum / kCount;
}

TEST(Sampler, PixelsDimensionsAndSamplesAreNotCorrelated) {
    // The standard deviation of each mean is (1 / 12) / sqrt(40000) = 0.0004.
    constexpr double kBound = 0.002;
    const auto x = [](uint32_t pixel) { return uniform_2d({pixel, 0}, dimension(Use::kSun, 1)).x; };
    EXPECT_NEAR(covariance(x, [](uint32_t p) { return uniform_2d({p, 0}, dimension(Use::kSun, 1)).y; }), 0.0, kBound);
    EXPECT_NEAR(covariance(x, [](uint32_t p) { return uniform_2d({p + 1, 0}, dimension(Use::kSun, 1)).x; }), 0.0, kBound);
    EXPECT_NEAR(covariance(x, [](uint32_t p) { return uniform_2d({p, 0}, dimension(Use::kSun, 2)).x; }), 0.0, kBound);
    EXPECT_NEAR(covariance(x, [](uint32_t p) { return uniform_2d({p, 0}, dimension(Use::kLight, 1)).x; }), 0.0, kBound);
    // Samples 0 and 1 lie in different halves: by stratification their covariance is -1/16 of the halves.
    EXPECT_NEAR(covariance(x, [](uint32_t p) { return uniform_2d({p, 1}, dimension(Use::kSun, 1)).x; }), -0.0625, kBound);
    EXPECT_NEAR(covariance(x, x), 1.0 / 12.0, kBound);
}

TEST(Sampler, TheMeanOverPixelsIsOneHalf) {
    double sum = 0.0;
    for (uint32_t pixel = 0; pixel < 40000; ++pixel) sum += uniform_1d({pixel, 3}, dimension(Use::kAlpha, 0, 2));
    EXPECT_NEAR(sum / 40000, 0.5, 5 * 0.2887 / 200);
}

}  // namespace
}  // namespace zoe::test
