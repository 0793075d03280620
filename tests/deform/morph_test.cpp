#include "engine/deform/morph.h"

#include <gtest/gtest.h>
#include <glm/ext/vector_double3.hpp>

#include "tests/math/random_inputs.h"

namespace zoe::test {
namespace {

using Points = std::vector<glm::vec3>;

Points random_points(Rng& rng, size_t count) {
    Points points;
    for (size_t k = 0; k < count; ++k) points.push_back(random_point(rng, 1.0f));
    return points;
}

TEST(Morph, HandComputed) {
    const Points base = {{1, 2, 3}, {0, 0, 0}};
    const std::vector<MorphTarget> targets = {{{{1, 0, 0}, {0, 1, 0}}, {}}, {{{0, 0, 4}, {4, 0, 0}}, {}}};
    Points out(2);
    morph_positions(base, targets, std::vector<float>{0.5f, 0.25f}, out);
    EXPECT_EQ(out[0], glm::vec3(1.5f, 2, 4));
    EXPECT_EQ(out[1], glm::vec3(1, 0.5f, 0));
}

TEST(Morph, MissingAndZeroWeightsAndEmptyTargetsAddNothing) {
    Rng rng(161);
    const Points base = random_points(rng, 50), a = random_points(rng, 50);
    std::vector<MorphTarget> targets = {{a, {}}, {{}, a}, {a, a}};
    Points out(50);
    morph_positions(base, targets, {}, out);
    EXPECT_EQ(out, base);
    morph_positions(base, targets, std::vector<float>{0, 0, 0}, out);
    EXPECT_EQ(out, base);
    morph_positions(base, {}, {}, out);
    EXPECT_EQ(out, base);
    morph_positions(base, targets, std::vector<float>{0, 1}, out);
    EXPECT_EQ(out, base) << "target 1 has normals only; target 2's weight is missing";
    morph_normals(base, targets, std::vector<float>{1, 0, 0}, out);
    EXPECT_EQ(out, base) << "target 0 has positions only";
    // A weight of 0 hides even offsets that are not finite.
    targets[0].positions[3].x = std::nanf("");
    morph_positions(base, targets, std::vector<float>{0, 1, 0}, out);
    EXPECT_EQ(out, base);
}

TEST(Morph, MoreWeightsThanTargetsAreNotRead) {
    const Points base = {{1, 1, 1}};
    Points out(1);
    morph_positions(base, {}, std::vector<float>{5, 6}, out);
    EXPECT_EQ(out, base);
}

TEST(Morph, NothingToDoIsFine) {
    morph_positions({}, {}, {}, {});
    morph_normals({}, std::vector<MorphTarget>(3), std::vector<float>{1, 1, 1}, {});
}

TEST(Morph, ReachIsWhatOffsetsMove) {
    std::vector<glm::vec3> offsets(100, glm::vec3(0.0f));
    for (const size_t v : {10u, 11u, 15u, 60u, 99u}) offsets[v].y = 1.0f;
    std::vector<glm::vec3> other(100, glm::vec3(0.0f));
    other[13].x = std::nanf("");
    other[70].z = -1.0f;
    const MorphReach reach = find_reach(std::vector<MorphTarget>{{offsets, {}}, {other, offsets}, {{}, {}}});
    using Ranges = std::vector<VertexRange>;
    EXPECT_EQ(reach.positions.by_target, (std::vector<Ranges>{{{10, 16}, {60, 61}, {99, 100}}, {{13, 14}, {70, 71}}, {}}));
    EXPECT_EQ(reach.positions.by_any, (Ranges{{10, 16}, {60, 61}, {70, 71}, {99, 100}}));
    EXPECT_EQ(reach.normals.by_target, (std::vector<Ranges>{{}, {{10, 16}, {60, 61}, {99, 100}}, {}}));
}

TEST(Morph, WithItsReachItGivesTheSameAndTouchesNothingElse) {
    const uint64_t seed = 163;
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Rng rng(seed);
    for (const size_t vertex_count : {1u, 50u, 3000u, 20000u}) {
        for (int round = 0; round < 20; ++round) {
            const Points base = random_points(rng, vertex_count);
            std::vector<MorphTarget> targets(1 + rng.below(6));
            std::vector<float> weights;
            for (MorphTarget& target : targets) {
                weights.push_back(rng.below(3) == 0 ? 0.0f : rng.uniform(-1.0f, 1.0f));
                if (rng.below(6) == 0) continue;
                target.positions.assign(vertex_count, glm::vec3(0.0f));
                const size_t first = rng.below(static_cast<uint32_t>(vertex_count));
                const size_t last = first + rng.below(static_cast<uint32_t>(vertex_count - first)) / 4;
                for (size_t v = first; v <= last; ++v) target.positions[v] = random_point(rng, 1.0f);
                target.normals = target.positions;
            }
            const MorphReach reach = find_reach(targets);
            std::vector<uint8_t> is_reached(vertex_count, 0);
            for (const VertexRange& r : reach.positions.by_any) {
                for (uint32_t v = r.begin; v < r.end; ++v) is_reached[v] = 1;
            }
            Points dense(vertex_count), sparse = base;
            // What was left there before, a morph replaces.
            for (size_t v = 0; v < vertex_count; ++v) {
                if (is_reached[v]) sparse[v] = glm::vec3(1e9f);
            }
            morph_positions(base, targets, weights, dense);
            morph_positions(base, targets, reach, weights, sparse);
            EXPECT_EQ(sparse, dense) << vertex_count << " vertices, round " << round;
            Points normals = base;
            morph_normals(base, targets, reach, weights, normals);
            EXPECT_EQ(normals, dense) << vertex_count << " vertices, round " << round;
            // Nothing else is written.
            Points marked(vertex_count, glm::vec3(7.0f));
            morph_positions(base, targets, reach, weights, marked);
            for (size_t v = 0; v < vertex_count; ++v) {
                if (!is_reached[v]) {
                    ASSERT_EQ(marked[v], glm::vec3(7.0f)) << "vertex " << v;
                }
            }
        }
    }
}

TEST(Morph, AgreesWithDoubleForAnyNumberOfTargets) {
    const uint64_t seed = 162;
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Rng rng(seed);
    for (const size_t target_count : {1u, 2u, 8u, 9u, 40u, 200u}) {
        for (const size_t vertex_count : {1u, 7u, 1000u, 20000u}) {
            if (target_count * vertex_count > 1000000) continue;
            const Points base = random_points(rng, vertex_count);
            std::vector<MorphTarget> targets(target_count);
            std::vector<float> weights;
            for (MorphTarget& target : targets) {
                if (rng.below(5) > 0) target.positions = random_points(rng, vertex_count);
                if (rng.below(5) > 0) target.normals = random_points(rng, vertex_count);
                weights.push_back(rng.below(4) == 0 ? 0.0f : rng.uniform(-1.0f, 2.0f));
            }
            Points positions(vertex_count), normals(vertex_count);
            morph_positions(base, targets, weights, positions);
            morph_normals(base, targets, weights, normals);
            for (size_t v = 0; v < vertex_count; ++v) {
                glm::dvec3 p(base[v]), n(base[v]);
                for (size_t k = 0; k < target_count; ++k) {
                    if (!targets[k].positions.empty()) p += double{weights[k]} * glm::dvec3(targets[k].positions[v]);
                    if (!targets[k].normals.empty()) n += double{weights[k]} * glm::dvec3(targets[k].normals[v]);
                }
                const double bound = 1e-7 * double(target_count + 1) * double(target_count + 1);
                for (int k = 0; k < 3; ++k) {
                    ASSERT_NEAR(positions[v][k], p[k], bound) << target_count << " targets, vertex " << v;
                    ASSERT_NEAR(normals[v][k], n[k], bound) << target_count << " targets, vertex " << v;
                }
            }
        }
    }
}

}  // namespace
}  // namespace zoe::test
