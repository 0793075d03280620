// Skinned normals against finite differences of the skinned surface.
//
// A skin moves a point by a map that its weights blend, and a normal by that map as if the weights were the same all around.
// Along a tangent t the surface goes J t = M t + E t, of which E is what the change of weights adds. The normal n is at
// right angles to M t, so against the surface's own plane it leans by an angle whose sine is at most |E| over the least
// stretch of J. Where weights do not change, E is 0 and only the differences' own errors are left.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>
#include <glm/ext/quaternion_double.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/matrix.hpp>

#include "tests/deform/skin_oracle.h"

namespace zoe::test {
namespace {

constexpr size_t kJoints = 4;
constexpr double kUlp = 1.1920929e-7;
using Weights = std::array<double, kJoints>;

struct Rig {
    Skinning skinning;
    std::vector<Affine> joints;
    std::vector<glm::dvec3> places;  // Where each joint has most weight.
    double spread;                   // Of the weights; infinite: they are the same everywhere.
    double reach = 0.0;              // No coordinate that is met on the way is larger.

    Weights weights(const glm::dvec3& p) const {
        Weights weights;
        double sum = 0.0;
        for (size_t k = 0; k < kJoints; ++k) {
            const glm::dvec3 apart = (p - places[k]) / spread;
            sum += weights[k] = std::exp(-glm::dot(apart, apart));
        }
        for (double& weight : weights) weight /= sum;
        return weights;
    }

