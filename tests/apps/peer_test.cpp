// Embree's frames are the engine's: the same hits, in every configuration, whatever moves.

#include <cmath>
#include <ostream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

#include "apps/bench/compare.h"
#include "apps/bench/judge.h"
#include "apps/bench/peer_embree.h"
#include "apps/common/open_scene.h"
#include "apps/common/usage_error.h"
#include "content/scenes.h"
#include "content/shapes.h"
#include "engine/math/parallel.h"
#include "engine/math/rng.h"

namespace zoe::test {
namespace {

/// Not a multiple of a packet, and more than a task.
constexpr size_t kRayCount = kRaysATask + 1003;

glm::vec3 point_in(const Aabb& box, Rng& rng) {
    return {rng.uniform(box.lo.x, box.hi.x), rng.uniform(box.lo.y, box.hi.y), rng.uniform(box.lo.z, box.hi.z)};
}

/// From in and around the scene to points of it; directions of any length; every fourth ray is cut at both ends.
std::vector<Ray> make_rays(const Aabb& bounds, uint64_t seed) {
    Rng rng(seed);
    const Aabb around{bounds.lo - bounds.extent(), bounds.hi + bounds.extent()};
    std::vector<Ray> rays(kRayCount);
    for (size_t k = 0; k < rays.size(); ++k) {
        Ray& ray = rays[k];
        ray.origin = point_in(k % 2 ? bounds : around, rng);
        ray.direction = rng.uniform(0.1f, 2.0f) * (point_in(bounds, rng) - ray.origin);
        if (k % 4 != 0) continue;
        ray.t_min = rng.uniform(0.0f, 0.5f);
        ray.t_max = ray.t_min + rng.uniform(0.0f, 2.0f);
    }
    return rays;
}

struct Tally {
    size_t hit_count = 0, disagreement_count = 0;
};

/// Where both hit the same triangle at about the same t, they mean the same point of it.
void expect_same_point(const Ray& ray, const Hit& ours, const Hit& peers, const Instance& instance) {
    const glm::uvec3 corners = instance.mesh->corners[ours.primitive];
    const auto place = [&](const Hit& hit) {
        const glm::vec3 local = (1.0f - hit.u - hit.v) * instance.positions[corners.x] +
                                hit.u * instance.positions[corners.y] + hit.v * instance.positions[corners.z];
        return instance.world_from_local.point(local);
    };
    const float size = glm::length(ray.origin) + ours.t * glm::length(ray.direction);
    EXPECT_TRUE(glm::length(place(ours) - place(peers)) <= 1e-3f * size)
        << "(" << ours.u << ", " << ours.v << ") and (" << peers.u << ", " << peers.v << ")";
}

/// Every disagreement must be one that rounding explains, by the oracle; in fast mode Embree may also miss a few triangles
/// near their edges.
void expect_explained(const Tlas& tlas, const std::vector<Disagreement>& found, bool is_robust) {
    const std::vector<Verdict> verdicts = judge(tlas, found);
    size_t leak_count = 0;
    for (size_t k = 0; k < found.size(); ++k) {
        if (verdicts[k] == Verdict::kEither) continue;
        ++leak_count;
        EXPECT_TRUE(!is_robust && verdicts[k] == Verdict::kOurs) << describe(found[k], verdicts[k]);
    }
    EXPECT_LE(leak_count, kRayCount / 1000);
}

void compare_frame(const Tlas& tlas, EmbreePeer* peer, const EmbreeConfig& config, int frame, uint64_t seed, Tally* tally) {
    const std::vector<Ray> rays = make_rays(tlas.bounds(), seed);
    std::vector<Hit> ours(rays.size()), peers(rays.size());
    std::vector<uint8_t> is_hit(rays.size()), is_peer_hit(rays.size());
    closest_hits(tlas, rays, ours);
    any_hits(tlas, rays, is_hit);
    for (const RayKind kind : kRayKinds) {
        for (const EmbreeRays form : forms_of(kind)) {
            SCOPED_TRACE(fmt::format("{} rays, form {}", name(kind), static_cast<int>(form)));
            peer->set_rays(kind, form);
            std::vector<Disagreement> found;
            if (kind == RayKind::kShadow) {
                EXPECT_GE(peer->any_hits(rays, kind, is_peer_hit), 0.0);
                compare_any(frame, kind, rays, is_hit, is_peer_hit, &found);
            } else {
                EXPECT_GE(peer->closest_hits(rays, kind, peers), 0.0);
                compare_closest(frame, kind, rays, ours, peers, &found);
                for (size_t k = 0; k < rays.size(); ++k) {
                    tally->hit_count += bool(ours[k]);
                    if (!ours[k] || ours[k].node != peers[k].node || ours[k].primitive != peers[k].primitive) continue;
                    expect_same_point(rays[k], ours[k], peers[k], tlas[ours[k].node]);
                    // Rays that graze, or begin on a surface: the oracle knows what rounding does to their t.
                    if (!(std::abs(ours[k].t - peers[k].t) <= 1e-4f * ours[k].t)) {
                        found.push_back({frame, kind, k, rays[k], ours[k], peers[k]});
                    }
                }
            }
            expect_explained(tlas, found, config.is_robust);
            tally->disagreement_count += found.size();
            if (testing::Test::HasFailure()) return;
        }
    }
}

/// Plays a scene at the given times beside Embree in every configuration.
void compare_all(Content& content, const std::vector<double>& times_s, uint64_t seed) {
    SCOPED_TRACE(fmt::format("seed {}", seed));
    for (const bool is_robust : {false, true}) {
        const Tlas& first = advance(content, times_s.front(), nullptr);
        Tally tally;
        for (const EmbreeConfig& config : embree_configs(content.scene, first, {is_robust, is_robust})) {
            EmbreePeer peer(config, thread_count());
            for (size_t frame = 0; frame < times_s.size(); ++frame) {
                SCOPED_TRACE(fmt::format("{}, frame {}", config.describe(), frame));
                const Tlas& tlas = advance(content, times_s[frame], nullptr);
                const EmbreePeer::UpdateTimes times = peer.update(content.scene, tlas);
                EXPECT_TRUE(times.update_ms >= 0.0 && times.build_tlas_ms >= 0.0);
                compare_frame(tlas, &peer, config, static_cast<int>(frame), seed + frame, &tally);
                if (testing::Test::HasFailure()) return;
            }
        }
        EXPECT_GT(tally.hit_count, kRayCount / 4) << "rays that hit nothing compare nothing";
        testing::Test::RecordProperty(is_robust ? "robust_disagreements" : "fast_disagreements",
                                      static_cast<int>(tally.disagreement_count));
    }
}

const std::vector<double> kTimes_s = {0.0, 0.3, 0.3, 1.7, 0.1};

class Peer : public testing::Test {
protected:
    void SetUp() override {
        if (!is_embree_available()) GTEST_SKIP() << "built without Embree (Debian: apt-get install libembree-dev)";
    }
    void TearDown() override { set_thread_count(0); }
};

struct Case {
    const char* scene;
    int size;

