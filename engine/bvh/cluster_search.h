#pragma once

#include <cstdint>

#include "engine/bvh/cluster_tree.h"

namespace zoe {

/// Finds whom clusters would merge with, sixteen neighbours together. A pair's key is (half area of its union, boxes in
/// it, lower id, higher id), the area in floats: x * (y + z) + y * z. The best partner makes the least one.
/// group      of level 0.
/// lanes      the clusters of it that search, as bits; none of them empty.
/// partners   result: [16] ids, of the lanes that search.
/// Requires   two clusters or more.
/// Cost       about log n where boxes have places or sizes of their own, at most n; by the best instruction set that the
///            processor has, the same partners on all of them.
void search_clusters(const ClusterTree& tree, uint32_t group, uint32_t lanes, uint32_t* partners);

}  // namespace zoe
