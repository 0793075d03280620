#include "engine/deform/skin.h"

#include <gtest/gtest.h>
#include <glm/matrix.hpp>

#include "tests/bvh/each_target.h"
#include "tests/deform/skin_oracle.h"
#include "tests/support/same_bits.h"

namespace zoe::test {
namespace {

using Points = std::vector<glm::vec3>;

TEST(Skin, HandComputed) {
    // One vertex half way between a joint that moved up and one that turned a quarter about z.
    const Affine up{glm::mat3(1.0f), {0, 2, 0}};
    const Affine turned{glm::mat3(glm::vec3(0, 1, 0), glm::vec3(-1, 0, 0), glm::vec3(0, 0, 1)), {0, 0, 0}};
    const std::vector<Affine> joints = {up, turned};
    const SkinBinding binding{4, {0, 1, 0, 0}, {0.5f, 0.5f, 0, 0}};
    const Points in = {{1, 0, 0}};
    Points out(1);
    skin_positions(binding, joints, in, out);
    EXPECT_EQ(out[0], glm::vec3(0.5f, 1.5f, 0));
}

TEST(Skin, AgreesWithDoubleForFourEightAndTwelveInfluences) {
    const uint64_t seed = 171;
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Rng rng(seed);
    for (const uint32_t influence_count : {4u, 8u, 12u}) {
        for (const size_t vertex_count : {1u, 5u, 10000u}) {
            std::vector<Affine> joints;
            for (int k = 0; k < 100; ++k) joints.push_back(random_affine(rng, 0.5, 2.0, 3.0f));
            const SkinBinding binding = random_binding(rng, vertex_count, influence_count, 100);
            Points in, out(vertex_count);
            for (size_t v = 0; v < vertex_count; ++v) in.push_back(random_point(rng, 2.0f));
            skin_positions(binding, joints, in, out);
            for (size_t v = 0; v < vertex_count; ++v) {
                const DoubleAffine m = blended(binding, joints, v);
                const glm::dvec3 expected = m.linear * glm::dvec3(in[v]) + m.translation;
                for (int k = 0; k < 3; ++k) ASSERT_NEAR(out[v][k], expected[k], 2e-5) << "vertex " << v;
            }
        }
    }
}

TEST(Skin, NormalsFollowTheInverseTransposeUnderNonUniformScaleShearAndMirror) {
    const uint64_t seed = 172;
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Rng rng(seed);
    for (int round = 0; round < 20000; ++round) {
        // Scales 1 : 100 within a joint, mirrored half the time.
        const std::vector<Affine> joints = {random_affine(rng, 0.1, 10.0, 1.0f)};
        const SkinBinding binding{4, {0, 0, 0, 0}, {1, 0, 0, 0}};
        const Points in = {random_direction(rng)};
        Points out(1);
        skin_normals(binding, joints, in, out);
        const glm::dvec3 expected =
            glm::normalize(glm::transpose(glm::inverse(glm::dmat3(joints[0].linear))) * glm::dvec3(in[0]));
        const glm::dvec3 actual = glm::normalize(glm::dvec3(out[0]));
        ASSERT_LT(glm::length(actual - expected), 1e-4) << "round " << round;
    }
}

TEST(Skin, NormalsAreOfTheBlendedMatrix) {
    const uint64_t seed = 173;
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Rng rng(seed);
    std::vector<Affine> joints;
    for (int k = 0; k < 10; ++k) joints.push_back(to_affine(Trs{{}, random_rotation(rng), {1, 2, 3}}));
    const SkinBinding binding = random_binding(rng, 2000, 8, 10);
    Points in, out(2000);
    for (int v = 0; v < 2000; ++v) in.push_back(random_direction(rng));
    skin_normals(binding, joints, in, out);
    int compared = 0;
    for (size_t v = 0; v < in.size(); ++v) {
        const glm::dmat3 m = blended(binding, joints, v).linear;
        if (std::abs(glm::determinant(m)) < 0.1) continue;  // Nearly flattened: no direction to compare.
        const glm::dvec3 expected = glm::normalize(glm::transpose(glm::inverse(m)) * glm::dvec3(in[v]));
        ASSERT_LT(glm::length(glm::normalize(glm::dvec3(out[v])) - expected), 1e-4) << "vertex " << v;
        ++compared;
    }
    EXPECT_GT(compared, 1000);
}

TEST(Skin, ZeroWeightsFollowTheFirstJointOfTheVertex) {
    const std::vector<Affine> joints = {{glm::mat3(1.0f), {10, 0, 0}}, {glm::mat3(1.0f), {0, 20, 0}}};
    const SkinBinding binding{4, {1, 0, 0, 0, 0, 1, 1, 1}, {0, 0, 0, 0, 0, 0, 0, 0}};
    const Points in = {{1, 2, 3}, {1, 2, 3}};
    Points out(2);
    skin_positions(binding, joints, in, out);
    EXPECT_EQ(out[0], glm::vec3(1, 22, 3));
    EXPECT_EQ(out[1], glm::vec3(11, 2, 3));
    skin_normals(binding, joints, in, out);
    EXPECT_EQ(out[0], glm::vec3(1, 2, 3));
}

TEST(Skin, SingularJointsGiveFiniteVerticesAndNormals) {
    const glm::quat still(1, 0, 0, 0);
    const std::vector<Affine> joints = {
        {glm::mat3(0.0f), {4, 5, 6}},              // A point.
        to_affine(Trs{{}, still, {1, 0, 0}}),      // A line.
        to_affine(Trs{{}, still, {1, 1, 0}}),      // A plane.
        to_affine(Trs{{}, still, {1, 1, 1e-30f}})  // Nearly one.
    };
    const Points in(4, glm::vec3(0.6f, 0.0f, 0.8f));
    const SkinBinding binding{
        4, {0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 3, 0, 0, 0}, {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}};
    Points positions(4), normals(4);
    skin_positions(binding, joints, in, positions);
    skin_normals(binding, joints, in, normals);
    EXPECT_EQ(positions[0], glm::vec3(4, 5, 6));
    EXPECT_EQ(positions[1], glm::vec3(0.6f, 0, 0));
    EXPECT_EQ(positions[2], glm::vec3(0.6f, 0, 0));
    for (const glm::vec3& n : normals) EXPECT_TRUE(std::isfinite(n.x) && std::isfinite(n.y) && std::isfinite(n.z));
    EXPECT_EQ(normals[0], glm::vec3(0.0f));
    EXPECT_EQ(normals[1], glm::vec3(0.0f));
    // What is left of a plane faces along its own normal, or nowhere.
    EXPECT_EQ(normals[2].x, 0.0f);
    EXPECT_EQ(normals[2].y, 0.0f);
    EXPECT_GE(normals[2].z, 0.0f);
}

TEST(Skin, OppositeRotationsMayCancelWithoutNan) {
    // Linear blending of a half turn and none collapses onto the axis.
    const std::vector<Affine> joints = {{}, to_affine(Trs{{}, glm::quat(0, 1, 0, 0), glm::vec3(1)})};
    const SkinBinding binding{4, {0, 1, 0, 0}, {0.5f, 0.5f, 0, 0}};
    const Points in = {{1, 2, 3}};
    Points out(1);
    skin_positions(binding, joints, in, out);
    EXPECT_NEAR(out[0].x, 1.0f, 1e-6f);
    EXPECT_NEAR(out[0].y, 0.0f, 1e-6f);
    EXPECT_NEAR(out[0].z, 0.0f, 1e-6f);
    skin_normals(binding, joints, in, out);
    EXPECT_TRUE(std::isfinite(out[0].x + out[0].y + out[0].z));
}

// One vertex, in plain floats: the operations of the kernels in their order.
void skin_one(const SkinBinding& binding, const std::vector<Affine>& joints, size_t vertex, glm::vec3* position,
              glm::vec3* normal) {
    const size_t first = vertex * binding.influence_count;
    Affine m{glm::mat3(0.0f), glm::vec3(0.0f)};
    bool is_weighted = false;
    for (size_t k = first; k < first + binding.influence_count; ++k) {
        if (binding.weights[k] == 0.0f) continue;
        is_weighted = true;
        m.linear += binding.weights[k] * joints[binding.joints[k]].linear;
        m.translation += binding.weights[k] * joints[binding.joints[k]].translation;
    }
    if (!is_weighted) m = joints[binding.joints[first]];
    *position = m.point(*position);
    const glm::mat3 rows = glm::transpose(m.linear);
    const glm::vec3 x = glm::cross(rows[1], rows[2]), y = glm::cross(rows[2], rows[0]), z = glm::cross(rows[0], rows[1]);
    const auto dot = [](const glm::vec3& a, const glm::vec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; };
    const glm::vec3 turned(dot(x, *normal), dot(y, *normal), dot(z, *normal));
    *normal = dot(rows[0], x) < 0.0f ? -turned : turned;
}

TEST(Skin, EveryTargetGivesTheBitsOfPlainFloats) {
    const uint64_t seed = 174;
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Rng rng(seed);
    for (const uint32_t influence_count : {1u, 3u, 4u, 8u}) {
        for (const size_t vertex_count : {1u, 3u, 4u, 15u, 16u, 17u, 63u, 5000u}) {
            std::vector<Affine> joints;
            for (int k = 0; k < 40; ++k) joints.push_back(random_affine(rng, 0.5, 2.0, 3.0f));
            SkinBinding binding = random_binding(rng, vertex_count, influence_count, 40);
            for (uint32_t k = 0; k < influence_count; ++k) binding.weights[k] = 0.0f;  // The first vertex has none.
            Points positions, normals;
            for (size_t v = 0; v < vertex_count; ++v) {
                positions.push_back(random_point(rng, 2.0f));
                normals.push_back(random_direction(rng));
            }
            Points expected_positions = positions, expected_normals = normals;
            for (size_t v = 0; v < vertex_count; ++v) {
                skin_one(binding, joints, v, &expected_positions[v], &expected_normals[v]);
            }
            on_each_target([&] {
                Points out(vertex_count), out_normals(vertex_count);
                skin(binding, packed_linear(joints), positions, normals, out, out_normals);
                EXPECT_TRUE(has_same_bits(out, expected_positions)) << influence_count << " influences, " << vertex_count;
                EXPECT_TRUE(has_same_bits(out_normals, expected_normals))
                    << influence_count << " influences, " << vertex_count;
                // Where they stand, too.
                out = positions;
                out_normals = normals;
                skin(binding, packed_linear(joints), out, out_normals, out, out_normals);
                EXPECT_TRUE(has_same_bits(out, expected_positions) && has_same_bits(out_normals, expected_normals))
                    << "in place";
            });
        }
    }
}

TEST(Skin, AWeightOfZeroHidesAJointThatIsNotFinite) {
    const float infinity = std::numeric_limits<float>::infinity();
    const std::vector<Affine> joints = {{}, {glm::mat3(infinity), {0, 0, 0}}, {glm::mat3(1.0f), {std::nanf(""), 0, 0}}};
    const SkinBinding binding{4, {0, 1, 2, 2, 0, 1, 0, 0}, {1, 0, 0, 0, 0.5f, 0.5f, 0, 0}};
    const Points in = {{1, 2, 3}, {1, 2, 3}};
    Points out(2), normals(2);
    on_each_target([&] {
        skin(binding, packed_linear(joints), in, in, out, normals);
        EXPECT_EQ(out[0], in[0]);
        EXPECT_EQ(normals[0], in[0]);
        EXPECT_FALSE(std::isfinite(out[1].x)) << "its joint is not finite";
    });
}

// In units in the last place of the largest coordinate that a vertex meets on its way.
TEST(Skin, IsWithinUlpsOfTheBoundingBox) {
    const uint64_t seed = 175;
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Rng rng(seed);
    for (const double reach : {1e-3, 1.0, 1e4}) {
        std::vector<Affine> joints;
        for (int k = 0; k < 50; ++k) {
            joints.push_back({glm::mat3_cast(random_rotation(rng)), random_point(rng, static_cast<float>(reach))});
        }
        const SkinBinding binding = random_binding(rng, 20000, 4, 50);
        Points in, out(20000);
        for (size_t v = 0; v < out.size(); ++v) in.push_back(random_point(rng, static_cast<float>(reach)));
        skin_positions(binding, joints, in, out);
        double worst = 0.0;
        for (size_t v = 0; v < out.size(); ++v) {
            const DoubleAffine m = blended(binding, joints, v);
            const glm::dvec3 error = glm::dvec3(out[v]) - (m.linear * glm::dvec3(in[v]) + m.translation);
            for (int k = 0; k < 3; ++k) worst = std::max(worst, std::abs(error[k]));
        }
        const double ulp = reach * 1.1920929e-7;
        EXPECT_LT(worst, 4.0 * ulp) << "reach " << reach << ": " << worst / ulp << " ulps";
        EXPECT_GT(worst, 0.1 * ulp) << "nothing was compared";
    }
}

TEST(Skin, UsedJointsAreThoseThatAVertexFollows) {
    const SkinBinding binding{4, {3, 1, 1, 1, 5, 2, 0, 0}, {0.5f, 0.5f, 0, 0, 0, 0, 0, 0}};
    const std::vector<uint8_t> used = used_joints(binding, 7);
    EXPECT_EQ(used, (std::vector<uint8_t>{0, 1, 0, 1, 0, 1, 0}));
}

}  // namespace
}  // namespace zoe::test
