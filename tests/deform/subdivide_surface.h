#pragma once

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "engine/deform/subdivide.h"
#include "tests/deform/subdivide_oracle.h"

namespace zoe::test {

/// A subdivided cage in one pose.
struct Surface {
    Subdivision topology;
    std::vector<glm::vec3> positions, normals;
};

inline Surface surface_of(const Cage& cage, const std::vector<glm::vec3>& cage_positions,
                          const SubdivisionOptions& options) {
    EXPECT_EQ(check(cage, cage_positions.size(), options.level), "");
    Surface surface{make_subdivision(cage, cage_positions.size(), options), {}, {}};
    surface.positions.resize(surface.topology.stencils.vertex_count());
    if (options.normals) surface.normals.resize(surface.positions.size());
    evaluate(surface.topology.stencils, cage_positions, surface.positions, surface.normals);
    return surface;
}

inline Surface surface_of(const PolygonMesh& mesh, const SubdivisionOptions& options,
                          SubdivisionScheme scheme = SubdivisionScheme::kCatmullClark) {
    return surface_of(mesh.cage(scheme), mesh.positions(), options);
}

constexpr SubdivisionOptions refined_to(int level) {
    return {.level = level, .limit_positions = false, .normals = false};
}

inline bool contains(const std::vector<glm::vec3>& points, const glm::vec3& wanted) {
    return std::any_of(points.begin(), points.end(), [&](const glm::vec3& p) { return glm::length(p - wanted) < 1e-6f; });
}

}  // namespace zoe::test
