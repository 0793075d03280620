#pragma once

#include <cstdint>
#include <span>

#include <glm/vec3.hpp>

#include "engine/bvh/bvh.h"
#include "engine/math/triangle.h"

namespace zoe {

/// The tree of one mesh: a BVH and its triangles in the order of the leaves.
struct Blas {
    Bvh bvh;
    std::vector<Triangle> triangles;  ///< triangles[k] is primitive bvh.primitives[k].
    std::vector<Aabb> boxes;          ///< [triangle_count] by primitive; empty for triangles that are not finite.
    uint32_t not_finite_count = 0;    ///< Triangles with a NaN or infinite corner: in the tree, never hit.
};

enum class BlasBuilder : uint8_t { kSweep, kBinned };

/// Builds a BLAS over an indexed mesh, into storage that it reuses.
/// positions  [vertex_count] local space.
/// corners    [triangle_count] indices into positions; each below vertex_count.
void build_blas(std::span<const glm::vec3> positions, std::span<const glm::uvec3> corners, BlasBuilder builder, Blas* blas);

/// Moves the triangles to new positions and refits the boxes.
/// positions, corners   as when built; only the positions' values may differ.
/// Cost       O(triangles), no allocation.
void refit_blas(std::span<const glm::vec3> positions, std::span<const glm::uvec3> corners, Blas* blas);

}  // namespace zoe
