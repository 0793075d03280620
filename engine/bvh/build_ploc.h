#pragma once

#include "engine/bvh/bvh.h"
#include "engine/bvh/morton_order.h"
#include "engine/bvh/ploc_top.h"

namespace zoe {

struct PlocConfig {
    uint32_t search_radius = 8;  ///< Clusters on either side that one looks for its partner among, at least 1. Chart `tlas`.
    uint32_t top_count = 256;    ///< So few clusters are joined top down as well: the better way is taken. Chart `tlas`.
};

/// Memory that one build hands to the next.
struct PlocScratch {
    /// Clusters in Morton order, by component. Ids: boxes first, in Morton order, then unions in the order made. On both
    /// sides stand infinite boxes that nobody chooses.
    struct Clusters {
        std::vector<float> planes[6];  ///< lo.x, hi.x, lo.y, hi.y, lo.z, hi.z.
        std::vector<uint32_t> ids, leaf_counts;
    };
    /// Where what is under a union stands in the tree.
    struct Place {
        uint32_t first_node, first_leaf;
    };
    /// Of a range of clusters that is worked on apart from the others.
    struct Part {
        uint32_t union_count;             ///< Unions whose first half is in the range.
        uint32_t first_union, first_out;  ///< Where those go, and what is left of the range.
        uint32_t out_count;
        uint32_t first_partner;
        std::vector<uint32_t> partners;  ///< [from first_partner on] whom each cluster would merge with.
    };
    MortonScratch morton;
    PlocTop top;
    std::vector<uint32_t> order;  ///< [boxes] along the Morton curve.
    Clusters clusters[2];         ///< This round's and the next's.
    std::vector<uint32_t> mates;  ///< [clusters] whom each merges with.
    std::vector<Part> parts;
    std::vector<PlocUnion> unions;     ///< [boxes - 1]
    std::vector<Place> places;         ///< [boxes - 1]
    std::vector<uint32_t> round_ends;  ///< Unions of round k are [round_ends[k - 1], round_ends[k]).
};

/// Builds bottom up, round by round: each cluster finds the one that it makes the least box with among its neighbours in
/// Morton order, and those that chose each other merge. Ties go to neighbours by position, so that coincident boxes make a
/// balanced tree. As clusters become few they look farther, max(search_radius, 4096 / clusters) places. Where few chose
/// each other, others merge with their choice, too: at least about one in max(12, 4 * radius + 2) clusters goes in a round.
/// So the depth is at most about max(12, 4 * search_radius + 2) * log(boxes) + max(320, top_count) for radii up to 100; it
/// is less than 2 * log2(boxes) in usual scenes. Leaves hold one primitive. The last few clusters are joined as
/// `improve_top` does.
///
/// boxes      [primitive_count] any: one that is empty or not finite counts as empty. Areas are floats: those beyond their
///            range count as equal.
/// storage    a tree whose memory is reused.
/// Returns    a tree in depth-first order, the same whatever the number of threads.
/// Cost       O(primitives * search_radius), in parallel; no allocation where `storage` and `scratch` are large enough.
/// Source     Meister, Bittner. Parallel Locally-Ordered Clustering for Bounding Volume Hierarchy Construction. TVCG 2018.
///            Deviation: looks farther as clusters become few, at last at all of them; binned SAH for the top.
Bvh build_ploc(std::span<const Aabb> boxes, const PlocConfig& config, Bvh storage, PlocScratch* scratch);

}  // namespace zoe
