#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/math/aabb.h"

namespace zoe {

/// Memory that one ordering hands to the next.
struct MortonScratch {
    /// Of the order.
    struct Range {
        size_t begin, end;
    };
    std::vector<Aabb> centre_bounds;  ///< Of the parts that are looked at in parallel.
    std::vector<uint64_t> codes;      ///< [boxes]
    std::vector<uint64_t> keys, run, sort_scratch;
    std::vector<Range> unordered;
};

/// Orders boxes along the Z curve through their centres: what is near in it is mostly near in space. 21 bits an axis, one
/// unit for all axes, so that a flat scene is divided along its length and width first. What falls into one cell, as most
/// does where a few boxes are far away from all others, is ordered by a curve of its own. Equal centres go by index; boxes
/// that are empty or not finite stand last.
///
/// order      result: [boxes] a permutation.
/// Cost       O(n), the codes in parallel, the sort on one thread; again for boxes that shared a cell, at most 14 times. No
///            allocation where `order` and `scratch` are large enough.
/// Source     Morton. A Computer Oriented Geodetic Data Base and a New Technique in File Sequencing. IBM 1966.
void morton_order(std::span<const Aabb> boxes, std::vector<uint32_t>* order, MortonScratch* scratch);

}  // namespace zoe
