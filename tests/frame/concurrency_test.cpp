// Threads: what may be done at the same time, and that nothing depends on how many there are.

#include <algorithm>
#include <atomic>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "content/content.h"
#include "engine/frame/classify.h"
#include "engine/frame/frame.h"
#include "engine/math/parallel.h"
#include "tests/frame/motion_class.h"
#include "tests/frame/random_rays.h"

namespace zoe {
namespace {

using test::play;
using test::rays_at;

// Small ones of every motion class.
const char* const kScenes[] = {"static-500",    "rigid-8",     "deforming-12", "skinned-1",
                               "arbitrary-200", "topology-10", "instances-40"};
constexpr double kTimes_s[] = {0.0, 0.7, 1.3};

// Hits at several times, one after another.
std::vector<Hit> hits_of(const char* name) {
    Content content = make_content(name);
    std::vector<Hit> all;
    for (const double time_s : kTimes_s) {
        const Tlas& tlas = play(content, time_s);
        const std::vector<Ray> rays = rays_at(tlas, 200, 5);
        std::vector<Hit> hits(rays.size());
        closest_hits(tlas, rays, hits);
        all.insert(all.end(), hits.begin(), hits.end());
    }
    return all;
}

class Concurrency : public testing::TestWithParam<const char*> {};

TEST_P(Concurrency, OneToSixtyFourThreadsGiveTheSameBits) {
    set_thread_count(1);
    const std::vector<Hit> expected = hits_of(GetParam());
    EXPECT_GT(std::count_if(expected.begin(), expected.end(), [](const Hit& hit) { return bool(hit); }), 30);
    for (const int threads : {2, 3, 4, 7, 8, 16, 31, 64}) {
        set_thread_count(threads);
        EXPECT_EQ(hits_of(GetParam()), expected) << threads << " threads";
    }
    set_thread_count(0);
}

TEST_P(Concurrency, ManyThreadsTraceWhileNothingChanges) {
    Content content = make_content(GetParam());
    const Tlas& tlas = play(content, 0.7);
    const Scene& scene = content.scene;
    const std::vector<Ray> rays = rays_at(tlas, 600, 6);
    std::vector<Hit> expected(rays.size());
    std::vector<uint8_t> expected_any(rays.size());
    closest_hits(tlas, rays, expected);
    any_hits(tlas, rays, expected_any);
    const Affine world_from_first = world_from_node(scene, NodeId{0});

    // All of them everything, each from another place on, one by one and in batches, so that they meet everywhere.
    std::atomic<int> wrong_count{0}, ready_count{0};
    constexpr size_t kThreads = 8;
    std::vector<std::thread> threads;
    for (size_t t = 0; t < kThreads; ++t) {
        threads.emplace_back([&, t] {
            for (++ready_count; ready_count < static_cast<int>(kThreads);) std::this_thread::yield();
            std::vector<Hit> hits(rays.size());
            std::vector<uint8_t> is_hit(rays.size());
            for (size_t k = 0; k < rays.size(); ++k) {
                const size_t at = (k + t * rays.size() / kThreads) % rays.size();
                wrong_count += closest_hit(tlas, rays[at]) != expected[at];
                wrong_count += any_hit(tlas, rays[at]) != bool(expected_any[at]);
            }
            closest_hits(tlas, rays, hits);
            any_hits(tlas, rays, is_hit);
            wrong_count += hits != expected;
            wrong_count += is_hit != expected_any;
            wrong_count += !(world_from_node(scene, NodeId{0}) == world_from_first);
            wrong_count += motion(scene, NodeId{0}) > Motion::kArbitrary;
        });
    }
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(wrong_count, 0);
}

INSTANTIATE_TEST_SUITE_P(Content, Concurrency, testing::ValuesIn(kScenes), [](const auto& info) {
    std::string name = info.param;
    return name.substr(0, name.find('-'));
});

// Not by parallel_for, as in Edit.ScenesMayAdvanceInParallel, but in threads that know nothing of each other.
TEST(ConcurrentScenes, EachInAThreadOfItsOwnGivesItsOwnHits) {
    for (const int thread_count : {1, 2, 5}) {
        set_thread_count(thread_count);
        std::vector<std::vector<Hit>> expected, hits(std::size(kScenes));
        for (const char* name : kScenes) expected.push_back(hits_of(name));
        std::vector<std::thread> threads;
        for (size_t k = 0; k < std::size(kScenes); ++k) threads.emplace_back([&, k] { hits[k] = hits_of(kScenes[k]); });
        for (std::thread& thread : threads) thread.join();
        for (size_t k = 0; k < std::size(kScenes); ++k) EXPECT_EQ(hits[k], expected[k]) << kScenes[k];
    }
    set_thread_count(0);
}

// Of two threads that make a frame of one scene, the one that comes second is told, and the first is not disturbed.
TEST(ConcurrentScenes, ASecondThreadInAdvanceIsRefused) {
    Content content = make_content("instances-2000");
    Scene& scene = content.scene;
    advance(scene, 0.0);
    std::atomic<int> made{0}, refused{0}, ready{0};
    std::vector<std::thread> threads;
    for (int t = 0; t < 2; ++t) {
        threads.emplace_back([&] {
            for (++ready; ready < 2;) std::this_thread::yield();
            // Until both have happened, on however few cores.
            for (int k = 0; k < 20000 && (made == 0 || refused == 0 || k < 20); ++k) {
                try {
                    advance(scene, 0.01 * k);
                    ++made;
                } catch (const std::logic_error&) {
                    ++refused;
                }
            }
        });
    }
    for (std::thread& thread : threads) thread.join();
    EXPECT_GT(made, 0);
    EXPECT_GT(refused, 0) << "the two never met";

    const Tlas& tlas = advance(scene, 0.7);
    const std::vector<Ray> rays = rays_at(tlas, 500, 7);
    Content fresh = make_content("instances-2000");
    std::vector<Hit> hits(rays.size()), expected(rays.size());
    closest_hits(tlas, rays, hits);
    closest_hits(advance(fresh.scene, 0.7), rays, expected);
    EXPECT_EQ(hits, expected);
}

// A frame that throws lets the next one in.
TEST(ConcurrentScenes, AFrameThatThrewLetsTheNextOneIn) {
    Content content = make_content("rigid-3");
    advance(content.scene, 0.0);
    content.scene.playback.clips = {ClipId{9}};
    EXPECT_THROW(advance(content.scene, 0.0), SceneError);
    content.scene.playback.clips = {ClipId{0}};
    EXPECT_NO_THROW(advance(content.scene, 0.0));
}

}  // namespace
}  // namespace zoe