    glm::dvec3 move(const glm::dvec3& p, const Weights& weights) const {
        if (skinning == Skinning::kLinearBlend) {
            glm::dvec3 sum(0.0);
            for (size_t k = 0; k < kJoints; ++k) {
                sum += weights[k] * (glm::dmat3(joints[k].linear) * p + glm::dvec3(joints[k].translation));
            }
            return sum;
        }
        const size_t pivot = std::max_element(weights.begin(), weights.end()) - weights.begin();
        glm::dquat real(0, 0, 0, 0), dual(0, 0, 0, 0);
        for (size_t k = 0; k < kJoints; ++k) {
            const glm::dquat turn = glm::quat_cast(glm::dmat3(joints[k].linear));
            const glm::dvec3 t(joints[k].translation);
            const double sign = glm::dot(turn, glm::quat_cast(glm::dmat3(joints[pivot].linear))) < 0.0 ? -1.0 : 1.0;
            real += weights[k] * sign * turn;
            dual += weights[k] * sign * 0.5 * (glm::dquat(0.0, t.x, t.y, t.z) * turn);
        }
        const double length = glm::length(real);
        const glm::dquat moved = 2.0 * ((dual / length) * glm::conjugate(real / length));
        return glm::mat3_cast(real / length) * p + glm::dvec3(moved.x, moved.y, moved.z);
    }
};

Rig random_rig(Rng& rng, Skinning skinning, double spread) {
    Rig rig{.skinning = skinning, .joints = {}, .places = {}, .spread = spread};
    for (size_t k = 0; k < kJoints; ++k) {
        // Turned by a third of a circle at most: farther apart, linear blends flatten, and no angle is left to compare.
        const auto axis = glm::dvec3(random_direction(rng));
        const glm::dmat3 turn = glm::mat3_cast(glm::angleAxis(double(rng.uniform(-1.0f, 1.0f)), axis));
        const double size = skinning == Skinning::kLinearBlend ? rng.uniform(0.6f, 1.6f) : 1.0;
        rig.joints.push_back({glm::mat3(size * turn), random_point(rng, 0.3f)});
        rig.places.emplace_back(random_direction(rng));
    }
    rig.reach = 3.0;
    return rig;
}

// A ball's points: where the surface goes from p along a tangent.
glm::vec3 walk(const glm::dvec3& p, const glm::dvec3& step) {
    return glm::vec3(glm::normalize(p + step));
}

// Runs the engine's kernels on points of the ball.
void skin_points(const Rig& rig, const std::vector<glm::vec3>& points, std::vector<glm::vec3>* positions,
                 std::vector<glm::vec3>* normals) {
    SkinBinding binding{kJoints, {}, {}};
    for (const glm::vec3& p : points) {
        const Weights weights = rig.weights(glm::dvec3(p));
        for (uint16_t k = 0; k < kJoints; ++k) {
            binding.joints.push_back(k);
            binding.weights.push_back(static_cast<float>(weights[k]));
        }
    }
    PackedJoints packed;
    if (rig.skinning == Skinning::kLinearBlend) {
        pack_joints(rig.joints, &packed);
    } else {
        pack_joints_dual(rig.joints, std::vector<glm::vec3>(kJoints, glm::vec3(0.0f)), std::vector<uint8_t>(kJoints, 1),
                         &packed);
    }
    positions->resize(points.size());
    normals->resize(points.size());
    skin(binding, packed, points, points, *positions, *normals);
}

// The smaller singular value of the matrix of two columns.
double least_stretch(const glm::dvec3& a, const glm::dvec3& b) {
    const double aa = glm::dot(a, a), bb = glm::dot(b, b), ab = glm::dot(a, b);
    return std::sqrt(std::max(0.0, 0.5 * (aa + bb - std::hypot(aa - bb, 2.0 * ab))));
}

struct Worst {
    double share = 0.0;  // Of the bound.
    int compared = 0;
};

// At a point of the ball, with steps of the engine's differences of `h`.
void compare_normal(const Rig& rig, const glm::dvec3& p, double h, Worst* worst) {
    const glm::dvec3 beside = std::abs(p.x) < 0.7 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    const glm::dvec3 t0 = glm::normalize(glm::cross(p, beside)), tangents[] = {t0, glm::cross(p, t0)};
    const std::vector<glm::vec3> points = {glm::vec3(p), walk(p, h * tangents[0]), walk(p, -h * tangents[0]),
                                           walk(p, h * tangents[1]), walk(p, -h * tangents[1])};
    std::vector<glm::vec3> positions, normals;
    skin_points(rig, points, &positions, &normals);

    constexpr double kTiny = 1e-5;  // Of differences in double: exact to 1e-9.
    const Weights weights = rig.weights(p);
    glm::dvec3 seen[2], surface[2];
    double added = 0.0, error = 0.0;  // |E|, and what differences of floats are off by; squared.
    for (int k = 0; k < 2; ++k) {
        const glm::dvec3 ahead = p + kTiny * tangents[k], behind = p - kTiny * tangents[k];
        surface[k] = (rig.move(ahead, rig.weights(ahead)) - rig.move(behind, rig.weights(behind))) / (2.0 * kTiny);
        const glm::dvec3 fixed = (rig.move(ahead, weights) - rig.move(behind, weights)) / (2.0 * kTiny);
        seen[k] = glm::dvec3(positions[1 + 2 * k] - positions[2 + 2 * k]) / (2.0 * h);
        added += glm::dot(surface[k] - fixed, surface[k] - fixed);
        // What a step as long is off by in double; 12 ulps each way that kernels may be off, weights and points rounded.
        const glm::dvec3 exact_ahead = glm::normalize(p + h * tangents[k]),
                         exact_behind = glm::normalize(p - h * tangents[k]);
        const glm::dvec3 exact =
            (rig.move(exact_ahead, rig.weights(exact_ahead)) - rig.move(exact_behind, rig.weights(exact_behind))) /
            (2.0 * h);
        const double rounding = std::sqrt(3.0) * 16.0 * kUlp * rig.reach / h;
        error += std::pow(glm::distance(exact, surface[k]) + rounding, 2);
    }
    const double stretch = least_stretch(surface[0], surface[1]) - std::sqrt(error);
    // The normal's own rounding: that of products of three numbers of the blended matrix.
    const double bound = (std::sqrt(added) + std::sqrt(error)) / stretch + 32.0 * kUlp / (stretch * stretch);
    if (!(stretch > 0.1) || !(bound < 0.5)) return;  // Flattened: no direction to compare.
    const glm::dvec3 normal = glm::normalize(glm::dvec3(normals[0])),
                     expected = glm::normalize(glm::cross(seen[0], seen[1]));
    const double sine = glm::length(glm::cross(normal, expected));
    EXPECT_GT(glm::dot(normal, expected), 0.0);
    EXPECT_LE(sine, bound) << "weights add " << std::sqrt(added) << ", differences are off by " << std::sqrt(error);
    worst->share = std::max(worst->share, sine / bound);
    ++worst->compared;
}

Worst compare_normals(Skinning skinning, double spread, uint64_t seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Rng rng(seed);
    Worst worst;
    for (int round = 0; round < 60; ++round) {
        const Rig rig = random_rig(rng, skinning, spread);
        for (int k = 0; k < 60; ++k) compare_normal(rig, glm::normalize(glm::dvec3(random_direction(rng))), 0.01, &worst);
    }
    EXPECT_GT(worst.compared, 1800);
    return worst;
}

constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(SkinNormals, AreThoseOfTheSurfaceWhereWeightsAreTheSame) {
    compare_normals(Skinning::kLinearBlend, kInfinity, 811);
    compare_normals(Skinning::kDualQuaternion, kInfinity, 812);
}

TEST(SkinNormals, LeanByWhatTheChangeOfWeightsAdds) {
    for (const double spread : {4.0, 2.0, 1.0}) {
        SCOPED_TRACE(::testing::Message() << "spread " << spread);
        const Worst linear = compare_normals(Skinning::kLinearBlend, spread, 813);
        const Worst dual = compare_normals(Skinning::kDualQuaternion, spread, 814);
        EXPECT_GT(linear.share, 0.3) << "the bound says nothing";
        EXPECT_GT(dual.share, 0.3) << "the bound says nothing";
    }
}

}  // namespace
}  // namespace zoe::test
