#pragma once

#include <vector>

#include "engine/scene/mesh.h"

namespace zoe::chart {

/// A closed rod with round ends, 4 long and 1 thick along Y around the origin. Its lower quarter follows one joint, its
/// upper quarter another, and between them weights change evenly.
struct Rod {
    Mesh mesh;

    /// rings      along it; sides: around it.
    Rod(int rings, int sides);

    double volume() const;
    /// When the upper joint is turned about an axis through the middle of the rod.
    double volume_turned(const glm::vec3& axis, double degrees, Skinning skinning) const;

    /// The joints' matrices.
    static std::vector<Affine> pose(const glm::vec3& axis, double degrees);
    static PackedJoints packed(const std::vector<Affine>& joints, Skinning skinning);
};

}  // namespace zoe::chart
