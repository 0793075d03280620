#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/bvh/cluster_search.h"

namespace zoe {

/// The clusters that agglomerative clustering has not merged yet, in a balanced tree that finds their best partners without
/// a look at all of them. A cluster's id is its lowest box's. The best partner is the one of the least key: see
/// `search_clusters`. A union makes no lesser key with any other cluster than one of its halves did, so clusters that are
/// each other's best partners stay so, whatever else merges.
/// Source     Walter, Bala, Kulkarni, Pingali. Fast Agglomerative Clustering for Rendering. IEEE RT 2008. Deviation: sixteen
///            wide; neighbours search together; sorted by size as well as by place; bounds on where boxes start and end, in
///            place of bounds on centres.
class ClusterIndex {
public:
    static constexpr uint32_t kNobody = 0xffffffffu;

    /// Two clusters that became one, by their lowest boxes.
    struct Pair {
        uint32_t low, high;
    };

    /// Starts anew, in the memory of the last time.
    /// boxes      [box_count] finite and not empty; box_count from 1, below 2^31.
    /// Cost       O(n log n), in parallel.
    void start(std::span<const Aabb> boxes);

    uint32_t cluster_count() const { return cluster_count_; }

    /// Finds the best partner of every cluster of which it is not known.
    /// Requires   two clusters or more.
    /// Cost       a search each, in parallel.
    void find_partners();

    /// Merges all that are each other's best partners.
    /// pairs      they are appended.
    /// Requires   `find_partners` just before it, and that nobody asked for a `partner` yet.
    /// Cost       O(clusters that searched), and O(n) each time that a quarter of the clusters is gone.
    void merge_mutual(std::vector<Pair>* pairs);

    /// The best partner of one cluster.
    /// Requires   two clusters or more; the id of one that is there.
    /// Cost       a search, unless it is known.
    uint32_t partner(uint32_t id);

    /// Merges two that are each other's best partners.
    /// Cost       O(log n), and as above.
    void merge(const Pair& pair);

private:
    // What clusters are sorted by.
    struct Item {
        float place_and_size[6];  // Centre, half extents.
        uint32_t id;
    };

    ClusterGroup& leaf_of(uint32_t slot) { return levels_[0][slot / ClusterGroup::kWidth]; }
    bool is_searching(uint32_t id) const {
        const uint32_t slot = slot_of_id_[id];
        return (searching_[slot / ClusterGroup::kWidth] >> slot % ClusterGroup::kWidth & 1) != 0;
    }
    void search_anew(uint32_t id);
    void find(uint32_t group, uint32_t lanes);
    void add_suitor(uint32_t id);
    void join(const Pair& pair);
    bool close_gaps();
    void split(size_t begin, size_t middle, size_t end);
    void sum_up();

    uint32_t cluster_count_ = 0;
    uint32_t slot_count_ = 0;  // Of level 0, that are or were in use: lane slot % 16 of group slot / 16.
    ClusterTree tree_{};
    std::array<std::vector<ClusterGroup>, ClusterTree::kMaxLevels> levels_;
    std::vector<Item> items_;  // Scratch of `start`.
    // By id, of clusters that are there.
    std::vector<uint32_t> slot_of_id_;
    std::vector<uint32_t> partner_of_id_;  // kNobody: it searches.
    std::vector<uint32_t> suitor_of_id_;   // One that it is the partner of, or kNobody;
    std::vector<uint32_t> next_suitor_;    // by a suitor's id: the next one.
    std::vector<uint16_t> searching_;      // By group of level 0: which lanes search, as bits.
    std::vector<uint32_t> search_groups_;  // Groups where some did, of the last `find_partners`.
};

}  // namespace zoe
