#include "apps/chart/rod.h"

#include <algorithm>

#include <glm/ext/vector_double3.hpp>
#include <glm/geometric.hpp>

#include "content/shapes.h"

namespace zoe::chart {
namespace {

constexpr float kHalfLength = 1.5f, kRadius = 0.5f, kHalfBlend = 1.0f;

// Of a closed mesh: the sum over its triangles of the tetrahedra that they span with the origin.
double volume_of(const std::vector<glm::vec3>& positions, const std::vector<glm::uvec3>& corners) {
    double sum = 0.0;
    for (const glm::uvec3& c : corners) {
        const glm::dvec3 a(positions[c.x]), b(positions[c.y]), d(positions[c.z]);
        sum += glm::dot(a, glm::cross(b, d)) / 6.0;
    }
    return sum;
}

}  // namespace

Rod::Rod(int rings, int sides) {
    std::vector<glm::vec3> path;
    for (int k = 0; k < rings; ++k) {
        path.emplace_back(0.0f, kHalfLength * (2.0f * static_cast<float>(k) / static_cast<float>(rings - 1) - 1.0f), 0.0f);
    }
    mesh = make_tube(path, std::vector<float>(path.size(), kRadius), sides);
    mesh.binding.influence_count = 4;
    for (const glm::vec3& p : mesh.positions) {
        const float upper = std::clamp(0.5f + 0.5f * p.y / kHalfBlend, 0.0f, 1.0f);
        mesh.binding.joints.insert(mesh.binding.joints.end(), {0, 1, 0, 0});
        mesh.binding.weights.insert(mesh.binding.weights.end(), {1.0f - upper, upper, 0.0f, 0.0f});
    }
}

double Rod::volume() const {
    return volume_of(mesh.positions, mesh.corners);
}

double Rod::volume_turned(const glm::vec3& axis, double degrees, Skinning skinning) const {
    std::vector<glm::vec3> positions(mesh.positions.size());
    skin(mesh.binding, packed(pose(axis, degrees), skinning), mesh.positions, {}, positions, {});
    return volume_of(positions, mesh.corners);
}

std::vector<Affine> Rod::pose(const glm::vec3& axis, double degrees) {
    const glm::quat turn = glm::angleAxis(static_cast<float>(glm::radians(degrees)), axis);
    return {Affine{}, to_affine(Trs{.translation = glm::vec3(0.0f), .rotation = turn, .scale = glm::vec3(1.0f)})};
}

PackedJoints Rod::packed(const std::vector<Affine>& joints, Skinning skinning) {
    PackedJoints packed;
    if (skinning == Skinning::kLinearBlend) {
        pack_joints(joints, &packed);
    } else {
        const std::vector<glm::vec3> centres(joints.size(), glm::vec3(0.0f));
        pack_joints_dual(joints, centres, std::vector<uint8_t>(joints.size(), 1), &packed);
    }
    return packed;
}

}  // namespace zoe::chart
