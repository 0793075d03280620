#pragma once

#include "engine/bvh/bvh.h"

namespace zoe {

/// Builds the naive tree that the others are measured against: halves the primitives at the median centre along the longest
/// axis of their bounds, down to leaves of `max_leaf_size`. No cost is looked at.
/// boxes      [primitive_count]; empty or non-finite boxes are kept out of bounds but stay in the tree.
/// storage    a tree whose memory is reused.
/// Cost       O(n log n), one thread.
/// Source     Kay, Kajiya. Ray Tracing Complex Scenes. SIGGRAPH 1986. Deviation: the longest axis, not each in turn.
Bvh build_median(std::span<const Aabb> boxes, int max_leaf_size = 4, Bvh storage = {});

}  // namespace zoe
