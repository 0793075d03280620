#pragma once

#include <vector>

#include "engine/bvh/static_bvh.h"
#include "tests/bvh/inputs.h"

namespace zoe::test {

/// Triangles of every shape and size that cross each other, in a cube of half-width 10: large ones, needles, axis-aligned
/// ones, ones that share planes and edges. Few, so that brute force over them is cheap.
TestMesh crossing_triangles(int triangle_count, uint64_t seed);

/// A tree over small pieces of the triangles: each cut at random planes, over and over, as a spatial split may.
StaticBvh tree_of_pieces(const TestMesh& mesh, int cuts_a_triangle, uint64_t seed);

/// Rays of the kinds that rounding decides: in the plane of a triangle or 1 to 1000 ulps off it, through its edges and
/// corners, from far away, from on it, along axes, and plain ones.
std::vector<Ray> grazing_rays(const TestMesh& mesh, int count, uint64_t seed);

}  // namespace zoe::test
