#include "apps/demo/pace.h"

#include <gtest/gtest.h>

#include "engine/math/rng.h"

namespace zoe {
namespace {

constexpr double kPixels = 640.0 * 360.0, kFrameMs = 1000.0 / 24.0;

/// What pictures take in full size, and besides.
struct Costs {
    double light_ms, surface_ms, other_ms = 2.0;
    /// Of a picture: surfaces only where they are not the light's own.
    double of(const PlaySizes& sizes) const {
        const double light = light_ms / (sizes.light * sizes.light),
                     surfaces = surface_ms / (sizes.surfaces * sizes.surfaces);
        return other_ms + light + (sizes.surfaces < sizes.light ? surfaces : 0.0);
    }
};

struct End {
    PlaySizes sizes;  ///< The last ones.
    int changes = 0;  ///< Of pictures in the second half, those of another size than the one before.
};

/// Plays pictures; each takes what it costs, give or take a share by chance.
End play(const Costs& costs, double noise = 0.0, uint64_t seed = 1) {
    Pace pace;
    Rng rng(seed);
    End end;
    for (int frame = 0; frame < 200; ++frame) {
        const PlaySizes now = pace.choose(kPixels, costs.other_ms);
        if (frame >= 100 && (now.light != end.sizes.light || now.surfaces != end.sizes.surfaces)) ++end.changes;
        end.sizes = now;
        const auto note = [&](int divisor, double ms, auto&& noted) {
            const double share = 1.0 / (divisor * divisor);
            noted(share * kPixels, share * ms * (1.0 + noise * (2.0 * rng.uniform() - 1.0)));
        };
        note(now.light, costs.light_ms, [&](double pixels, double ms) { pace.note_light(pixels, ms); });
        if (now.surfaces < now.light)
            note(now.surfaces, costs.surface_ms, [&](double pixels, double ms) { pace.note_surfaces(pixels, ms); });
    }
    return end;
}

TEST(Pace, PicturesAreInTimeAndNotSmallerThanNeedBe) {
    for (const double light_ms : {1.0, 20.0, 60.0, 150.0, 360.0, 900.0, 3000.0}) {
        for (const double share : {0.05, 0.15, 0.5}) {
            SCOPED_TRACE(testing::Message() << light_ms << " ms of light, " << share * light_ms << " of surfaces");
            const Costs costs{.light_ms = light_ms, .surface_ms = share * light_ms};
            const auto [sizes, changes] = play(costs);
            EXPECT_EQ(changes, 0);
            EXPECT_LE(costs.of(sizes), kFrameMs);
            EXPECT_LE(sizes.surfaces, sizes.light);
            // Surfaces have half of the time; with larger light, there would not be enough.
            if (sizes.surfaces > 1 && sizes.surfaces < sizes.light) {
                EXPECT_GT(costs.surface_ms / (sizes.surfaces - 1) / (sizes.surfaces - 1),
                          0.5 * 0.85 * (kFrameMs - costs.other_ms));
            }
            if (sizes.light > 1) {
                EXPECT_GT(costs.of({sizes.light - 1, sizes.surfaces}), 0.85 * kFrameMs);
            }
        }
    }
}

TEST(Pace, SurfacesAreFinerThanLightWhereTheyCostLess) {
    const PlaySizes sizes = play({.light_ms = 600.0, .surface_ms = 60.0}).sizes;
    EXPECT_LE(sizes.surfaces, 2);
    EXPECT_GE(sizes.light, 4);
    const PlaySizes cheap = play({.light_ms = 30.0, .surface_ms = 5.0}).sizes;
    EXPECT_EQ(cheap.light, 1) << "there is time for all: its own surfaces will do";
    EXPECT_EQ(cheap.surfaces, 1);
}

TEST(Pace, TimesThatVaryALittleDoNotChangeTheSize) {
    for (uint64_t seed = 1; seed <= 20; ++seed) {
        SCOPED_TRACE(seed);
        for (const double share : {0.05, 0.15, 0.5}) {
            EXPECT_LE(play({.light_ms = 360.0, .surface_ms = share * 360.0}, 0.1, seed).changes, 2) << share;
            for (double light_ms = 20.0; light_ms < 1500.0; light_ms *= 1.1) {
                const Costs costs{.light_ms = light_ms, .surface_ms = share * light_ms};
                EXPECT_LE(play(costs, 0.2, seed).changes, 6) << light_ms << ", " << share;
            }
        }
    }
}

TEST(Pace, HoweverLongTheRestTakesSomethingIsSeen) {
    const PlaySizes fast = play({.light_ms = 1e-3, .surface_ms = 1e-4, .other_ms = 1e6}).sizes;
    EXPECT_EQ(fast.light, 1);
    const PlaySizes slow = play({.light_ms = 1e9, .surface_ms = 1e9, .other_ms = 1e6}).sizes;
    EXPECT_EQ(slow.light, 12);
    EXPECT_EQ(slow.surfaces, 12);
}

/// A picture that was late for another reason is forgotten in time, though nothing is measured of surfaces meanwhile.
TEST(Pace, SurfacesAreFinerAgainAfterAStall) {
    for (const double stall_ms : {20.0, 100.0, 1000.0}) {
        SCOPED_TRACE(stall_ms);
        Pace pace;
        PlaySizes sizes;
        const auto show = [&](double late_ms) {
            sizes = pace.choose(kPixels, 2.0);
            pace.note_light(kPixels / (sizes.light * sizes.light), 600.0 / (sizes.light * sizes.light));
            if (sizes.surfaces < sizes.light)
                pace.note_surfaces(kPixels / (sizes.surfaces * sizes.surfaces),
                                   late_ms + 60.0 / (sizes.surfaces * sizes.surfaces));
        };
        for (int frame = 0; frame < 100; ++frame) show(0.0);
        const PlaySizes before = sizes;
        EXPECT_LT(before.surfaces, before.light);
        show(stall_ms);
        for (int frame = 0; frame < 600; ++frame) show(0.0);
        EXPECT_EQ(sizes.surfaces, before.surfaces);
        EXPECT_LE(sizes.light, before.light + 1) << "pictures grow where there is a tenth to spare";
        EXPECT_LT(sizes.surfaces, sizes.light);
    }
}

/// Where surfaces cost as much as their light, they are tried seldom.
TEST(Pace, WhatDoesNotPayIsTriedSeldom) {
    Pace pace;
    int tried_count = 0;
    for (int frame = 0; frame < 2400; ++frame) {
        const PlaySizes sizes = pace.choose(kPixels, 2.0);
        pace.note_light(kPixels / (sizes.light * sizes.light), 600.0 / (sizes.light * sizes.light));
        if (sizes.surfaces == sizes.light) continue;
        ++tried_count;
        pace.note_surfaces(kPixels / (sizes.surfaces * sizes.surfaces), 600.0 / (sizes.surfaces * sizes.surfaces));
    }
    EXPECT_GT(tried_count, 0);
    EXPECT_LE(tried_count, 2400 / 100);
}

/// What is shown without light has a size of its own: that of the lit picture is there again afterwards.
TEST(Pace, PicturesWithoutLightHaveTheirOwnSize) {
    Pace pace;
    PlaySizes lit;
    int unlit = 0;
    const auto show_lit = [&] {
        lit = pace.choose(kPixels, 2.0);
        pace.note_light(kPixels / (lit.light * lit.light), 600.0 / (lit.light * lit.light));
        if (lit.surfaces < lit.light)
            pace.note_surfaces(kPixels / (lit.surfaces * lit.surfaces), 30.0 / (lit.surfaces * lit.surfaces));
    };
    for (int frame = 0; frame < 60; ++frame) show_lit();
    const PlaySizes before = lit;
    for (int frame = 0; frame < 60; ++frame) {
        unlit = pace.choose_unlit(kPixels, 2.0);
        pace.note_surfaces(kPixels / (unlit * unlit), 30.0 / (unlit * unlit));
    }
    EXPECT_EQ(unlit, 1);
    show_lit();
    EXPECT_EQ(lit.light, before.light);
    EXPECT_EQ(lit.surfaces, before.surfaces);
}

}  // namespace
}  // namespace zoe
