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

/// How many slots were counted, from the sums of their masks, each of which is -1.
inline uint64_t count(Int4 masks) {
    uint64_t sum = 0;
    for (uint32_t slot = 0; slot < TriangleBlock::kSize; ++slot) sum += static_cast<uint32_t>(-masks[slot]);
    return sum;
}

inline bool any(Int4 mask) {
    int64_t halves[2];
    std::memcpy(halves, &mask, sizeof halves);
    return (halves[0] | halves[1]) != 0;
}

/// Bounds of the triangles that were placed, each slot of their blocks for itself.
struct SlotBounds {
    Float4 lo[3], hi[3];

    /// The identity of `extend`.
    static SlotBounds none() {
        const Float4 most = Float4{} + std::numeric_limits<float>::infinity();
        return {{most, most, most}, {-most, -most, -most}};
    }

    /// NaN extends nothing.
    void extend(const Float4 (&point)[3]) {
        for (int axis = 0; axis < 3; ++axis) {
            lo[axis] = smaller(point[axis], lo[axis]);
            hi[axis] = larger(point[axis], hi[axis]);
        }
    }
};

/// The least (or greatest) of each of four registers side by side. Of zeros of either sign, always that of the same place.
template <typename Better>
inline Float4 across(const Float4& a, const Float4& b, const Float4& c, const Float4& d, Better better) {
    const Float4 ab = better(__builtin_shufflevector(a, b, 0, 4, 1, 5), __builtin_shufflevector(a, b, 2, 6, 3, 7));
    const Float4 cd = better(__builtin_shufflevector(c, d, 0, 4, 1, 5), __builtin_shufflevector(c, d, 2, 6, 3, 7));
    return better(__builtin_shufflevector(ab, cd, 0, 1, 4, 5), __builtin_shufflevector(ab, cd, 2, 3, 6, 7));
}

/// Two neighbouring floats each of two vertices.
inline Float4 load_pairs(const float* first, const float* second) {
    Double2 both;
    std::memcpy(&both[0], first, sizeof both[0]);
    std::memcpy(&both[1], second, sizeof both[1]);
    Float4 pairs;
    std::memcpy(&pairs, &both, sizeof pairs);
    return pairs;
}

/// The x of four points, their y, and their z.
struct Rows {
    Float4 x, y, z;
};

/// Reads four vertices, and nothing that stands beside them.
inline Rows load(const float* a, const float* b, const float* c, const float* d) {
    const Float4 xy_ab = load_pairs(a, b), xy_cd = load_pairs(c, d);
    const Float4 yz_ab = load_pairs(a + 1, b + 1), yz_cd = load_pairs(c + 1, d + 1);
    return {__builtin_shufflevector(xy_ab, xy_cd, 0, 2, 4, 6), __builtin_shufflevector(xy_ab, xy_cd, 1, 3, 5, 7),
            __builtin_shufflevector(yz_ab, yz_cd, 1, 3, 5, 7)};
}

/// 0, or NaN where a coordinate is not finite.
inline Float4 probe(const Rows& rows) {
    return 0.0f * rows.x + 0.0f * rows.y + 0.0f * rows.z;
}

/// A triangle's corners; those of the mesh's first one for an empty slot, without a branch: which are empty is hard to
/// foresee.
inline const glm::uvec3& corners_of(std::span<const glm::uvec3> corners, uint32_t primitive) {
    return corners[primitive & -static_cast<uint32_t>(primitive != kEmptyChild)];
}

/// Asks for what tells a block's vertices.
inline void prefetch_corners(std::span<const glm::uvec3> corners, const TriangleBlock& block) {
    for (const uint32_t primitive : block.primitive) __builtin_prefetch(&corners_of(corners, primitive));
}

/// Asks for the vertices of a block: they lie anywhere in memory.
inline void prefetch(std::span<const glm::vec3> positions, std::span<const glm::uvec3> corners, const TriangleBlock& block) {
    for (const uint32_t primitive : block.primitive) {
        const glm::uvec3& corner = corners_of(corners, primitive);
        __builtin_prefetch(&positions[corner.x]);
        __builtin_prefetch(&positions[corner.z]);
    }
}

/// Puts a block's triangles where their vertices are now, those that are not finite as NaN, and extends bounds by the
/// others.
/// Returns    a mask of those that are not finite.
inline Int4 place_block(std::span<const glm::vec3> positions, std::span<const glm::uvec3> corners, TriangleBlock* block,
                        SlotBounds* bounds) {
    Int4 primitives;
    std::memcpy(&primitives, block->primitive, sizeof primitives);
    static_assert(kEmptyChild == static_cast<uint32_t>(-1));
    const Int4 is_empty = primitives == -1;
    primitives &= ~is_empty;  // An empty slot reads the mesh's first triangle.
    const auto triangle = [&](int slot) -> const glm::uvec3& { return corners[static_cast<uint32_t>(primitives[slot])]; };
    const glm::uvec3 &p = triangle(0), &q = triangle(1), &r = triangle(2), &s = triangle(3);
    const auto vertex = [&](uint32_t k) { return &positions[k].x; };
    Rows a = load(vertex(p.x), vertex(q.x), vertex(r.x), vertex(s.x));
    Rows b = load(vertex(p.y), vertex(q.y), vertex(r.y), vertex(s.y));
    Rows c = load(vertex(p.z), vertex(q.z), vertex(r.z), vertex(s.z));
    Int4 is_not_finite{};
    // The sum may overflow where all is finite.
    const Float4 sum = (a.x + a.y + a.z) + (b.x + b.y + b.z) + (c.x + c.y + c.z);
    if (const Float4 sum_probe = 0.0f * sum; any(sum_probe != sum_probe)) [[unlikely]] {
        const Float4 each_probe = probe(a) + probe(b) + probe(c), nowhere = Float4{} + NAN;
        is_not_finite = (each_probe != each_probe) & ~is_empty;
        for (Rows* rows : {&a, &b, &c}) {
            for (Float4* row : {&rows->x, &rows->y, &rows->z}) *row = each_probe == each_probe ? *row : nowhere;
        }
    }
    const Float4 nowhere = is_empty ? Float4{} + NAN : -Float4{};  // Adding -0 changes nothing, not even a zero's sign.
    const auto put = [&](int k, const Rows& rows) {
        const Float4 placed[3] = {rows.x + nowhere, rows.y + nowhere, rows.z + nowhere};
        bounds->extend(placed);
        std::memcpy(block->corners[3 * k], placed, sizeof placed);
    };
    put(0, a);
    put(1, b);
    put(2, c);
    return is_not_finite;
}

}  // namespace zoe::place_detail
