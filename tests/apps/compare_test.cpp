// What counts as another hit, and how two programs' times become a ratio.

#include "apps/bench/compare.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "apps/bench/report.h"
#include "apps/common/stats_json.h"

namespace zoe::test {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

TEST(Compare, HitsAgreeUpToATenThousandthOfTheirDistanceOrInTheSameTriangle) {
    const Hit hit{.t = 2.0f, .u = 0.1f, .v = 0.2f, .node = NodeId{3}, .primitive = 7};
    const auto with = [&](float t, unsigned node, uint32_t primitive) {
        return Hit{.t = t, .u = 0.5f, .v = 0.5f, .node = NodeId{node}, .primitive = primitive};
    };
    EXPECT_FALSE(is_disagreement(hit, hit));
    EXPECT_FALSE(is_disagreement({}, {}));
    EXPECT_TRUE(is_disagreement(hit, {}));
    EXPECT_TRUE(is_disagreement({}, hit));
    EXPECT_TRUE(is_disagreement(hit, with(2.0f, 4, 7))) << "another node";
    EXPECT_FALSE(is_disagreement(hit, with(2.1f, 3, 7))) << "the same triangle";
    EXPECT_FALSE(is_disagreement(hit, with(2.00019f, 3, 8)));
    EXPECT_TRUE(is_disagreement(hit, with(2.00021f, 3, 8)));
    EXPECT_TRUE(is_disagreement(with(2.00021f, 3, 8), hit));
    for (const uint32_t primitive : {7u, 8u}) {
        EXPECT_TRUE(is_disagreement(hit, with(kNan, 3, primitive)));
        EXPECT_TRUE(is_disagreement(with(kNan, 3, primitive), hit));
    }
}

FrameRecord record(double ours_ms, double peers_ms) {
    FrameRecord frame{.frame = 1, .stats = {}, .peer = PeerStats{}};
    frame.stats.animate_ms = frame.stats.deform_ms = 1000.0;  // in no ratio
    frame.stats.update_blas_ms = 0.25 * ours_ms;
    frame.stats.build_tlas_ms = 0.25 * ours_ms;
    frame.stats.trace_ms = 0.5 * ours_ms;
    frame.stats.primary.ms = 0.5 * ours_ms;
    frame.peer->update_ms = frame.peer->build_tlas_ms = 0.25 * peers_ms;
    frame.peer->trace_ms = frame.peer->primary.ms = 0.5 * peers_ms;
    return frame;
}

TEST(Ratios, AreThePeersTimeOverOursMedianOverTheFrames) {
    const Ratios ratios = ratios_to_peer({record(10.0, 20.0), record(10.0, 30.0), record(10.0, 1000.0)});
    EXPECT_DOUBLE_EQ(ratios.frame, 3.0);
    EXPECT_DOUBLE_EQ(ratios.update, 3.0);
    EXPECT_DOUBLE_EQ(ratios.primary, 3.0);
    EXPECT_TRUE(std::isnan(ratios.shadow)) << "neither took any time";
    EXPECT_TRUE(std::isnan(ratios_to_peer({}).frame));
}

TEST(Sparkline, GoesFromZeroToTheLargest) {
    EXPECT_EQ(sparkline({1.0, 8.0}, 20), "\u2581\u2588");
    EXPECT_EQ(sparkline({4.0, 4.0, 8.0, 8.0}, 2), "\u2584\u2588") << "means of neighbours";
    EXPECT_EQ(sparkline({0.0}, 20), "\u2581");
    EXPECT_EQ(sparkline({}, 20), "");
}

}  // namespace
}  // namespace zoe::test
