#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/bvh/cluster_search.h"

namespace zoe {

/// The clusters that agglomerative clustering has not merged yet, in a balanced tree that finds a cluster's best partner
/// without a look at all of them. Clusters have ids: the boxes first, then unions in the order made. A pair's key is (half
/// area of its union, lower id, higher id); the best partner is the one with the least key, exactly.
/// Source     Walter, Bala, Kulkarni, Pingali. Fast Agglomerative Clustering for Rendering. IEEE RT 2008. Deviation: sixteen
///            wide; sorted by size as well as by place; bounds on where boxes start and end, in place of bounds on centres.
class ClusterIndex {
public:
    static constexpr uint32_t kNobody = kNoPartner;

    /// Starts anew, in the memory of the last time.
    /// boxes      [box_count] finite and not empty; box_count from 1 to 2^31.
    /// Cost       O(n log n), in parallel.
    void start(std::span<const Aabb> boxes);

    uint32_t cluster_count() const { return cluster_count_; }

    /// Of any cluster, merged ones too.
    const Aabb& bounds(uint32_t id) const { return box_of_id_[id]; }

    /// The cluster that makes the least key with this one.
    /// guess      another cluster, to compare with first, or kNobody: a good one saves time and changes nothing else.
    /// Requires   two clusters or more; that neither of these was merged.
    /// Cost       about log n where boxes have places or sizes of their own, at most n; at once if the last answer still
    /// holds.
    uint32_t best_partner(uint32_t id, uint32_t guess);

    /// Finds the best partner of every cluster that has none yet, or whose last one was merged.
    /// Requires   two clusters or more.
    /// Cost       a search each, in parallel.
    void find_partners();

    /// The answer of the last search for a cluster that was not merged.
    uint32_t partner(uint32_t id) const { return partner_of_id_[id]; }

    /// Replaces two clusters by their union.
    /// Requires   that neither was merged.
    /// Returns    its id: the next one.
    /// Cost       O(log n), and O(n log n) each time that half of the clusters are gone.
    uint32_t merge(uint32_t a, uint32_t b);

    struct Pair {
        uint32_t a, b;
    };
    /// The same, many at once; ids as if one by one.
    /// Requires   that no cluster is in two pairs.
    /// Cost       O(n), and O(n log n) each time that half of the clusters are gone.
    void merge(std::span<const Pair> pairs);

private:
    // What clusters are sorted by.
    struct Item {
        float place_and_size[6];  // Centre, half extents.
        uint32_t id;
    };

    static Item item(const Aabb& box, uint32_t id);
    bool is_there(uint32_t id) const { return slot_of_id_[id] != kNobody; }
    // The last answer holds for as long as that partner lives: whatever was made since contains something that was there, so
    // its union with this cluster is no smaller, and where equal, its higher id loses.
    bool has_partner(uint32_t id) const { return partner_of_id_[id] != kNobody && is_there(partner_of_id_[id]); }
    bool is_sparse() const { return cluster_count_ <= rebuild_count_ && tree_.level_count > 1; }
    void find_partner(uint32_t id, uint32_t guess);
    uint32_t join(uint32_t a, uint32_t b);
    void move_together();
    void rebuild();
    void split(size_t begin, size_t middle, size_t end);
    void sum_up();

    uint32_t cluster_count_ = 0;
    uint32_t slot_count_ = 0;     // Of level 0, that are or were in use.
    uint32_t rebuild_count_ = 0;  // So few clusters left, and the tree is built anew.
    ClusterTree tree_{};
    std::array<std::vector<ClusterGroup>, ClusterTree::kMaxLevels> levels_;
    std::vector<Item> items_;  // Scratch of rebuild.
    std::vector<Aabb> box_of_id_;
    std::vector<uint32_t> slot_of_id_;     // Lane slot % 16 of group slot / 16 of level 0; kNobody once merged.
    std::vector<uint32_t> partner_of_id_;  // The last answer, or kNobody; once merged, the union.
};

}  // namespace zoe
