#pragma once

#include <cstddef>

#include "engine/bvh/wide.h"

namespace zoe::chart {

/// Lets the grandchildren of each node change places across its children, where that makes their boxes smaller: from the
/// bottom up, of each two children the one exchange that gains most, or a move into an empty slot. Links, levels and blocks
/// stay as a refit needs them. The engine has no such step: the chart `degradation` says why.
/// Requires   that the tree has been refitted.
/// Returns    how many changed places.
/// Cost       O(nodes), some 2000 pairs of boxes a node at most; one thread, no allocation.
/// Source     Kopta, Ize, Spjut, Brunvand, Davis, Kensler. Fast, Effective BVH Updates for Animated Scenes. I3D 2012.
///            Deviation: eight children a node, and only places on the same level are exchanged.
size_t rotate(WideBvh* wide);

}  // namespace zoe::chart
