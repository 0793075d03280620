#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>

#include <glm/vec3.hpp>

#include "engine/bvh/blas.h"

// Part of blas and refit_blas: how a block's triangles are gathered. Not for others to include.
namespace zoe::place_detail {

/// A row of a block in a register, on any processor.
using Float4 = float __attribute__((vector_size(sizeof(float) * TriangleBlock::kSize)));
using Double2 = double __attribute__((vector_size(sizeof(double) * 2)));
using Int4 = int32_t __attribute__((vector_size(sizeof(float) * TriangleBlock::kSize)));

// Comparisons with NaN give the second operand.
inline Float4 smaller(Float4 a, Float4 b) {
    return a < b ? a : b;
}
inline Float4 larger(Float4 a, Float4 b) {
    return a > b ? a : b;
}

inline bool any(Int4 mask) {
    int64_t halves[2];
    std::memcpy(halves, &mask, sizeof halves);
    return (halves[0] | halves[1]) != 0;
}

/// Turns four points x y z _ into the rows of their x, of their y, and of their z.
inline void transpose(const Float4 (&points)[4], Float4 (&rows)[3]) {
    const Float4 xy_01 = __builtin_shufflevector(points[0], points[1], 0, 4, 1, 5);
    const Float4 xy_23 = __builtin_shufflevector(points[2], points[3], 0, 4, 1, 5);
    const Float4 z_01 = __builtin_shufflevector(points[0], points[1], 2, 6, 3, 7);
    const Float4 z_23 = __builtin_shufflevector(points[2], points[3], 2, 6, 3, 7);
    rows[0] = __builtin_shufflevector(xy_01, xy_23, 0, 1, 4, 5);
    rows[1] = __builtin_shufflevector(xy_01, xy_23, 2, 3, 6, 7);
    rows[2] = __builtin_shufflevector(z_01, z_23, 0, 1, 4, 5);
}

/// Bounds of the triangles that were placed, each slot of their blocks for itself.
struct SlotBounds {
    static constexpr float kInfinity = std::numeric_limits<float>::infinity();
    Float4 lo[3] = {Float4{} + kInfinity, Float4{} + kInfinity, Float4{} + kInfinity};
    Float4 hi[3] = {Float4{} - kInfinity, Float4{} - kInfinity, Float4{} - kInfinity};

    /// NaN extends nothing.
    void extend(const Float4 (&point)[3]) {
        for (int axis = 0; axis < 3; ++axis) {
            lo[axis] = smaller(point[axis], lo[axis]);
            hi[axis] = larger(point[axis], hi[axis]);
        }
    }

    Aabb box() const {
        Aabb box;
        for (int axis = 0; axis < 3; ++axis) {
            const Float4 low = smaller(lo[axis], __builtin_shufflevector(lo[axis], lo[axis], 2, 3, 0, 1));
            const Float4 high = larger(hi[axis], __builtin_shufflevector(hi[axis], hi[axis], 2, 3, 0, 1));
            box.lo[axis] = low[0] < low[1] ? low[0] : low[1];
            box.hi[axis] = high[0] > high[1] ? high[0] : high[1];
        }
        return box;
    }
};

/// A vertex as x y z 0, without reading what follows it.
inline Float4 load(const float* position) {
    double xy;
    std::memcpy(&xy, position, sizeof xy);
    Float4 halves;
    const Double2 wide{xy, 0.0};
    std::memcpy(&halves, &wide, sizeof halves);
    return __builtin_shufflevector(halves, Float4{position[2], 0.0f, 0.0f, 0.0f}, 0, 1, 4, 5);
}

/// Asks for the vertices of a block: they lie anywhere in memory.
inline void prefetch(std::span<const glm::vec3> positions, std::span<const glm::uvec3> corners, const TriangleBlock& block) {
    for (const uint32_t primitive : block.primitive) {
        if (primitive == kEmptyChild) continue;
        const glm::uvec3& corner = corners[primitive];
        __builtin_prefetch(&positions[corner.x]);
        __builtin_prefetch(&positions[corner.z]);
    }
}

/// Puts a block's triangles where their vertices are now, those that are not finite as NaN, and extends bounds by the
/// others.
/// Returns    how many are not finite.
inline uint32_t place_block(std::span<const glm::vec3> positions, std::span<const glm::uvec3> corners, TriangleBlock* block,
                            SlotBounds* bounds) {
    static constexpr float kNowhere[3] = {NAN, NAN, NAN};
    static constexpr glm::uvec3 kNoCorners{0, 0, 0};
    Float4 points[3][TriangleBlock::kSize];
    for (uint32_t slot = 0; slot < TriangleBlock::kSize; ++slot) {
        const uint32_t primitive = block->primitive[slot];
        const bool is_empty = primitive == kEmptyChild;
        const glm::uvec3& corner = is_empty ? kNoCorners : corners[primitive];
        for (int k = 0; k < 3; ++k) points[k][slot] = load(is_empty ? kNowhere : &positions[corner[k]].x);
    }
    Float4 rows[3][3];
    Float4 probe{};  // 0, or NaN where any coordinate is not finite.
    for (int k = 0; k < 3; ++k) {
        transpose(points[k], rows[k]);
        probe += 0.0f * rows[k][0] + 0.0f * rows[k][1] + 0.0f * rows[k][2];
    }
    uint32_t not_finite_count = 0;
    if (any(probe != probe)) {
        for (uint32_t slot = 0; slot < TriangleBlock::kSize; ++slot) {
            not_finite_count += probe[slot] != probe[slot] && block->primitive[slot] != kEmptyChild;
        }
        const Float4 nowhere = Float4{} + NAN;
        for (auto& corner : rows) {
            for (Float4& row : corner) row = probe == probe ? row : nowhere;
        }
    }
    for (int k = 0; k < 3; ++k) {
        bounds->extend(rows[k]);
        std::memcpy(block->corners[3 * k], rows[k], sizeof rows[k]);
    }
    return not_finite_count;
}

}  // namespace zoe::place_detail
