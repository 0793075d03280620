// What the choice of rebuilds costs beside the best choice in hindsight.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <set>

#include <gtest/gtest.h>

#include "engine/math/rng.h"
#include "tests/frame/rebuild_account.h"

namespace zoe::test {
namespace {

constexpr uint32_t kTriangles = 1000;

// Small numbers and large ones, as likely.
double random_size(Rng& rng, double least, double most) {
    return least * std::pow(most / least, double(rng.uniform()));
}

/// Trees of random worth, but that a newer one is never worse than an older one. New trees cost as their triangles' areas
/// have it, so that no estimate is above what a new tree costs.
ReadingTable random_ageing(Rng& rng) {
    const size_t frame_count = 2 + rng.below(60);
    const double new_cost = random_size(rng, 1e-3, 10.0), worst_loss = random_size(rng, 1e-2, 1e2);
    const bool is_area_steady = rng.below(2) == 0;
    std::vector<double> areas(frame_count);
    for (double& area : areas) area = is_area_steady ? 1.0 : random_size(rng, 0.1, 10.0);
    ReadingTable readings(frame_count);
    for (size_t built = 0; built < frame_count; ++built) readings[built].resize(frame_count - built);
    for (size_t frame = 0; frame < frame_count; ++frame) {
        double cost = 1.0 + new_cost * areas[frame];  // Every ray enters the root.
        for (size_t built = frame + 1; built-- > 0;) {
            readings[built][frame - built] = {cost, areas[frame]};
            if (rng.below(3) == 0) cost += random_size(rng, 1e-4, 1.0) * worst_loss;
        }
    }
    return readings;
}

/// Poses that are held, and jumps at which all older trees become worse, mostly at regular times.
ReadingTable random_jumps(Rng& rng) {
    std::vector<int> pose_of_frame(2 + rng.below(80), 0);
    const uint32_t pause = rng.below(3) > 0 ? 3 + rng.below(12) : 0;
    for (size_t frame = 1; frame < pose_of_frame.size(); ++frame) {
        const bool is_regular = pause > 0 && frame % pause == 0 && rng.below(8) > 0;
        const bool is_jump = is_regular || rng.below(pause > 0 ? 40 : 6) == 0;
        pose_of_frame[frame] = pose_of_frame[frame - 1] + int(is_jump);
    }
    const double new_cost = 1.0 + random_size(rng, 1e-4, 3.0), loss = random_size(rng, 0.1, 100.0);
    const bool is_by_age = rng.below(2) == 0;
    ReadingTable readings(pose_of_frame.size());
    for (size_t built = 0; built < readings.size(); ++built) {
        for (size_t frame = built; frame < readings.size(); ++frame) {
            const int age = pose_of_frame[frame] - pose_of_frame[built];
            readings[built].push_back({new_cost + (is_by_age ? 0.2 * std::min(age, 5) : double(age > 0)) * loss, 1.0});
        }
    }
    return readings;
}

TEST(RebuildBound, WherePosesAreHeldAndJumpItIsTwiceHindsight) {
    for (uint64_t seed = 1; seed <= 5000; ++seed) {
        Rng rng(seed);
        const ReadingTable readings = random_jumps(rng);
        Account account{readings, kTriangles, random_size(rng, 1.0, 1e6)};
        EXPECT_LE(account.by_policy(), 2.0 * account.in_hindsight()) << "seed " << seed;
        // Hidden now and then, or far away.
        for (size_t frame = 0; frame < readings.size(); ++frame) {
            account.shares.push_back(rng.below(3) == 0 ? 1.0 : random_size(rng, 1e-7, 1.0));
        }
        EXPECT_LE(account.by_policy(), 2.0 * account.in_hindsight()) << "seed " << seed << ", rays that vary";
    }
}

/// Of the first frames of a clip alone.
ReadingTable begin_of(const ReadingTable& readings, size_t frame_count) {
    ReadingTable begin(readings.begin(), readings.begin() + static_cast<std::ptrdiff_t>(frame_count));
    for (size_t built = 0; built < frame_count; ++built) begin[built].resize(frame_count - built);
    return begin;
}

TEST(RebuildBound, WhereTreesOnlyAgeItIsTwiceHindsight) {
    double worst = 1.0;
    for (uint64_t seed = 1; seed <= 2000; ++seed) {
        Rng rng(seed);
        const ReadingTable readings = random_ageing(rng);
        const Account account{readings, kTriangles, random_size(rng, 1.0, 1e6)};
        const double ratio = account.by_policy() / account.in_hindsight();
        EXPECT_GE(ratio, 1.0 - 1e-12) << "seed " << seed;
        EXPECT_LE(ratio, 2.0) << "seed " << seed;
        worst = std::max(worst, ratio);
    }
    printf("random trees: at most %.3f times the best\n", worst);
    EXPECT_GT(worst, 1.5);
}

// A clip that ends with the first rebuild: where that does not pay at once it was for nothing. It is a tenth of what always
// refitting takes, or as much as keeping to twice hindsight asks for: the tree has lost a rebuild's work and all that the
// rays needed anyway. After a second jump, whose pose is expected to be held, it is at most what always refitting takes.
TEST(RebuildBound, ARebuildForNothingIsATenthOfRefittingOrAskedForByHindsightOrFollowsASecondJump) {
    int dear_count = 0, cheap_count = 0, expected_count = 0;
    for (uint64_t seed = 1; seed <= 2000; ++seed) {
        Rng rng(seed);
        const ReadingTable whole = random_ageing(rng);
        const auto is_as_first = [&](const TreeReading& r) { return r.triangle_area == whole[0][0].triangle_area; };
        if (!std::ranges::all_of(whole[0], is_as_first)) continue;  // Or new trees cost other than they are expected to.
        const double rays = random_size(rng, 1.0, 1e6);
        for (size_t frame_count = 2; frame_count <= whole.size(); ++frame_count) {
            const ReadingTable readings = begin_of(whole, frame_count);
            const Account account{readings, kTriangles, rays};
            const double work = account.by_policy(), refitted = account.always_refitted(), build = account.build_work();
            if (work == refitted) continue;
            const size_t last = frame_count - 1;
            if (account.trace_work(0, last) - account.trace_work(last, last) >= build) {
                EXPECT_LE(work, refitted * (1 + 1e-9)) << "seed " << seed;
                break;
            }
            double needed = 0.0;
            for (size_t frame = 1; frame <= last; ++frame) needed += account.trace_work(frame, frame);
            const bool is_cheap = build <= RebuildConfig{}.share * refitted * (1 + 1e-9);
            const bool is_dear = refitted >= (build + 2.0 * needed) * (1 - 1e-9);
            int jump_count = 0;
            for (size_t frame = 1; frame <= last; ++frame)
                jump_count += whole[0][frame].cost > 2.0 * whole[0][frame - 1].cost;
            EXPECT_TRUE(is_cheap || is_dear || (jump_count >= 2 && build <= refitted)) << "seed " << seed;
            EXPECT_LE(work, refitted + build) << "seed " << seed;
            ++(is_cheap ? cheap_count : is_dear ? dear_count : expected_count);
            break;
        }
    }
    EXPECT_GT(expected_count, 5);
    EXPECT_GT(cheap_count, 20);
    EXPECT_GT(dear_count, 20);
}

/// Poses by number: a tree loses nothing in the pose that it was built for, and so much in any other.
ReadingTable poses(const std::vector<int>& pose_of_frame, double loss) {
    ReadingTable readings(pose_of_frame.size());
    for (size_t built = 0; built < pose_of_frame.size(); ++built) {
        for (size_t frame = built; frame < pose_of_frame.size(); ++frame) {
            readings[built].push_back({1e-6 + (pose_of_frame[built] == pose_of_frame[frame] ? 0.0 : loss), 1.0});
        }
    }
    return readings;
}

/// The last frame that rebuilds; 0 where none does.
size_t rebuilt_frame(const ReadingTable& readings, double rays) {
    size_t built = 0;
    Account{readings, kTriangles, rays}.by_policy(&built);
    return built;
}

TEST(RebuildBound, ItIsTwiceWhereTheClipEndsWithTheRebuild) {
    constexpr int kFramesToLose = 50;
    std::vector<int> pose_of_frame(1 + kFramesToLose, 1);
    pose_of_frame[0] = 0;
    const ReadingTable readings = poses(pose_of_frame, 1.0);
    Account account{readings, kTriangles};
    account.rays = account.build_work() / kFramesToLose * (1.0 + 1e-5);
    EXPECT_GT(account.by_policy(), 1.95 * account.in_hindsight());
}

// Hindsight may wait for the pose that an old tree was built for, and a rule that doesn't know what comes can't tell: with
// two poses that come in turns, none is always within three times of it (Borodin, Linial, Saks, JACM 1992). Ours is within
// four: while hindsight keeps one tree and loses a rebuild's work, ours loses as much twice and rebuilds twice.
TEST(RebuildBound, WhereTwoPosesComeInTurnsItIsFourTimesHindsight) {
    for (uint64_t seed = 1; seed <= 500; ++seed) {
        Rng rng(seed);
        std::vector<int> pose_of_frame(2 + rng.below(80), 0);
        const uint32_t mean_pause = 1 + rng.below(20);
        for (size_t frame = 1; frame < pose_of_frame.size(); ++frame) {
            pose_of_frame[frame] = pose_of_frame[frame - 1] ^ int(rng.below(mean_pause) == 0);
        }
        const ReadingTable readings = poses(pose_of_frame, random_size(rng, 1e-3, 1e2));
        const Account account{readings, kTriangles, random_size(rng, 1.0, 1e6)};
        EXPECT_LE(account.by_policy(), 4.0 * account.in_hindsight()) << "seed " << seed;
    }
    // A pose for a few frames, another one for fewer, on and on: to refit always is best.
    for (const auto& [first, second] : {std::pair{3, 1}, {6, 2}, {4, 2}, {10, 3}, {20, 3}}) {
        std::vector<int> pose_of_frame;
        while (pose_of_frame.size() < 200) {
            pose_of_frame.insert(pose_of_frame.end(), size_t(first), 0);
            pose_of_frame.insert(pose_of_frame.end(), size_t(second), 1);
        }
        const ReadingTable flashes = poses(pose_of_frame, 1.0);
        for (double rays = 1.0; rays < 1e6; rays *= 1.1) {
            const Account account{flashes, kTriangles, rays};
            ASSERT_LE(account.by_policy(), 4.0 * account.in_hindsight()) << first << " and " << second << ", rays " << rays;
        }
    }
    // The cruellest: the pose changes as soon as there is a tree for it.
    constexpr int kFramesToLose = 20, kTurns = 8;
    const double rays = RebuildConfig{}.triangle_work * kTriangles / kFramesToLose * (1.0 + 1e-5);
    std::vector<int> pose_of_frame(1, 0);
    for (int turn = 1; turn <= kTurns; ++turn) {
        const size_t begin = pose_of_frame.size();
        do {
            pose_of_frame.push_back(turn % 2);
        } while (rebuilt_frame(poses(pose_of_frame, 1.0), rays) < begin);
    }
    const ReadingTable readings = poses(pose_of_frame, 1.0);
    const Account account{readings, kTriangles, rays};
    const double ratio = account.by_policy() / account.in_hindsight();
    printf("two poses in turns: %.3f times the best\n", ratio);
    EXPECT_LE(ratio, 4.0);
    EXPECT_GT(ratio, 3.0);
}

struct Worst {
    double of_best = 1.0;   ///< Beside hindsight.
    double of_fixed = 0.0;  ///< Beside the better of always refitted and always rebuilt.
    int below_both = 0;     ///< Numbers of rays where both of these take more, by 2 % at least.
};

/// Over numbers of rays from one in about a hundred triangles to about a thousand a triangle.
Worst play(const Sequence& sequence) {
    constexpr double kRefitWork = RebuildConfig{}.triangle_work / 16.0;  // A triangle. Rebuilds take 14 to 22 times a refit.
    const ReadingTable readings = record_readings(sequence);
    const auto triangle_count = static_cast<uint32_t>(sequence.corners.size());
    Worst worst;
    const double build_work = RebuildConfig{}.triangle_work * triangle_count;
    for (double rays = build_work / 1200; rays < 83 * build_work; rays *= 1.5) {
        const Account account{readings, triangle_count, rays, kRefitWork * triangle_count};
        const double work = account.by_policy(), best = account.in_hindsight();
        const double fixed = std::min(account.always_refitted(), account.always_rebuilt());
        EXPECT_GE(work, best * (1 - 1e-12)) << sequence.name << ", rays " << rays;
        worst.of_best = std::max(worst.of_best, work / best);
        worst.of_fixed = std::max(worst.of_fixed, work / fixed);
        worst.below_both += work < 0.98 * fixed;
    }
    printf("%-20s at most %.3f times the best, %.3f times the better of refits and rebuilds; below both %d times\n",
           sequence.name.c_str(), worst.of_best, worst.of_fixed, worst.below_both);
    return worst;
}

TEST(RebuildBound, OfRecordedSequencesItIsTwiceHindsight) {
    // Where a mesh jumps just when there is a new tree, no rule that keeps to twice hindsight has 1.1.
    const std::set<std::string> jumping = {"tangled and back"};
    int better_than_fixed_count = 0;
    for (const Sequence& sequence : deforming_sequences()) {
        const Worst worst = play(sequence);
        EXPECT_LE(worst.of_best, 2.0) << sequence.name;
        EXPECT_LE(worst.of_fixed, jumping.contains(sequence.name) ? 1.25 : 1.1) << sequence.name;
        better_than_fixed_count += worst.below_both > 0;
    }
    EXPECT_GE(better_than_fixed_count, 5) << "sequences where neither refitting nor rebuilding always is as cheap";
}

// Poses come back here: a bound of three is what no rule can promise to beat (above).
TEST(RebuildBound, OfPosesThatComeBackItIsThreeTimesHindsight) {
    EXPECT_LE(play(permuted_and_back()).of_best, 3.0);
}

TEST(RebuildBound, OfRandomMotionsItIsTwiceHindsight) {
    for (uint64_t seed = 1; seed <= 12; ++seed) EXPECT_LE(play(random_sequence(seed)).of_best, 2.0) << "seed " << seed;
}

}  // namespace
}  // namespace zoe::test
