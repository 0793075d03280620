#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "engine/math/affine.h"

namespace zoe {

/// How a vertex follows several joints.
enum class Skinning : uint8_t {
    kLinearBlend,     ///< By the weighted sum of their matrices. Loses volume where joints twist or bend far.
    kDualQuaternion,  ///< By a rigid motion between theirs. Keeps volume; bulges at the outside of a bend.
};

/// A 3x4 matrix by rows, and what fills a cache line.
struct alignas(64) PackedAffine {
    float rows[3][4];
    float unused[4];
};

/// A rigid motion: a unit dual quaternion, x y z w of its real and of its dual part.
struct alignas(32) PackedMotion {
    float real[4], dual[4];
};

/// Joint matrices in the form that the kernels read. Of a dual quaternion skin, each is
/// common_scale * motion * affine, of which the affines are left out where none of them does anything.
/// Source     Kavan, Collins, Zara, O'Sullivan. Geometric Skinning with Approximate Dual Quaternion Blending. TOG 2008.
struct PackedJoints {
    Skinning skinning = Skinning::kLinearBlend;
    bool is_finite = true;              ///< All affines are: none needs to be hidden by a weight of 0.
    float common_scale = 1.0f;          ///< Of dual quaternions; negative: a mirror.
    std::vector<PackedAffine> affines;  ///< [joint_count] matrices, or scales and shears, or empty.
    std::vector<PackedMotion> motions;  ///< [joint_count] of dual quaternions.
    std::vector<double> scratch;

    size_t joint_count() const { return skinning == Skinning::kLinearBlend ? affines.size() : motions.size(); }
};

/// Packs joint matrices for linear blending.
/// skin_from_mesh   [joint_count] joint's world (or skin space) * inverse bind matrix.
/// Cost       O(joints); no allocation once the memory is there.
void pack_joints(std::span<const Affine> skin_from_mesh, PackedJoints* packed);

/// Packs joint matrices for dual quaternions: linear part = common scale * rotation * stretch. The common scale is the
/// median over the joints (so that a skeleton that is scaled or mirrored as a whole gives the same surface scaled or
/// mirrored); the stretch, symmetric and about the joint's centre, is blended linearly and comes before the motion. A joint
/// that is mirrored against the others has a stretch that is minus a positive one; one that flattens is turned by what is
/// left of it: a plane, or the shortest way of a line, or, of a point, not at all. A joint so much larger than the common
/// scale that its stretch overflows leaves vertices that follow it without a place: NaN or infinite.
/// centres    [joint_count] where in the bind pose each joint is, from `joint_centres`.
/// is_used    [joint_count] from `used_joints`: only those count for the median.
/// Cost       O(joints), in double; no allocation once the memory is there.
void pack_joints_dual(std::span<const Affine> skin_from_mesh, std::span<const glm::vec3> centres,
                      std::span<const uint8_t> is_used, PackedJoints* packed);

/// Where each joint is in the bind pose; the origin for those whose matrix has no inverse.
/// joint_from_mesh  [joint_count] inverse bind matrices.
std::vector<glm::vec3> joint_centres(std::span<const Affine> joint_from_mesh);

}  // namespace zoe
