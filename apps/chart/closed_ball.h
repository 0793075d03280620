#pragma once

#include <cstdint>
#include <vector>

#include "engine/math/rng.h"
#include "engine/math/triangle.h"
#include "engine/scene/mesh.h"

namespace zoe::chart {

glm::vec3 random_direction(Rng& rng);

/// A ball of radius 1 without holes, and the triangles around each of its vertices.
struct ClosedBall {
    Mesh mesh;
    std::vector<std::vector<uint32_t>> around;  ///< [vertex_count]

    /// segments   around its axis; half as many from pole to pole.
    explicit ClosedBall(int segments);
    Triangle triangle(uint32_t k) const;
};

/// A ray from outside at a vertex, or at a point of an edge, that clearly faces it: there it must be hit.
struct EdgeRay {
    Ray ray;
    uint32_t a = 0, b = 0;  ///< The edge's ends; equal for a vertex.
    float t = 0.0f;         ///< Of the point aimed at.
};
/// The k-th of a seed.
EdgeRay edge_ray(const ClosedBall& ball, uint64_t seed, size_t k);

}  // namespace zoe::chart
