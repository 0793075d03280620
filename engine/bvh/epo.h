#pragma once

#include <atomic>
#include <cstdint>
#include <limits>
#include <span>

#include "engine/bvh/bvh.h"
#include "engine/math/triangle.h"

namespace zoe {

struct EpoConfig {
    /// Where all triangles would visit more nodes than about this many, some are chosen at random to stand for them.
    uint64_t max_visits = std::numeric_limits<uint64_t>::max();
    uint64_t seed = 1;                          ///< Of that choice.
    const std::atomic<bool>* cancel = nullptr;  ///< Ends the work where it is set; the result is of what was done.
};

struct Epo {
    double cost = 0.0;
    uint64_t visits = 0;      ///< Nodes that triangles were tested with.
    bool is_sampled = false;  ///< `cost` is an estimate.
};

/// End-point overlap: what a random ray costs because it ends on a surface inside of nodes that do not hold that surface.
/// Each node's cost, as `sah_cost` counts it, times the area of the triangles inside its box (closed) that are not in its
/// subtree, summed over the nodes and divided by the area of all triangles. What a tree costs to trace follows a blend of
/// `sah_cost` and this.
/// triangles  [reference_count] in the order of the leaves: triangles[k] is primitive bvh.primitives[k]. Those without area
///            and those that are not finite add nothing.
/// Requires   a valid tree, whose boxes contain their triangles, or the pieces of those that stand in it more than once:
///            such a triangle counts once, and is in every subtree that has one of its pieces. A subtree's leaves may stand
///            anywhere.
/// Returns    0 where no node reaches into another's surface, and where there is no area. The same number whatever the
///            count of threads.
/// Cost       one walk a triangle, through the nodes that it reaches into, which are all of them where everything overlaps;
///            in parallel; 40 bytes a reference, 8 a node.
/// Source     Aila, Karras, Laine. On Quality Metrics of Bounding Volume Hierarchies. HPG 2013.
Epo epo(const Bvh& bvh, std::span<const Triangle> triangles, const EpoConfig& config);

/// The same of all triangles.
double epo_cost(const Bvh& bvh, std::span<const Triangle> triangles);

}  // namespace zoe