    friend void PrintTo(const Case& value, std::ostream* out) { *out << value.scene << '-' << value.size; }
};

class PeerScenes : public Peer, public testing::WithParamInterface<Case> {};

TEST_P(PeerScenes, HitsAreTheEngines) {
    Content content = make_content(GetParam().scene, GetParam().size);
    compare_all(content, kTimes_s, 1000);
}

INSTANTIATE_TEST_SUITE_P(All, PeerScenes,
                         testing::Values(Case{"static", 2000}, Case{"rigid", 5}, Case{"instances", 300},
                                         Case{"deforming", 20}, Case{"skinned", 3}, Case{"arbitrary", 500},
                                         Case{"topology", 10}),
                         [](const auto& info) { return std::string(info.param.scene); });

/// All four classes: few of each, which the list's scene of this name has not.
Content small_mixed_scene() {
    Content content;
    add_room(content.scene, 2000);
    add_orbits(content.scene, 4, {.translation = {0.0f, 1.5f, 0.0f}});
    add_wave(content.scene, 20, {0.0f, 0.5f, 0.0f});
    content.write = add_explosion(content.scene, 400, {.translation = {1.0f, 2.0f, 0.0f}});
    return content;
}

TEST_F(Peer, HitsAreTheEnginesWhereAllClassesMeet) {
    Content content = small_mixed_scene();
    compare_all(content, kTimes_s, 2000);
}

TEST_F(Peer, HitsAreTheEnginesOnAnyNumberOfThreads) {
    for (const int threads : {1, 2}) {
        SCOPED_TRACE(threads);
        set_thread_count(threads);
        Content content = small_mixed_scene();
        compare_all(content, {0.0, 0.5}, 3000);
    }
}

/// Scales the node from whole to nothing and back, at once; at time 0 it shows nothing.
void make_vanish(Scene& scene, NodeId node) {
    Sampler sampler{.interpolation = Interpolation::kStep, .width = 3};
    sampler.times_s = {0.0f, 1.0f, 2.0f, 3.0f, 4.0f};
    for (const float scale : {0.0f, 1.0f, 0.0f, 2.0f, 2.0f}) sampler.values.insert(sampler.values.end(), 3, scale);
    add_channel(scene, node, ChannelPath::kScale, add_sampler(scene, sampler));
}

TEST_F(Peer, NodesThatVanishComeBack) {
    Content content;
    Scene& scene = content.scene;
    const MeshId ball = scene.add(make_sphere(1.0f, 12, 8)), box = scene.add(make_box(glm::vec3(-1.0f), glm::vec3(1.0f)));
    scene.add(Node{.mesh = box});
    for (const MeshId mesh : {ball, box}) {
        Node node{.mesh = mesh};
        node.local.translation = {mesh == ball ? 3.0f : -3.0f, 0.0f, 0.5f};
        make_vanish(scene, scene.add(node));
    }
    compare_all(content, {0.5, 1.5, 1.6, 2.5, 3.5, 0.5, 1.5}, 4000);
}

TEST_F(Peer, TrianglesChangeWhileTheyAreNotShown) {
    Content content;
    const MeshId mesh = content.scene.add(make_sphere(1.0f, 12, 8));
    content.scene.add(Node{.mesh = content.scene.add(make_box(glm::vec3(2.0f), glm::vec3(3.0f)))});
    make_vanish(content.scene, content.scene.add(Node{.mesh = mesh}));
    content.write = [mesh](Scene& scene, double time_s) {
        if (time_s != 0.5 && time_s != 2.5) return;
        const Mesh shape = make_sphere(static_cast<float>(time_s), 6 + static_cast<int>(4.0 * time_s), 5);
        scene.write_mesh(mesh, shape.positions, shape.normals, shape.corners);
    };
    compare_all(content, {0.5, 1.5, 2.5, 2.75, 3.5, 0.5, 1.25, 1.75}, 5000);
}

TEST_F(Peer, SequencesShowAnotherMeshEachFrame) {
    Content content;
    Scene& scene = content.scene;
    Node node;
    node.local.translation = {0.5f, 1.0f, 0.0f};
    node.sequence = MeshSequence{.meshes = {}, .fps = 10.0};
    for (const int segments : {3, 40, 8}) node.sequence->meshes.push_back(scene.add(make_sphere(1.0f, segments, 6)));
    scene.add(node);
    scene.add(Node{.mesh = scene.add(make_box(glm::vec3(-1.0f), glm::vec3(0.0f)))});
    compare_all(content, {0.0, 0.1, 0.2, 0.3, 0.4, 0.4, 0.0}, 6000);
}

TEST_F(Peer, AMeshWithoutTrianglesShowsNothingUntilItHasSome) {
    Content content;
    const MeshId mesh = content.scene.add(make_sphere(1.0f, 12, 8));
    content.scene.add(Node{.mesh = mesh});
    content.scene.add(Node{.mesh = content.scene.add(make_box(glm::vec3(2.0f), glm::vec3(3.0f)))});
    content.write = [mesh](Scene& scene, double time_s) {
        const Mesh shape = time_s < 1.0 ? Mesh{} : make_sphere(time_s < 2.0 ? 2.0f : 1.0f, 9, 7);
        scene.write_mesh(mesh, shape.positions, shape.normals, shape.corners);
    };
    compare_all(content, {0.0, 1.0, 2.0, 0.0, 2.0}, 7000);
}

TEST_F(Peer, AStateThatStartsAnewIsTakenUp) {
    Content content = small_mixed_scene();
    const EmbreeConfig config{.is_robust = true};
    EmbreePeer peer(config, thread_count());
    Tally tally;
    for (int frame = 0; frame < 4; ++frame) {
        SCOPED_TRACE(frame);
        if (frame == 2) content.scene.add(Node{.local = {.translation = {1.01f, 0.51f, 0.31f}}, .mesh = MeshId{0}});
        const Tlas& tlas = advance(content, 0.2 * frame, nullptr);
        peer.update(content.scene, tlas);
        compare_frame(tlas, &peer, config, frame, 8000, &tally);
    }
    EXPECT_GT(tally.hit_count, 0u);
}

TEST_F(Peer, LeavesTheEnginesArithmeticAlone) {
#if defined(__SSE2__)
    Content content = small_mixed_scene();
    const Tlas& tlas = advance(content, 0.1, nullptr);
    EmbreePeer peer({}, thread_count());
    peer.update(content.scene, tlas);
    const std::vector<Ray> rays = make_rays(tlas.bounds(), 9000);
    std::vector<Hit> hits(rays.size());
    peer.closest_hits(rays, RayKind::kPrimary, hits);
    std::vector<unsigned> modes(1000);
    parallel_for(0, modes.size(), 1, [&](size_t begin, size_t end) {
        for (size_t k = begin; k < end; ++k) modes[k] = _mm_getcsr();
    });
    constexpr unsigned flush = 1u << 15 | 1u << 6;
    EXPECT_EQ(_mm_getcsr() & flush, 0u);
    for (const unsigned mode : modes) EXPECT_EQ(mode & flush, 0u);
#else
    GTEST_SKIP() << "no such register on this processor";
#endif
}

TEST_F(Peer, RefusesRaysBeforeAFrame) {
    EmbreePeer peer({}, thread_count());
    std::vector<Ray> rays(1);
    std::vector<Hit> hits(1);
    EXPECT_THROW(peer.closest_hits(rays, RayKind::kPrimary, hits), std::logic_error);
}

TEST(PeerConfig, OffersWhatASceneHasUseFor) {
    Content rigid = make_content("rigid", 2), arbitrary = make_content("arbitrary", 100);
    const auto configs = [](Content& content, bool is_two_level = false) {
        const Tlas& tlas = advance(content, 0.0, nullptr);
        return embree_configs(content.scene, tlas, {true, true, is_two_level});
    };
    EXPECT_EQ(configs(rigid).size(), 2u);
    EXPECT_EQ(configs(arbitrary).size(), 4u);
    for (const EmbreeConfig& config : configs(rigid, true)) EXPECT_EQ(config.layout, EmbreeConfig::Layout::kInstances);
    for (const EmbreeConfig& config : configs(arbitrary)) {
        EXPECT_TRUE(config.is_robust);
        // Beside what moves, Embree would build MEDIUM trees and say nothing.
        EXPECT_EQ(config.is_static_high, config.layout == EmbreeConfig::Layout::kInstances);
    }
    Content still = make_content("static", 2000);
    for (const EmbreeConfig& config : configs(still)) EXPECT_TRUE(config.is_static_high);
    Content many = make_content("rigid", 10001);  // of 1,000 triangles each
    ASSERT_EQ(configs(many).size(), 2u);
    for (const EmbreeConfig& config : configs(many)) EXPECT_EQ(config.layout, EmbreeConfig::Layout::kInstances);
}

TEST(PeerConfig, IsNamedInWords) {
    EmbreeConfig config{.layout = EmbreeConfig::Layout::kOneScene};
    EXPECT_EQ(config.describe(),
              "one scene, rigid and deforming REFIT, arbitrary LOW, static MEDIUM, fast; single primary, single diffuse, "
              "single shadow rays");
    config.is_top_medium = config.is_arbitrary_medium = config.is_static_high = config.is_robust = true;
    config.layout = EmbreeConfig::Layout::kInstances;
    config.rays = {EmbreeRays::kCoherentPackets, EmbreeRays::kSingle, EmbreeRays::kPackets};
    EXPECT_EQ(config.describe(),
              "instances under MEDIUM, deforming REFIT, arbitrary MEDIUM, static HIGH, robust; coherent packets of 16 for "
              "primary, single diffuse, packets of 16 for shadow rays");
}

TEST(PeerConfig, WithoutEmbreeThePackageIsNamed) {
    if (is_embree_available()) GTEST_SKIP() << "built with Embree";
    try {
        EmbreePeer peer({}, 1);
        FAIL() << "a peer was made";
    } catch (const UsageError& error) {
        EXPECT_NE(std::string(error.what()).find("libembree-dev"), std::string::npos) << error.what();
    }
}

}  // namespace
}  // namespace zoe::test
