#pragma once

#include "engine/bvh/bvh.h"
#include "engine/math/triangle.h"

namespace zoe {

/// A tree for triangles that never move: a primitive may stand in several leaves, each of whose boxes holds a piece of it.
/// Not to be refitted: a box that holds all of such a primitive would be as wrong for speed as the piece's is for motion.
/// Traversed as any other; hits are those of any other tree, to the last bit.
struct StaticBvh {
    Bvh tree;                      ///< tree.primitives: leaf order -> triangle, with repetitions.
    uint32_t primitive_count = 0;  ///< Triangles that it was built over; each stands in at least one leaf.
};

/// Tells whether boxes hold a triangle together: its corners, the centres of its edges, and its centre.
bool is_held(const Triangle& triangle, std::span<const Aabb> boxes);

/// Checks what `validate` does for a Bvh, with repetitions allowed, and that the leaves of a triangle hold it.
/// Returns    the first broken invariant in words, empty when all hold.
std::string validate(const StaticBvh& bvh, std::span<const glm::vec3> positions, std::span<const glm::uvec3> corners);

}  // namespace zoe
