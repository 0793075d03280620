// Dual quaternion skinning against a form in double that is worked out another way: joints are made of a motion and a
// stretch that are known, motions are blended as dual quaternions multiplied out by hand.

#include <array>

#include <gtest/gtest.h>
#include <glm/ext/quaternion_double.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/matrix.hpp>

#include "tests/bvh/each_target.h"
#include "tests/deform/skin_oracle.h"
#include "tests/support/same_bits.h"

namespace zoe::test {
namespace {

using Points = std::vector<glm::vec3>;

/// p -> common * (translation + rotation * (centre + stretch * (p - centre)))
struct Joint {
    glm::dquat rotation{1, 0, 0, 0};
    glm::dvec3 translation{0.0}, centre{0.0};
    glm::dmat3 stretch{1.0};

    Affine matrix(double common) const {
        const glm::dmat3 turn = glm::mat3_cast(rotation);
        const glm::dvec3 moved = translation + turn * (centre - stretch * centre);
        return {glm::mat3(common * (turn * stretch)), glm::vec3(common * moved)};
    }
};

struct Pose {
    std::vector<Joint> joints;
    double common = 1.0;

    std::vector<Affine> matrices() const {
        std::vector<Affine> out;
        for (const Joint& joint : joints) out.push_back(joint.matrix(common));
        return out;
    }
    PackedJoints packed() const {
        Points centres;
        for (const Joint& joint : joints) centres.emplace_back(joint.centre);
        PackedJoints packed;
        pack_joints_dual(matrices(), centres, std::vector<uint8_t>(joints.size(), 1), &packed);
        return packed;
    }
};

struct Moved {
    glm::dvec3 position, normal;
};

Moved expected_of(const Pose& pose, const SkinBinding& binding, size_t vertex, const glm::dvec3& position,
                  const glm::dvec3& normal) {
    const size_t first = vertex * binding.influence_count, end = first + binding.influence_count;
    size_t pivot = first;
    double weight_sum = 0.0;
    for (size_t k = first; k < end; ++k) {
        if (std::abs(binding.weights[k]) > std::abs(binding.weights[pivot])) pivot = k;
        weight_sum += binding.weights[k];
    }
    const auto joint_at = [&](size_t k) -> const Joint& { return pose.joints[binding.joints[k]]; };
    glm::dquat real(0, 0, 0, 0), dual(0, 0, 0, 0);
    glm::dmat3 stretch(0.0);
    glm::dvec3 offset(0.0);
    const bool is_weightless = binding.weights[pivot] == 0.0f;
    for (size_t k = first; k < end; ++k) {
        const double weight = is_weightless ? (k == first ? 1.0 : 0.0) : double(binding.weights[k]);
        const Joint& joint = joint_at(k);
        const double sign = glm::dot(joint.rotation, joint_at(pivot).rotation) < 0.0 ? -1.0 : 1.0;
        const glm::dvec3& t = joint.translation;
        real += weight * sign * joint.rotation;
        dual += weight * sign * (0.5 * (glm::dquat(0.0, t.x, t.y, t.z) * joint.rotation));
        const double share = is_weightless ? weight : weight / weight_sum;
        stretch += share * joint.stretch;
        offset += share * (joint.centre - joint.stretch * joint.centre);
    }
    const double length = glm::length(real);
    const glm::dquat unit = real / length, moved = 2.0 * ((dual / length) * glm::conjugate(unit));
    const glm::dvec3 stretched = stretch * position + offset;
    const glm::dmat3 turn = glm::mat3_cast(unit);
    glm::dvec3 turned = turn * (glm::transpose(glm::inverse(stretch)) * normal);
    if (pose.common < 0.0) turned = -turned;
    return {pose.common * (turn * stretched + glm::dvec3(moved.x, moved.y, moved.z)), glm::normalize(turned)};
}

glm::dquat unit_quaternion(Rng& rng) {
    return glm::normalize(glm::dquat(random_rotation(rng)));
}

enum class Scales { kNone, kStretched, kMirrored };

Pose random_pose(Rng& rng, int joint_count, double common, Scales scales) {
    Pose pose{.joints = {}, .common = common};
    for (int k = 0; k < joint_count; ++k) {
        Joint& joint = pose.joints.emplace_back();
        joint.rotation = unit_quaternion(rng);
        joint.translation = glm::dvec3(random_point(rng, 2.0f));
        joint.centre = glm::dvec3(random_point(rng, 1.0f));
        // A third of them: what most have in common is no stretch.
        if (scales == Scales::kNone || 3 * k >= joint_count) continue;
        const glm::dmat3 axes = glm::mat3_cast(unit_quaternion(rng));
        glm::dmat3 extents(0.0);
        for (int axis = 0; axis < 3; ++axis) extents[axis][axis] = log_uniform(rng, 0.5, 2.0);
        joint.stretch = axes * extents * glm::transpose(axes);
        if (scales == Scales::kMirrored) joint.stretch = -joint.stretch;
    }
    return pose;
}

// Mirrored stretches blend to singular ones: there, a normal has no direction to compare.
void expect_as_in_double(const Pose& pose, const SkinBinding& binding, double bound, double normal_bound) {
    Rng rng(191);
    Points in, normals;
    const size_t count = binding.joints.size() / binding.influence_count;
    for (size_t v = 0; v < count; ++v) {
        in.push_back(random_point(rng, 2.0f));
        normals.push_back(random_direction(rng));
    }
    const PackedJoints packed = pose.packed();
    Points first;
    on_each_target([&] {
        Points out(count), out_normals(count);
        skin(binding, packed, in, normals, out, out_normals);
        for (size_t v = 0; v < count; ++v) {
            const Moved expected = expected_of(pose, binding, v, glm::dvec3(in[v]), glm::dvec3(normals[v]));
            for (int k = 0; k < 3; ++k) {
                ASSERT_NEAR(out[v][k], expected.position[k], bound * std::abs(pose.common)) << "vertex " << v;
            }
            if (normal_bound > 0.0) {
                const glm::dvec3 normal = glm::normalize(glm::dvec3(out_normals[v]));
                ASSERT_LT(glm::length(normal - expected.normal), normal_bound) << "vertex " << v;
            }
        }
        if (first.empty()) first = out;
        EXPECT_TRUE(has_same_bits(first, out)) << "the bits differ";
    });
}

TEST(DualQuaternionSkin, AgreesWithDouble) {
    const uint64_t seed = 192;
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Rng rng(seed);
    for (const uint32_t influence_count : {1u, 4u, 8u}) {
        for (const double common : {1.0, -1.0, 0.01, -250.0}) {
            SCOPED_TRACE(::testing::Message() << influence_count << " influences, scale " << common);
            const SkinBinding binding = random_binding(rng, 3001, influence_count, 30);
            const Pose rigid = random_pose(rng, 30, common, Scales::kNone);
            EXPECT_TRUE(rigid.packed().affines.empty()) << "no joint stretches";
            expect_as_in_double(rigid, binding, 2e-5, 1e-5);
            expect_as_in_double(random_pose(rng, 30, common, Scales::kStretched), binding, 1e-4, 1e-4);
            expect_as_in_double(random_pose(rng, 30, common, Scales::kMirrored), binding, 2e-4, 0.0);
        }
    }
}

// In units in the last place of the largest coordinate.
TEST(DualQuaternionSkin, IsWithinUlpsOfTheBoundingBox) {
    const uint64_t seed = 193;
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Rng rng(seed);
    for (const double reach : {1e-3, 1.0, 1e4}) {
        Pose pose;
        for (int k = 0; k < 20; ++k) {
            pose.joints.push_back(
                {.rotation = unit_quaternion(rng), .translation = reach * glm::dvec3(random_point(rng, 1.0f))});
        }
        const SkinBinding binding = random_binding(rng, 20000, 4, 20);
        Points in, out(20000);
        for (size_t v = 0; v < out.size(); ++v) in.push_back(random_point(rng, static_cast<float>(reach)));
        skin(binding, pose.packed(), in, {}, out, {});
        double worst = 0.0;
        for (size_t v = 0; v < out.size(); ++v) {
            const glm::dvec3 error =
                glm::dvec3(out[v]) - expected_of(pose, binding, v, glm::dvec3(in[v]), glm::dvec3(1.0)).position;
            for (int k = 0; k < 3; ++k) worst = std::max(worst, std::abs(error[k]));
        }
        const double ulp = reach * 1.1920929e-7;
        // Three times as far as linear blending: a sum near the opposite one is a short sum of long terms.
        EXPECT_LT(worst, 12.0 * ulp) << "reach " << reach << ": " << worst / ulp << " ulps";
        EXPECT_GT(worst, 0.1 * ulp) << "nothing was compared";
    }
}

// What linear blending loses: points keep their distance from the axis that two joints turn about.
TEST(DualQuaternionSkin, KeepsTheRadiusOfATwist) {
    for (const double degrees : {10.0, 90.0, 150.0, 179.0, 180.0}) {
        Pose pose;
        pose.joints.resize(2);
        pose.joints[1].rotation = glm::angleAxis(glm::radians(degrees), glm::dvec3(0, 1, 0));
        for (const float share : {0.0f, 0.25f, 0.5f, 0.75f, 1.0f}) {
            const SkinBinding binding{4, {0, 1, 0, 0}, {1.0f - share, share, 0, 0}};
            Points out(1);
            skin(binding, pose.packed(), Points{{0.6f, 0.3f, 0.8f}}, {}, out, {});
            EXPECT_NEAR(std::hypot(out[0].x, out[0].z), 1.0f, 1e-5f) << degrees << " degrees, " << share;
            EXPECT_NEAR(out[0].y, 0.3f, 1e-6f);
        }
    }
}

// q and -q are the same motion: the sum must not care which of them a joint's matrix gave.
TEST(DualQuaternionSkin, GoesTheShortWayRound) {
    for (int step = 0; step <= 36; ++step) {
        Pose pose;
        pose.joints.resize(2);
        const double angle = glm::radians(10.0 * step), apart = glm::radians(20.0);
        pose.joints[0].rotation = glm::angleAxis(angle, glm::dvec3(0, 0, 1));
        pose.joints[1].rotation = glm::angleAxis(angle + apart, glm::dvec3(0, 0, 1));
        const SkinBinding binding{2, {0, 1}, {0.5f, 0.5f}};
        Points out(1);
        skin(binding, pose.packed(), Points{{1, 0, 0}}, {}, out, {});
        EXPECT_NEAR(out[0].x, std::cos(angle + 0.5 * apart), 1e-6) << "step " << step;
        EXPECT_NEAR(out[0].y, std::sin(angle + 0.5 * apart), 1e-6) << "step " << step;
    }
}

TEST(DualQuaternionSkin, WeightsOfAnySumAndNoneAtAll) {
    Pose pose;
    pose.joints.resize(3);
    pose.joints[1].rotation = glm::angleAxis(1.0, glm::normalize(glm::dvec3(1, 2, 3)));
    pose.joints[1].translation = {1, 0, 0};
    pose.joints[1].centre = {0, 1, 0};
    pose.joints[1].stretch = glm::dmat3(2, 0, 0, 0, 2, 0, 0, 0, 1);
    const Points in(5, {0.3f, -0.4f, 0.5f});
    // Sums of 1, 2 and 0.01; no weight, which means the first joint; weights that cancel, which means the heaviest.
    const SkinBinding binding{
        2, {0, 1, 0, 1, 0, 1, 1, 0, 0, 2}, {0.25f, 0.75f, 0.5f, 1.5f, 0.0025f, 0.0075f, 0, 0, 0.5f, -0.5f}};
    Points out(5);
    on_each_target([&] {
        skin(binding, pose.packed(), in, {}, out, {});
        for (int k = 0; k < 3; ++k) {
            EXPECT_NEAR(out[1][k], out[0][k], 1e-6f);
            EXPECT_NEAR(out[2][k], out[0][k], 1e-6f);
            EXPECT_NEAR(out[3][k], pose.matrices()[1].point(in[3])[k], 1e-6f);
            EXPECT_TRUE(std::isfinite(out[4][k]));
        }
    });
    expect_as_in_double(pose, {2, {0, 1, 1, 2, 1, 0}, {0.5f, 1.5f, 0, 0, 0.001f, 0.002f}}, 1e-5, 1e-5);
}

TEST(DualQuaternionSkin, JointsWithoutSizeGiveFiniteVertices) {
    Pose pose;
    pose.joints.resize(5);
    pose.joints[1].stretch = glm::dmat3(0.0);                        // A point.
    pose.joints[2].stretch = glm::dmat3(1, 0, 0, 0, 0, 0, 0, 0, 0);  // A line.
    pose.joints[3].stretch = glm::dmat3(1, 0, 0, 0, 1, 0, 0, 0, 0);  // A plane.
    pose.joints[1].centre = {1, 2, 3};
    pose.joints[3].rotation = glm::angleAxis(0.5, glm::dvec3(0, 0, 1));
    const Points in(6, {0.6f, 0.1f, 0.8f});
    const SkinBinding binding{2, {0, 1, 1, 0, 2, 0, 3, 0, 1, 0, 3, 0}, {1, 0, 1, 0, 1, 0, 1, 0, 0.5f, 0.5f, 0.5f, 0.5f}};
    Points out(6), normals(6);
    skin(binding, pose.packed(), in, in, out, normals);
    for (size_t v = 0; v < in.size(); ++v) EXPECT_TRUE(is_finite(out[v]) && is_finite(normals[v])) << v;
    EXPECT_EQ(out[0], in[0]);
    EXPECT_EQ(out[1], glm::vec3(1, 2, 3));
    EXPECT_EQ(out[2], glm::vec3(0.6f, 0, 0));
    EXPECT_NEAR(out[3].z, 0.0f, 1e-7f);
    EXPECT_NEAR(out[4].x, 0.8f, 1e-6f) << "half way to the point";
    // All of them: a figure that is scaled away.
    for (Joint& joint : pose.joints) joint.stretch = glm::dmat3(0.0);
    skin(binding, pose.packed(), in, in, out, normals);
    for (size_t v = 0; v < in.size(); ++v) EXPECT_TRUE(is_finite(out[v]) && is_finite(normals[v])) << v;
}

// A figure that is scaled or mirrored as a whole is the same figure, scaled or mirrored.
TEST(DualQuaternionSkin, AWholeSkeletonMayBeScaledAndMirrored) {
    const uint64_t seed = 194;
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Rng rng(seed);
    const Pose pose = random_pose(rng, 12, 1.0, Scales::kNone);
    const SkinBinding binding = random_binding(rng, 1000, 4, 12);
    Points in, plain(1000);
    for (size_t v = 0; v < plain.size(); ++v) in.push_back(random_point(rng, 1.0f));
    skin(binding, pose.packed(), in, {}, plain, {});
    const std::array maps = {glm::dmat3(-1, 0, 0, 0, 1, 0, 0, 0, 1), glm::dmat3(0.01),
                             glm::dmat3(0, -3, 0, 3, 0, 0, 0, 0, -3)};
    for (const glm::dmat3& map : maps) {
        std::vector<Affine> matrices = pose.matrices();
        Points centres;
        for (const Joint& joint : pose.joints) centres.emplace_back(joint.centre);
        for (Affine& m : matrices) {
            m = {glm::mat3(map * glm::dmat3(m.linear)), glm::vec3(map * glm::dvec3(m.translation))};
        }
        PackedJoints packed;
        pack_joints_dual(matrices, centres, std::vector<uint8_t>(12, 1), &packed);
        EXPECT_TRUE(packed.affines.empty());
        Points out(1000);
        skin(binding, packed, in, {}, out, {});
        const double size = std::cbrt(std::abs(glm::determinant(map)));
        for (size_t v = 0; v < out.size(); ++v) {
            ASSERT_LT(glm::length(glm::dvec3(out[v]) - map * glm::dvec3(plain[v])), 3e-5 * size) << "vertex " << v;
        }
    }
}

TEST(DualQuaternionSkin, AWeightOfZeroHidesAJointThatIsNotFinite) {
    std::vector<Affine> joints(2);
    joints[1].translation.x = std::nanf("");
    PackedJoints packed;
    pack_joints_dual(joints, Points(2, glm::vec3(0.0f)), std::vector<uint8_t>{1, 1}, &packed);
    const SkinBinding binding{2, {0, 1, 0, 1, 1, 0}, {1, 0, 0.5f, 0.5f, 0, 1}};
    const Points in(3, {1, 2, 3});
    Points out(3);
    on_each_target([&] {
        skin(binding, packed, in, {}, out, {});
        EXPECT_EQ(out[0], in[0]);
        EXPECT_EQ(out[2], in[2]);
        EXPECT_TRUE(std::isnan(out[1].x)) << "its joint is not finite";
    });
}

// Scales that are worlds apart: a vertex is where its joint takes it or nowhere, and the latter only where a joint that it
// follows overflows against the common scale.
TEST(DualQuaternionSkin, JointsThatOverflowTakeTheirOwnVerticesOnly) {
    const uint64_t seed = 195;
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Rng rng(seed);
    const std::array scales = {1e-30, 1e-3, 1.0, 1e8, 1e38};
    size_t lost_count = 0, spared_count = 0;
    for (int round = 0; round < 200; ++round) {
        const size_t joint_count = 2 + rng.below(3);
        std::vector<Affine> joints;
        std::vector<double> sizes;
        Points centres;
        for (size_t k = 0; k < joint_count; ++k) {
            sizes.push_back(scales[rng.below(scales.size())]);
            const auto scale = static_cast<float>(rng.below(4) == 0 ? -sizes[k] : sizes[k]);
            joints.push_back({scale * glm::mat3_cast(random_rotation(rng)), random_point(rng, std::abs(scale))});
            centres.push_back(random_point(rng, 1.0f));
        }
        PackedJoints packed;
        pack_joints_dual(joints, centres, std::vector<uint8_t>(joint_count, 1), &packed);
        const double common = std::abs(double(packed.common_scale));
        SkinBinding binding{2, {}, {}};
        Points in;
        for (uint16_t a = 0; a < joint_count; ++a) {
            for (uint16_t b = 0; b < joint_count; ++b) {
                binding.joints.insert(binding.joints.end(), {a, b, a, b});
                binding.weights.insert(binding.weights.end(), {1.0f, 0.0f, 0.75f, 0.25f});
                in.insert(in.end(), 2, random_point(rng, 0.5f));
            }
        }
        on_each_target([&] {
            Points out(in.size()), normals(in.size());
            skin(binding, packed, in, in, out, normals);
            for (size_t v = 0; v < in.size(); ++v) {
                const size_t a = binding.joints[2 * v], b = binding.joints[2 * v + 1];
                const bool is_of_both = v % 2 != 0;
                const double largest = is_of_both ? std::max(sizes[a], sizes[b]) : sizes[a];
                const bool may_be_lost = largest / common > 1e37;
                EXPECT_TRUE(may_be_lost || is_finite(out[v])) << "round " << round << " vertex " << v;
                lost_count += !is_finite(out[v]);
                spared_count += is_finite(out[v]) && !packed.is_finite;
                if (is_of_both || !is_finite(out[v])) continue;
                const glm::dvec3 expected =
                    glm::dmat3(joints[a].linear) * glm::dvec3(in[v]) + glm::dvec3(joints[a].translation);
                EXPECT_LT(glm::distance(glm::dvec3(out[v]), expected), 2e-5 * (common + sizes[a])) << "round " << round;
            }
        });
    }
    EXPECT_GT(lost_count, 100u);
    EXPECT_GT(spared_count, 1000u);
}

TEST(DualQuaternionSkin, CentresAreWhereBindMatricesPutTheirJoints) {
    const Affine inverse_bind = to_affine(Trs{{1, 2, 3}, glm::quat(0.5f, 0.5f, 0.5f, 0.5f), glm::vec3(2.0f)});
    const std::vector<glm::vec3> centres = joint_centres(std::vector<Affine>{inverse_bind, {glm::mat3(0.0f), {1, 1, 1}}});
    const glm::vec3 zero = inverse_bind.point(centres[0]);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(zero[k], 0.0f, 1e-6f);
    EXPECT_EQ(centres[1], glm::vec3(0.0f)) << "without an inverse";
}

}  // namespace
}  // namespace zoe::test
