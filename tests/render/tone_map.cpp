// What becomes of light that no screen can show.

#include "engine/render/tone_map.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "engine/math/rng.h"

namespace zoe::test {
namespace {

constexpr Tone kTones[] = {Tone::kNeutral, Tone::kAces, Tone::kLinear};

glm::vec3 random_color(Rng& rng, float most) {
    return most * glm::vec3(rng.uniform(), rng.uniform(), rng.uniform());
}

TEST(ToneMap, StaysBetweenBlackAndWhite) {
    Rng rng(11);
    const float infinity = std::numeric_limits<float>::infinity(), nan = std::nanf("");
    std::vector<glm::vec3> colors = {glm::vec3(0),       glm::vec3(nan), glm::vec3(infinity),
                                     {infinity, 0, nan}, glm::vec3(-1),  glm::vec3(1e-40f)};
    for (int k = 0; k < 10'000; ++k) colors.push_back(random_color(rng, std::exp2(rng.uniform() * 40.0f - 20.0f)));
    for (const Tone tone : kTones) {
        for (const glm::vec3& color : colors) {
            const glm::vec3 mapped = tone_map(tone, color);
            for (int c = 0; c < 3; ++c) EXPECT_TRUE(mapped[c] >= 0.0f && mapped[c] <= 1.0f) << mapped[c] << ", seed 11";
        }
    }
}

TEST(ToneMap, NothingGetsDarkerWhereLightGrows) {
    for (const Tone tone : kTones) {
        for (const glm::vec3& color : {glm::vec3(1.0f, 0.5f, 0.25f), glm::vec3(0.1f, 1.0f, 0.1f), glm::vec3(1.0f)}) {
            glm::vec3 last(0.0f);
            for (float x = 0.001f; x < 10'000.0f; x *= 1.02f) {
                const glm::vec3 next = tone_map(tone, x * color);
                for (int c = 0; c < 3; ++c) EXPECT_GE(next[c], last[c] - 1e-6f) << "channel " << c << " at " << x;
                last = next;
            }
        }
    }
}

/// Its definition: what stands in white light and reflects 0.04 of it comes out with its base colour, up to the shoulder.
TEST(ToneMap, NeutralKeepsBaseColours) {
    Rng rng(12);
    for (int k = 0; k < 1000; ++k) {
        const glm::vec3 base = glm::vec3(0.05f) + random_color(rng, 0.7f);
        const glm::vec3 mapped = tone_map(Tone::kNeutral, base + 0.04f);
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(mapped[c], base[c], 1e-6f) << "seed 12";
    }
}

TEST(ToneMap, NeutralGoesToWhite) {
    const glm::vec3 mapped = tone_map(Tone::kNeutral, {1e5f, 1e3f, 0.0f});
    for (int c = 0; c < 3; ++c) EXPECT_GT(mapped[c], 0.99f);
}

/// The published curve at a few places, worked out by hand.
TEST(ToneMap, AcesIsThePublishedCurve) {
    EXPECT_NEAR(tone_map(Tone::kAces, glm::vec3(0.18f)).x,
                0.18 * (2.51 * 0.18 + 0.03) / (0.18 * (2.43 * 0.18 + 0.59) + 0.14), 1e-6);
    EXPECT_NEAR(tone_map(Tone::kAces, glm::vec3(1.0f)).x, 2.54 / 3.16, 1e-6);
}

TEST(ToneMap, HasNames) {
    EXPECT_EQ(tone_from_name("neutral"), Tone::kNeutral);
    EXPECT_EQ(tone_from_name("aces"), Tone::kAces);
    EXPECT_EQ(tone_from_name("linear"), Tone::kLinear);
    EXPECT_FALSE(tone_from_name("other"));
}

}  // namespace
}  // namespace zoe::test
