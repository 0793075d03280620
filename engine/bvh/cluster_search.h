#pragma once

#include <cstdint>
#include <limits>

#include "engine/bvh/cluster_tree.h"

namespace zoe {

/// Whom a cluster would merge with. The initial value is after every partner.
struct Partner {
    double half_area = std::numeric_limits<double>::max();  ///< Of the union.
    uint32_t id = kNoPartner;
};

/// Finds the partner of least (half area, id).
/// slot       where the cluster is: lane slot % 16 of group slot / 16 of level 0.
/// known      a partner, or the initial value: a good one saves time and changes nothing else.
/// Returns    the best one, `known` included.
/// Cost       about log n, at most n; by the best instruction set that the processor has, the same bits on all of them.
Partner search_clusters(const ClusterTree& tree, const Aabb& box, uint32_t slot, const Partner& known);

}  // namespace zoe
