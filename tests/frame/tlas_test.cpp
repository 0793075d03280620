// The top level: built exactly or fast, and kept while nothing that it holds has moved.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <new>
#include <vector>

#include "content/content.h"
#include "engine/frame/frame.h"
#include "engine/frame/trace.h"
#include "engine/math/parallel.h"
#include "tests/math/random_inputs.h"
#include "tests/support/allocation_count.h"

namespace zoe {
namespace {

constexpr uint32_t kAlways = 0xffffffffu;

// Between points in and around the scene.
std::vector<Hit> random_hits(const Tlas& tlas, uint64_t seed) {
    Rng rng(seed);
    const Aabb bounds = tlas.bounds();
    const auto point = [&] { return bounds.centre() + 0.7f * bounds.extent() * test::random_point(rng, 1.0f); };
    std::vector<Ray> rays;
    for (int k = 0; k < 3000; ++k) {
        const glm::vec3 from = point();
        rays.push_back({.origin = from, .direction = point() - from});
    }
    std::vector<Hit> hits(rays.size());
    closest_hits(tlas, rays, hits);
    const auto hit_count = std::count_if(hits.begin(), hits.end(), [](const Hit& hit) { return bool(hit); });
    EXPECT_GE(size_t(hit_count), rays.size() / 10);
    return hits;
}

void expect_valid(const Tlas& tlas) {
    EXPECT_EQ(validate(tlas.bvh, tlas.boxes), "");
    EXPECT_EQ(validate(tlas.tree, tlas.placed.size()), "");
    ASSERT_EQ(tlas.placed.size(), tlas.parts.size());
    ASSERT_GE(tlas.parts.size(), tlas.instances.size());
    for (size_t k = 0; k < tlas.placed.size(); ++k) {
        const PlacedPart& part = tlas.parts[tlas.slots[k]];
        const Instance& instance = tlas.instances[part.instance];
        EXPECT_EQ(tlas.placed[k].start, part.start);
        EXPECT_EQ(tlas.placed[k].local_from_world, instance.local_from_world);
        EXPECT_EQ(tlas.placed[k].id, index(instance.node));
        EXPECT_EQ(tlas.instance_of_node[index(instance.node)], part.instance);
        EXPECT_TRUE(instance.bounds_world.contains(tlas.boxes[tlas.slots[k]]));
    }
}

TEST(Tlas, FastAndExactFormsGiveTheSameHits) {
    for (const char* name : {"instances-1500", "rigid-300", "default", "mixed-1"}) {
        Content exact = make_content(name);
        exact.scene.tlas_build.exact_up_to = kAlways;
        for (const uint32_t radius : {1u, 8u, 100u}) {
            SCOPED_TRACE(::testing::Message() << name << ", radius " << radius);
            Content fast = make_content(name);
            fast.scene.tlas_build = {.exact_up_to = 0, .search_radius = radius};
            for (const double time_s : {0.0, 0.4, 1.3}) {
                const Tlas& expected = advance(exact.scene, time_s);
                const Tlas& actual = advance(fast.scene, time_s);
                expect_valid(expected);
                expect_valid(actual);
                EXPECT_EQ(random_hits(actual, 400), random_hits(expected, 400)) << "seed 400, time " << time_s << " s";
            }
        }
    }
}

TEST(Tlas, IsTheSameOnAnyNumberOfThreads) {
    std::vector<std::vector<uint32_t>> slots;
    for (const int threads : {1, 2, 5}) {
        set_thread_count(threads);
        Content content = make_content("instances-5000");
        for (const double time_s : {0.0, 0.5}) advance(content.scene, time_s);
        slots.push_back(advance(content.scene, 1.0).slots);
    }
    set_thread_count(0);
    EXPECT_EQ(slots[1], slots[0]);
    EXPECT_EQ(slots[2], slots[0]);
}

TEST(Tlas, OpenedInstancesAndTightBoxesGiveTheSameHits) {
    for (const char* name : {"default", "mixed-1", "static-2000", "rigid-100", "skinned-3", "topology-20", "deforming-40"}) {
        Content whole = make_content(name);
        whole.scene.placing = {.has_tight_boxes = false, .most_parts = 0};
        for (const uint32_t most_parts : {0u, 7u, 256u, 5000u}) {
            SCOPED_TRACE(::testing::Message() << name << ", most_parts " << most_parts);
            Content opened = make_content(name);
            opened.scene.placing = {.most_parts = most_parts, .least_share = most_parts > 256 ? 0.0f : 1.0f / 1024};
            for (const double time_s : {0.0, 0.4, 1.3, 0.4}) {
                for (Content* content : {&whole, &opened}) {
                    if (content->write) content->write(content->scene, time_s);
                }
                const Tlas& expected = advance(whole.scene, time_s);
                const Tlas& actual = advance(opened.scene, time_s);
                EXPECT_EQ(expected.parts.size(), expected.instances.size());
                EXPECT_LE(actual.parts.size(), actual.instances.size() + most_parts);
                expect_valid(expected);
                expect_valid(actual);
                EXPECT_TRUE(actual.bounds().lo == expected.bounds().lo && actual.bounds().hi == expected.bounds().hi);
                EXPECT_EQ(random_hits(actual, 420), random_hits(expected, 420)) << "seed 420, time " << time_s << " s";
            }
        }
    }
    Content content = make_content("mixed-1");
    if (content.write) content.write(content.scene, 0.5);
    const Tlas& tlas = advance(content.scene, 0.5);
    EXPECT_GT(tlas.parts.size(), tlas.instances.size() + 20) << "nothing was opened";
}

// Small triangles in a ball of radius 1.
Mesh ball_of_triangles(int count, Rng& rng) {
    Mesh mesh;
    for (int k = 0; k < count; ++k) {
        const glm::vec3 centre = test::random_point(rng, 0.6f);
        const auto first = static_cast<uint32_t>(mesh.positions.size());
        for (int corner = 0; corner < 3; ++corner) mesh.positions.push_back(centre + test::random_point(rng, 0.15f));
        mesh.corners.emplace_back(first, first + 1, first + 2);
    }
    return mesh;
}

// Copies that lie in each other, some of them in one place, in a room that needs no transform and is as large as all.
Scene pile_in_a_room(uint64_t seed) {
    Rng rng(seed);
    Scene scene;
    const MeshId pebble = scene.add(ball_of_triangles(60, rng));
    Mesh walls = ball_of_triangles(400, rng);
    for (glm::vec3& p : walls.positions) p = 12.0f * p / glm::length(p);
    const MeshId room = scene.add(std::move(walls));
    for (int k = 0; k < 40; ++k) {
        Node node{.mesh = pebble};
        node.local.translation = k % 4 == 0 ? glm::vec3(0) : test::random_point(rng, 1.0f);
        node.local.scale = glm::vec3(rng.uniform(0.5f, 2.0f));
        scene.add(std::move(node));
    }
    scene.add(Node{.mesh = pebble});  // It, too, needs no transform.
    scene.add(Node{.mesh = room});
    return scene;
}

TEST(Tlas, APileInARoomIsHitTheSameHoweverItIsPlaced) {
    for (const uint64_t seed : {430, 431, 432}) {
        Scene whole = pile_in_a_room(seed);
        whole.placing = {.has_tight_boxes = false, .most_parts = 0};
        const Tlas& expected = advance(whole, 0.0);
        for (const uint32_t most_parts : {0u, 32u, 300u}) {
            SCOPED_TRACE(::testing::Message() << "seed " << seed << ", most_parts " << most_parts);
            Scene opened = pile_in_a_room(seed);
            opened.placing = {.most_parts = most_parts, .least_share = most_parts > 32 ? 0.0f : 1.0f / 1024};
            const Tlas& actual = advance(opened, 0.0);
            expect_valid(actual);
            EXPECT_EQ(actual.parts.size() > actual.instances.size(), most_parts > 0);
            EXPECT_EQ(random_hits(actual, seed), random_hits(expected, seed));
        }
    }
}

bool is_built_at(Scene* scene, double time_s) {
    FrameStats stats;
    advance(*scene, time_s, &stats);
    return stats.tlas_builds > 0;
}

TEST(Tlas, IsKeptWhileNothingMoves) {
    for (const uint32_t exact_up_to : {0u, kAlways}) {
        Content moving = make_content("instances-500"), still = make_content("static");
        moving.scene.tlas_build.exact_up_to = still.scene.tlas_build.exact_up_to = exact_up_to;
        EXPECT_TRUE(is_built_at(&moving.scene, 0.5));
        const std::vector<Hit> hits = random_hits(advance(moving.scene, 0.5), 410);
        EXPECT_FALSE(is_built_at(&moving.scene, 0.5));
        EXPECT_TRUE(is_built_at(&moving.scene, 0.6));
        EXPECT_NE(random_hits(advance(moving.scene, 0.6), 410), hits);
        EXPECT_TRUE(is_built_at(&moving.scene, 0.5));
        EXPECT_EQ(random_hits(advance(moving.scene, 0.5), 410), hits);
        for (int frame = 0; frame < 5; ++frame) EXPECT_EQ(is_built_at(&still.scene, 0.1 * frame), frame == 0);
    }
}

// Two triangles that face each other along z, the second one at x = 2; clips may move both.
Scene two_nodes() {
    Scene scene;
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.corners = {{0, 1, 2}};
    const MeshId id = scene.add(std::move(mesh));
    Clip clip{.duration_s = 2.0};
    clip.samplers = {{.interpolation = Interpolation::kStep, .width = 3, .times_s = {0, 1}, .values = {1, 1, 1, 0, 0, 0}}};
    for (int k = 0; k < 2; ++k) {
        Node node{.mesh = id};
        node.local.translation.x = 2.0f * static_cast<float>(k);
        scene.add(std::move(node));
    }
    clip.channels = {{NodeId{0}, ChannelPath::kScale, 0}};
    scene.clips = {clip};
    scene.playback.clips = {ClipId{0}};
    return scene;
}

bool is_seen(const Tlas& tlas, float x) {
    return bool(closest_hit(tlas, {.origin = {x, 0.25f, 5}, .direction = {0, 0, -1}}));
}

// Small triangles between two that hold the mesh's box where it is.
std::vector<glm::vec3> row_at(float x) {
    std::vector<glm::vec3> positions = {{0, 0, 0}, {0.1f, 0, 0}, {0, 0.1f, 0}, {10, 10, 0}, {9.9f, 10, 0}, {10, 9.9f, 0}};
    for (int k = 0; k < 100; ++k) {
        const glm::vec3 at(x + 0.01f * static_cast<float>(k), 5, 0);
        positions.insert(positions.end(), {at, at + glm::vec3(0.02f, 0, 0), at + glm::vec3(0, 0.5f, 0)});
    }
    return positions;
}

TEST(Tlas, PartsFollowAMeshWhoseBoxStays) {
    Scene scene = two_nodes();
    Mesh mesh;
    mesh.positions = row_at(1.0f);
    for (uint32_t k = 0; k < mesh.positions.size(); k += 3) mesh.corners.emplace_back(k, k + 1, k + 2);
    const std::vector<glm::uvec3> corners = mesh.corners;
    const MeshId id = scene.add(std::move(mesh));
    scene.add(Node{.mesh = id});
    for (const float x : {1.0f, 7.0f, 4.0f, 4.0f, 1.0f}) {
        scene.write_mesh(id, row_at(x), {}, corners);
        const Tlas& tlas = advance(scene, 0.5);
        EXPECT_GT(tlas.parts.size(), tlas.instances.size());
        expect_valid(tlas);
        for (const float at : {1.0f, 4.0f, 7.0f}) {
            const Ray ray{.origin = {at + 0.505f, 5.1f, 5}, .direction = {0, 0, -1}};
            EXPECT_EQ(bool(closest_hit(tlas, ray)), at == x) << at << " of " << x;
        }
    }
}

TEST(Tlas, FollowsWhatIsHiddenAndShownAgain) {
    Scene scene = two_nodes();
    const auto warning_count = [&] { return scene.warnings().empty() ? 0 : scene.warnings().begin()->second; };
    for (int round = 0; round < 3; ++round) {
        EXPECT_TRUE(is_built_at(&scene, 0.5));
        const Tlas& shown = advance(scene, 0.5);
        EXPECT_EQ(shown.instances.size(), 2u);
        EXPECT_TRUE(is_seen(shown, 0.25f) && is_seen(shown, 2.25f));
        for (int again = 0; again < 2; ++again) {
            FrameStats stats;
            const Tlas& hidden = advance(scene, 1.5, &stats);
            EXPECT_EQ(hidden.instances.size(), 1u);
            EXPECT_TRUE(!is_seen(hidden, 0.25f) && is_seen(hidden, 2.25f));
            EXPECT_EQ(stats.tlas_builds, again == 0 ? 1u : 0u) << "the second frame is as the first";
            expect_valid(hidden);
            EXPECT_EQ(warning_count(), uint64_t(2 * round + again + 1)) << "one a frame";
        }
    }
}

TEST(Tlas, SeesANodeThatWasMovedByHand) {
    Scene scene = two_nodes();
    EXPECT_TRUE(is_seen(advance(scene, 0.5), 0.25f));
    scene.nodes[0].local.translation.x = 10.0f;  // And no word to the engine.
    EXPECT_TRUE(is_built_at(&scene, 0.5));
    const Tlas& tlas = advance(scene, 0.5);
    EXPECT_TRUE(!is_seen(tlas, 0.25f) && is_seen(tlas, 10.25f));
}

TEST(Tlas, SeesTheSignOfZero) {
    Scene scene = two_nodes();
    EXPECT_FALSE(std::signbit(advance(scene, 0.5)[NodeId{0}].world_from_local.translation.y));
    scene.nodes[0].local.translation.y = -0.0f;
    EXPECT_TRUE(std::signbit(advance(scene, 0.5)[NodeId{0}].world_from_local.translation.y));
}

// However far a frame came before memory ran out, the next one is as if it had not been.
TEST(Tlas, IsMendedAfterAFrameThatThrew) {
    set_thread_count(1);
    for (const uint32_t exact_up_to : {0u, kAlways}) {
        for (const double time_s : {0.5, 1.5}) {  // Node 0 is hidden between 1 and 2.
            bool is_thrown = true;
            for (size_t most = 0; is_thrown; ++most) {
                SCOPED_TRACE(::testing::Message() << "time " << time_s << " s, " << most << " allocations");
                Scene scene = two_nodes();
                scene.tlas_build.exact_up_to = exact_up_to;
                advance(scene, 2.0 - time_s);
                test::fail_allocations_after(most);
                try {
                    advance(scene, time_s);
                    is_thrown = false;
                } catch (const std::bad_alloc&) {
                }
                test::fail_allocations_after(SIZE_MAX);
                EXPECT_TRUE(is_thrown || most > 0) << "nothing was tried";
                const Tlas& tlas = advance(scene, time_s);
                ASSERT_EQ(tlas.instances.size(), time_s < 1.0 ? 2u : 1u);
                expect_valid(tlas);
                EXPECT_EQ(is_seen(tlas, 0.25f), time_s < 1.0);
                EXPECT_TRUE(is_seen(tlas, 2.25f));
            }
        }
    }
    set_thread_count(0);
}

}  // namespace
}  // namespace zoe
