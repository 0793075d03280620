// A scene that is edited without end: hits stay those of a fresh scene, memory and work do not grow.

#include <cstdio>
#include <vector>

#include <gtest/gtest.h>

#include "engine/math/parallel.h"
#include "tests/math/random_inputs.h"
#include "tests/stability/soak_scene.h"
#include "tests/support/allocation_count.h"
#include "tests/support/long_run.h"

namespace zoe::test {
namespace {

constexpr uint64_t kSeed = 20261;
constexpr int kRays = 64;

int frame_count() {
    if (!is_long_run()) return 400;
#if defined(__SANITIZE_THREAD__)
    return 1'000;
#elif defined(__SANITIZE_ADDRESS__)
    return 10'000;
#else
    return 100'000;
#endif
}

class Soak : public ::testing::Test {
protected:
    void SetUp() override { set_thread_count(1); }
    void TearDown() override { set_thread_count(0); }
};

double time_of(int frame) {
    return (frame * 7 % 101) / 24.0;
}

std::vector<Ray> rays_of(int frame) {
    Rng rng(mix_bits(static_cast<uint64_t>(frame) + 1));
    std::vector<Ray> rays;
    for (int k = 0; k < kRays; ++k) {
        const glm::vec3 origin = random_point(rng, 9.0f);
        rays.push_back({origin, random_point(rng, 4.0f) - origin});
    }
    return rays;
}

std::vector<Hit> hits_of(const Tlas& tlas, const std::vector<Ray>& rays) {
    std::vector<Hit> hits(rays.size());
    closest_hits(tlas, rays, hits);
    return hits;
}

uint64_t nodes_visited(const Tlas& tlas, const std::vector<Ray>& rays) {
    TraverseCounts counts;
    for (const Ray& ray : rays) closest_hit(tlas, ray, &counts);
    return counts.nodes + counts.triangles;
}

// Played on several threads, and the fresh one on one.
TEST_F(Soak, HitsAreThoseOfAFreshSceneWhateverWasEdited) {
    constexpr int kThreads = 3;
    SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
    SoakScene soak(kSeed);
    int hit_count = 0, compared = 0;
    set_thread_count(kThreads);
    for (int frame = 0; frame < frame_count(); ++frame) {
        soak.edit();
        const Tlas& tlas = advance(soak.scene, time_of(frame));
        if (frame % 10 != 0) continue;
        const std::vector<Ray> rays = rays_of(frame);
        const std::vector<Hit> hits = hits_of(tlas, rays);
        set_thread_count(1);
        Scene fresh = copy_of(soak.scene);
        ASSERT_EQ(hits, hits_of(advance(fresh, time_of(frame)), rays)) << "frame " << frame;
        for (size_t k = 0; k < rays.size(); ++k) {
            ASSERT_EQ(closest_hit(tlas, rays[k]), hits[k]) << "frame " << frame << ", ray " << k;
            ASSERT_EQ(any_hit(tlas, rays[k]), static_cast<bool>(hits[k])) << "frame " << frame << ", ray " << k;
            hit_count += static_cast<bool>(hits[k]);
        }
        ++compared;
        set_thread_count(kThreads);
    }
    EXPECT_GT(hit_count, compared * kRays / 20) << "rays that hit nothing compare nothing";
    std::printf("%d frames, %d of them compared, %d hits\n", frame_count(), compared, hit_count);
}

// At stations of the way, the scene is put back as it was: then it takes as much memory and work as at the first station.
TEST_F(Soak, MemoryAndWorkDoNotGrowFromStationToStation) {
    SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
    SoakScene soak(kSeed + 1);
    const int station_frames = frame_count() / 20;
    const std::vector<Ray> rays = rays_of(1);
    size_t first_bytes = 0, last_bytes = 0, largest = 0;
    uint64_t first_work = 0;
    for (int frame = 0; frame < frame_count(); ++frame) {
        soak.edit();
        advance(soak.scene, time_of(frame));
        largest = std::max(largest, live_bytes());
        if ((frame + 1) % station_frames != 0) continue;
        soak.restore();
        advance(soak.scene, 0.0);
        const uint64_t work = nodes_visited(advance(soak.scene, 0.5), rays);
        // Half of the way to warm up: lists grow to their longest, warnings of every kind are given once.
        if (frame < frame_count() / 2) {
            first_bytes = std::max(first_bytes, live_bytes());
            first_work = work;
            continue;
        }
        last_bytes = live_bytes();
        EXPECT_LE(last_bytes, first_bytes + 16384) << "frame " << frame;
        EXPECT_EQ(work, first_work) << "frame " << frame;
    }
    std::printf("%d frames: %zu bytes at the stations of the first half, %zu at the last, at most %zu on the way\n",
                frame_count(), first_bytes, last_bytes, largest);
}

// Without a station: the same frames over and over, meshes written in each.
TEST_F(Soak, MemoryAndWorkDoNotGrowFromRoundToRound) {
    SoakScene soak(kSeed + 2);
    constexpr int kRound = 50;
    const int round_count = frame_count() / kRound;
    const std::vector<Ray> rays = rays_of(2);
    std::vector<size_t> bytes;
    std::vector<uint64_t> work;
    std::vector<Hit> first_hits(rays.size());
    bytes.reserve(static_cast<size_t>(round_count));
    work.reserve(static_cast<size_t>(round_count));
    for (int round = 0; round < round_count; ++round) {
        for (int step = 0; step < kRound; ++step) {
            soak.write(static_cast<uint64_t>(step));
            advance(soak.scene, step / 24.0);
        }
        const Tlas& tlas = advance(soak.scene, 2.0);
        bytes.push_back(live_bytes());
        work.push_back(nodes_visited(tlas, rays));
        if (round == 1) first_hits = hits_of(tlas, rays);
        if (round > 1) {
            ASSERT_EQ(hits_of(tlas, rays), first_hits) << "round " << round;
        }
    }
    ASSERT_GE(round_count, 4);
    for (size_t round = 3; round < bytes.size(); ++round) {
        EXPECT_EQ(bytes[round], bytes[2]) << "round " << round;
        EXPECT_LE(work[round], work[2] + work[2] / 4) << "round " << round;
    }
    std::printf(
        "%d rounds of %d frames: %zu bytes after the third, %zu after the last; %llu and %llu tests of boxes and "
        "triangles\n",
        round_count, kRound, bytes[2], bytes.back(), static_cast<unsigned long long>(work[2]),
        static_cast<unsigned long long>(work.back()));
}

}  // namespace
}  // namespace zoe::test
