#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "engine/bvh/clip.h"

namespace zoe {

/// A triangle, or a piece of one, on its way down into the leaves of an SBVH.
struct Reference {
    Aabb box;  ///< Empty for a triangle that is not finite.
    uint32_t primitive;
    bool is_piece;  ///< box holds a part of the triangle only.
};

struct ObjectSplit {
    int axis = -1;
    uint32_t position = 0;                                  ///< References on the left, in order of their centres.
    double cost = std::numeric_limits<double>::infinity();  ///< Area times count, both sides.
    Aabb left, right;
};

struct SpatialSplit {
    int axis = -1;
    float plane = 0.0f;
    double cost = std::numeric_limits<double>::infinity();
    Aabb left, right;
    uint32_t left_count = 0, right_count = 0;
};

/// Memory of one thread that searches for splits.
struct SplitScratch {
    std::array<std::vector<uint64_t>, 3> orders;  ///< Keys of the references, by centre, an order an axis.
    std::array<std::vector<uint64_t>, 3> keys;
    std::array<std::vector<double>, 3> right_areas;
    std::vector<Reference> right;  ///< That side of a split, on its way to its place.
};

/// Tries every position along every axis. Among equal costs the most even split wins.
/// references   at least 2.
/// block_shift  they are counted in blocks of 2^block_shift.
/// Returns      the best; leaves scratch->orders sorted.
/// Source     MacDonald, Booth. Heuristics for Ray Tracing Using Space Subdivision. The Visual Computer 1990.
ObjectSplit best_object_split(std::span<const Reference> references, int block_shift, SplitScratch* scratch);

/// Tries the planes between bins of equal width along every axis; triangles are cut where they cross bins.
/// bounds     of the references.
/// Returns    the best, with what would stand on either side if all that cross the plane were cut; axis -1 if there is none.
/// Source     Stich, Friedrich, Dietrich. Spatial Splits in Bounding Volume Hierarchies. HPG 2009.
SpatialSplit best_spatial_split(std::span<const Reference> references, const Aabb& bounds,
                                std::span<const glm::vec3> positions, std::span<const glm::uvec3> corners, int bin_count,
                                int block_shift);

}  // namespace zoe
