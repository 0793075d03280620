#pragma once

#include <cstdint>
#include <vector>

#include "engine/bvh/placing_config.h"
#include "engine/frame/build_tlas.h"

namespace zoe {

/// A subtree on its way into the top level.
struct OpenedPart {
    PlacedPart part;
    Aabb box;
};

/// Memory that one frame's opening hands to the next.
struct OpeningScratch {
    std::vector<OpenedPart> open;         ///< A heap of what may be opened further.
    std::vector<OpenedPart> parts, last;  ///< What stands for instances that were opened: now, and in the frame before.
};

/// Puts parts of large instances whose space is the world's into the top level in their place: a ray meets what is inside of
/// such an instance in order of distance, instead of looking through all of it first or last.
/// instances  candidates: positions in tlas->instances. Their boxes are bounds_world.
/// tlas       one box and part for each instance; after, the first of an opened instance's parts stands in its place, and
///            the others after all instances.
/// Returns    whether the parts, their boxes too, are other than in the frame before.
/// Cost       O(candidates) and a few dozen nodes; no allocation once most_parts is reached. Counts of nodes and areas
///            decide, the same way whatever the number of threads.
/// Source     Benthin, Woop, Wald, Afra. Improved Two-Level BVHs using Partial Re-Braiding. HPG 2017. Deviation: only where
///            no transform lies between, by area alone.
bool open_instances(const PlacingConfig& config, const std::vector<uint32_t>& instances, Tlas* tlas,
                    OpeningScratch* scratch);

}  // namespace zoe
