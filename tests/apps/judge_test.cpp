// Who is right where the engine and a peer disagree: made-up wrong answers, each of which must get its verdict.

#include "apps/bench/judge.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "content/content.h"
#include "engine/frame/trace.h"
#include "engine/math/parallel.h"
#include "engine/math/rng.h"

namespace zoe {

void PrintTo(Verdict verdict, std::ostream* out) {
    *out << name(verdict);
}

namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

/// A square from (0, 0) to (1, 1) of two triangles that meet in the diagonal x = y: 0 where y < x, 1 where y > x.
MeshId add_square(Scene& scene) {
    Mesh square;
    square.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    square.corners = {{0, 1, 2}, {0, 2, 3}};
    square.materials = {{0, 2, kNone<MaterialId>}};
    return scene.add(std::move(square));
}

/// Squares that face +Z, a node each, at these heights; all of one mesh.
Scene squares(const std::vector<float>& heights) {
    Scene scene;
    const MeshId mesh = add_square(scene);
    for (const float z : heights) {
        Node node;
        node.mesh = mesh;
        node.local.translation.z = z;
        scene.add(node);
    }
    return scene;
}

/// Straight down from z = 4, two units of length a step of t.
Ray down(float x, float y) {
    return {.origin = {x, y, 4}, .direction = {0, 0, -2}};
}

Hit at(float t, uint32_t node, uint32_t primitive) {
    return {.t = t, .node = NodeId{node}, .primitive = primitive};
}

Verdict verdict_of(const Tlas& tlas, const Ray& ray, const Hit& ours, const Hit& peers, RayKind kind = RayKind::kPrimary) {
    const Disagreement disagreement{.kind = kind, .ray = ray, .ours = ours, .peers = peers};
    const std::vector<Verdict> verdicts = judge(tlas, {&disagreement, 1});
    EXPECT_EQ(verdicts.size(), 1u);
    return verdicts.at(0);
}

/// Expects that one answer is right and the other not, from whichever side they come.
void expect_wrong(const Tlas& tlas, const Ray& ray, const Hit& right, const Hit& wrong, RayKind kind = RayKind::kPrimary) {
    SCOPED_TRACE(describe({.kind = kind, .ray = ray, .ours = right, .peers = wrong}, Verdict::kOurs));
    EXPECT_EQ(verdict_of(tlas, ray, right, wrong, kind), Verdict::kOurs);
    EXPECT_EQ(verdict_of(tlas, ray, wrong, right, kind), Verdict::kPeers);
    EXPECT_EQ(verdict_of(tlas, ray, wrong, wrong, kind), Verdict::kNeither);
    EXPECT_EQ(verdict_of(tlas, ray, right, right, kind), Verdict::kEither);
}

TEST(Judge, KnowsAWrongAnswerFromARightOne) {
    Scene scene = squares({0, 1});
    const Tlas& tlas = advance(scene, 0);
    const Ray ray = down(0.75f, 0.25f);
    const Hit right = at(1.5f, 1, 0);
    ASSERT_EQ(closest_hit(tlas, ray).t, right.t);
    // The node behind, at its own t and at that of the closest.
    expect_wrong(tlas, ray, right, at(2.0f, 0, 0));
    expect_wrong(tlas, ray, right, at(1.5f, 0, 0));
    // The other primitive, or none of the scene.
    expect_wrong(tlas, ray, right, at(1.5f, 1, 1));
    expect_wrong(tlas, ray, right, at(1.5f, 1, 77));
    expect_wrong(tlas, ray, right, at(1.5f, 77, 0));
    // A miss where there is a sure hit, and a hit where there is none.
    expect_wrong(tlas, ray, right, Hit{});
    expect_wrong(tlas, down(1.5f, 0.5f), Hit{}, right);
    // t off by a thousandth, either way.
    expect_wrong(tlas, ray, right, at(1.5f * 1.001f, 1, 0));
    expect_wrong(tlas, ray, right, at(1.5f * 0.999f, 1, 0));
    // The last bit of t is rounding.
    EXPECT_EQ(verdict_of(tlas, ray, right, at(std::nextafter(1.5f, 2.0f), 1, 0)), Verdict::kEither);
}

TEST(Judge, TakesNoNumberForAnAnswerThatIsNone) {
    Scene scene = squares({0, 1});
    const Tlas& tlas = advance(scene, 0);
    const Ray through = down(0.75f, 0.25f), past = down(1.5f, 0.5f);
    const Hit right = at(1.5f, 1, 0);
    expect_wrong(tlas, through, right, at(kNaN, 1, 0));
    expect_wrong(tlas, through, right, at(std::numeric_limits<float>::infinity(), 1, 0));
    expect_wrong(tlas, through, right, at(-1.5f, 1, 0));
    expect_wrong(tlas, past, Hit{}, Hit{.t = kNaN});
    expect_wrong(tlas, past, Hit{}, Hit{.t = 1.5f});
}

TEST(Judge, RespectsTheEndsOfTheRay) {
    Scene scene = squares({0, 1});
    const Tlas& tlas = advance(scene, 0);
    Ray ray = down(0.75f, 0.25f);
    ray.t_max = 1.25f;
    expect_wrong(tlas, ray, Hit{}, at(1.5f, 1, 0));
    ray.t_max = 3.0f;
    ray.t_min = 1.75f;
    expect_wrong(tlas, ray, at(2.0f, 0, 0), at(1.5f, 1, 0));
    // Ends that lie on the surface: rounding decides, but a hit outside of the ray is none.
    ray.t_min = 1.5f;
    EXPECT_EQ(verdict_of(tlas, ray, at(1.5f, 1, 0), at(2.0f, 0, 0)), Verdict::kEither);
    EXPECT_EQ(verdict_of(tlas, ray, at(std::nextafter(1.5f, 0.0f), 1, 0), at(2.0f, 0, 0)), Verdict::kPeers);
}

TEST(Judge, LetsBothBeRightAtAnEdge) {
    Scene scene = squares({0});
    const Tlas& tlas = advance(scene, 0);
    EXPECT_EQ(verdict_of(tlas, down(0.5f, 0.5f), at(2.0f, 0, 0), at(2.0f, 0, 1)), Verdict::kEither) << "the diagonal";
    EXPECT_EQ(verdict_of(tlas, down(0.75f, 0.0f), at(2.0f, 0, 0), Hit{}), Verdict::kEither) << "the rim";
    EXPECT_EQ(verdict_of(tlas, down(0.75f, 0.001f), at(2.0f, 0, 0), Hit{}), Verdict::kOurs) << "inside of the rim";
    EXPECT_EQ(verdict_of(tlas, down(0.75f, -0.001f), at(2.0f, 0, 0), Hit{}), Verdict::kPeers) << "outside of the rim";
    EXPECT_EQ(verdict_of(tlas, down(0.51f, 0.5f), at(2.0f, 0, 0), at(2.0f, 0, 1)), Verdict::kOurs) << "beside the diagonal";
}

TEST(Judge, LetsBothBeRightOnSurfacesThatLieInEachOther) {
    Scene scene = squares({0, 1, 1, 0.999f});
    const Tlas& tlas = advance(scene, 0);
    const Ray ray = down(0.75f, 0.25f);
    EXPECT_EQ(verdict_of(tlas, ray, at(1.5f, 1, 0), at(1.5f, 2, 0)), Verdict::kEither);
    expect_wrong(tlas, ray, at(1.5f, 2, 0), at(1.5005f, 3, 0));
}

TEST(Judge, AsksOfShadowRaysOnlyWhetherTheyHit) {
    Scene scene = squares({0, 1});
    const Tlas& tlas = advance(scene, 0);
    const Hit hit{.t = 0.0f};
    expect_wrong(tlas, down(0.75f, 0.25f), hit, Hit{}, RayKind::kShadow);
    expect_wrong(tlas, down(0.75f, 0.25f), hit, Hit{.t = kNaN}, RayKind::kShadow);
    expect_wrong(tlas, down(1.5f, 0.25f), Hit{}, hit, RayKind::kShadow);
    EXPECT_EQ(verdict_of(tlas, down(0.75f, 0.0f), hit, Hit{}, RayKind::kShadow), Verdict::kEither);
    Ray cut = down(0.75f, 0.25f);
    cut.t_max = 1.4f;
    expect_wrong(tlas, cut, Hit{}, hit, RayKind::kShadow);
    // Of other kinds a hit has a node.
    expect_wrong(tlas, down(0.75f, 0.25f), at(1.5f, 1, 0), hit, RayKind::kDiffuse);
}

TEST(Judge, PlacesNodesWhereTheirMatricesDo) {
    Scene scene = squares({0});
    // (x, y, z) -> (-2 y + 5, 3 x, 0.5 z - 1): turned, mirrored and scaled.
    scene.nodes[0].matrix = Affine{glm::mat3({0, 3, 0}, {-2, 0, 0}, {0, 0, 0.5f}), {5, 0, -1}};
    const Tlas& tlas = advance(scene, 0);
    expect_wrong(tlas, down(4.5f, 2.25f), at(2.5f, 0, 0), at(2.5f, 0, 1));
    expect_wrong(tlas, down(3.5f, 0.75f), at(2.5f, 0, 1), Hit{});
    expect_wrong(tlas, down(0.75f, 0.25f), Hit{}, at(2.0f, 0, 0));
}

TEST(Judge, HasNothingToSayOfNothing) {
    Scene empty, scene = squares({0});
    EXPECT_TRUE(judge(advance(scene, 0), {}).empty());
    expect_wrong(advance(empty, 0), down(0.75f, 0.25f), Hit{}, at(2.0f, 0, 0));
}

glm::vec3 random_vector(Rng& rng) {
    return {rng.uniform(-1.0f, 1.0f), rng.uniform(-1.0f, 1.0f), rng.uniform(-1.0f, 1.0f)};
}

/// A ray towards the middle of some triangle, from somewhere around it.
Ray random_ray(const Tlas& tlas, Rng& rng) {
    const auto pick = [&](size_t count) {
        return std::min(count - 1, static_cast<size_t>(rng.uniform(0.0f, 1.0f) * static_cast<float>(count)));
    };
    const Instance& instance = tlas.instances[pick(tlas.instances.size())];
    const glm::uvec3& corners = instance.mesh->corners[pick(instance.mesh->corners.size())];
    const glm::vec3 middle = (instance.positions[corners.x] + instance.positions[corners.y] + instance.positions[corners.z]);
    const glm::vec3 target = instance.world_from_local.point(middle / 3.0f);
    const glm::vec3 origin = target + 2.0f * random_vector(rng);
    return {.origin = origin, .direction = rng.uniform(0.2f, 3.0f) * (target - origin)};
}

TEST(Judge, FindsTheEngineRightAndWhatIsMadeUpWrong) {
    constexpr uint64_t kSeed = 71;
    for (const auto& [content_name, size] : std::vector<std::pair<std::string, int>>{{"static", 2000},
                                                                                     {"rigid", 5},
                                                                                     {"instances", 50},
                                                                                     {"deforming", 20},
                                                                                     {"skinned", 2},
                                                                                     {"arbitrary", 500},
                                                                                     {"topology", 12}}) {
        SCOPED_TRACE(content_name + ", seed " + std::to_string(kSeed));
        Content content = make_content(content_name, size);
        if (content.write) content.write(content.scene, 0.7);
        const Tlas& tlas = advance(content.scene, 0.7);
        Rng rng(kSeed);
        std::vector<Disagreement> same, wrong_node, not_a_number, missed;
        for (int i = 0; i < 200; ++i) {
            const Ray ray = random_ray(tlas, rng);
            const Hit ours = closest_hit(tlas, ray);
            same.push_back({.ray = ray, .ours = ours, .peers = ours});
            if (!ours) continue;
            Hit peers = ours;
            peers.node = NodeId{index(ours.node) + 1};
            wrong_node.push_back({.ray = ray, .ours = ours, .peers = peers});
            peers = ours;
            peers.t = kNaN;
            not_a_number.push_back({.ray = ray, .ours = ours, .peers = peers});
            // Well inside of a triangle.
            if (std::min({ours.u, ours.v, 1.0f - ours.u - ours.v}) < 0.05f) continue;
            missed.push_back({.ray = ray, .ours = ours, .peers = Hit{}});
        }
        EXPECT_GT(missed.size(), 50u);
        EXPECT_EQ(judge(tlas, same), std::vector<Verdict>(same.size(), Verdict::kEither));
        EXPECT_EQ(judge(tlas, wrong_node), std::vector<Verdict>(wrong_node.size(), Verdict::kOurs));
        EXPECT_EQ(judge(tlas, not_a_number), std::vector<Verdict>(not_a_number.size(), Verdict::kOurs));
        EXPECT_EQ(judge(tlas, missed), std::vector<Verdict>(missed.size(), Verdict::kOurs));
    }
}

// More triangles than are held at once: those of the first block and of the last are known when a ray is judged.
TEST(Judge, SeesAllOfALargeScene) {
    constexpr int kCopies = 600;
    Scene scene;
    Mesh strip;
    constexpr uint32_t kTriangles = 2000;
    for (uint32_t i = 0; i < kTriangles + 2; ++i) strip.positions.push_back({float(i / 2), float(i % 2), 0.0f});
    for (uint32_t i = 0; i < kTriangles; ++i) strip.corners.push_back({i, i + 1, i + 2});
    strip.materials = {{0, kTriangles, kNone<MaterialId>}};
    const MeshId mesh = scene.add(std::move(strip));
    for (int k = 0; k < kCopies; ++k) {
        Node node;
        node.mesh = mesh;
        node.local.translation.z = -static_cast<float>(k);
        scene.add(node);
    }
    const Tlas& tlas = advance(scene, 0);
    const Ray from_above = down(0.25f, 0.25f), from_below{{0.25f, 0.25f, -float(kCopies)}, {0, 0, 1}};
    const Ray aside{{700.25f, 0.25f, -523.5f}, {0, 0, -1}};  // To a triangle of the middle, counted from its mesh's first.
    const Hit first = at(2.0f, 0, 0), last = at(1.0f, kCopies - 1, 0);
    const std::vector<Disagreement> disagreements = {
        {.ray = from_above, .ours = first, .peers = at(2.0f + 0.5f * (kCopies - 1), kCopies - 1, 0)},
        {.ray = from_below, .ours = at(float(kCopies), 0, 0), .peers = last},
        {.ray = from_below, .ours = last, .peers = Hit{}},
        {.ray = aside, .ours = at(0.5f, 524, 1399), .peers = at(0.5f, 524, 1400)}};
    EXPECT_EQ(judge(tlas, disagreements), (std::vector{Verdict::kOurs, Verdict::kPeers, Verdict::kOurs, Verdict::kPeers}));
}

TEST(Judge, GivesTheSameVerdictsOnAnyNumberOfThreads) {
    Scene scene = squares({0, 1});
    const Tlas& tlas = advance(scene, 0);
    std::vector<Disagreement> disagreements;
    for (int i = 0; i < 100; ++i) {
        const Ray ray = down(0.02f * static_cast<float>(i) - 0.5f, 0.25f);
        disagreements.push_back({.ray = ray, .ours = closest_hit(tlas, ray), .peers = i % 2 ? Hit{} : at(1.5f, 1, 0)});
    }
    set_thread_count(1);
    const std::vector<Verdict> one = judge(tlas, disagreements);
    set_thread_count(3);
    const std::vector<Verdict> three = judge(tlas, disagreements);
    set_thread_count(0);
    EXPECT_EQ(one, three);
    EXPECT_EQ(one[0], Verdict::kOurs) << "a hit beside the squares";
    EXPECT_EQ(one[50], Verdict::kEither) << "the same hit";
    EXPECT_EQ(one[51], Verdict::kOurs) << "a miss";
}

TEST(Judge, SaysInALineWhatItFound) {
    const Ray ray{.origin = {0.1f, -2, 3}, .direction = {0, 0, -1}, .t_min = 0.5f, .t_max = 9};
    const Disagreement closest{
        .frame = 7, .kind = RayKind::kDiffuse, .ray_index = 4242, .ray = ray, .ours = at(1.5f, 3, 14), .peers = Hit{}};
    EXPECT_EQ(
        describe(closest, Verdict::kOurs),
        "frame 7 diffuse ray 4242: origin (0.100000001, -2, 3) direction (0, 0, -1) t [0.5, 9]; ours: node 3 primitive "
        "14 t 1.5; peer's: miss; ours is right, rounding does not explain the peer's");
    const Disagreement shadow{.kind = RayKind::kShadow, .ray = ray, .ours = {.t = kNaN}, .peers = {.t = 0.0f}};
    const std::string line = describe(shadow, Verdict::kPeers);
    EXPECT_NE(line.find("shadow ray 0"), std::string::npos) << line;
    EXPECT_NE(line.find("ours: no node, t nan; peer's: hit; the peer's is right"), std::string::npos) << line;
    EXPECT_NE(describe(shadow, Verdict::kEither).find("either"), std::string::npos);
    EXPECT_NE(describe(shadow, Verdict::kNeither).find("neither"), std::string::npos);
    for (const Verdict verdict : {Verdict::kOurs, Verdict::kPeers, Verdict::kEither, Verdict::kNeither}) {
        EXPECT_EQ(describe(shadow, verdict).find('\n'), std::string::npos);
    }
}

}  // namespace
}  // namespace zoe
