#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "engine/math/aabb.h"

namespace zoe {

/// The clusters that agglomerative clustering has not merged yet, in a balanced tree that finds a cluster's best partner
/// without a look at all of them. Clusters have ids: the boxes first, then unions in the order made. A pair's key is (half
/// area of its union, lower id, higher id); the best partner is the one with the least key, exactly.
/// Source     Walter, Bala, Kulkarni, Pingali. Fast Agglomerative Clustering for Rendering. IEEE RT 2008. Deviation: four
///            wide; sorted by size as well as by place; bounds on where boxes start and end, in place of bounds on centres.
class ClusterIndex {
public:
    static constexpr uint32_t kNobody = 0xffffffffu;

    /// Starts anew, in the memory of the last time.
    /// boxes      [box_count] finite and not empty; box_count from 1 to 2^31.
    /// Cost       O(n log n).
    void start(std::span<const Aabb> boxes);

    uint32_t cluster_count() const { return cluster_count_; }

    /// Requires   a cluster that was not merged, here and below.
    Aabb bounds(uint32_t id) const;

    /// The cluster that makes the least key with this one.
    /// guess      another cluster, to compare with first, or kNobody: a good one saves time and changes nothing else.
    /// Requires   two clusters or more.
    /// Cost       about log n where boxes have places or sizes of their own, at most n; at once if the last answer still
    /// holds.
    uint32_t best_partner(uint32_t id, uint32_t guess);

    /// Replaces two clusters by their union.
    /// Returns    its id: the next one.
    /// Cost       O(log n), and O(n log n) each time that half of the clusters are gone.
    uint32_t merge(uint32_t a, uint32_t b);

private:
    static constexpr uint32_t kWidth = 4;
    static constexpr uint32_t kMaxLevels = 16;  // kWidth^16 clusters.

    struct Cluster {
        Aabb bounds;
        uint32_t id;
    };

    // What holds for all clusters of a subtree; of a single one, its own box, size and id. The initial values are of no
    // cluster at all: the neutral ones, which make every union infinite.
    struct Summary {
        glm::vec3 max_lo{-std::numeric_limits<float>::infinity()};     // No box starts after it,
        glm::vec3 min_hi{std::numeric_limits<float>::infinity()};      // none ends before it,
        glm::vec3 min_extent{std::numeric_limits<float>::infinity()};  // and none is smaller.
        uint32_t min_id = kNobody;

        bool operator==(const Summary&) const = default;
    };

    // Four summaries by component. In level 0 the lanes are clusters, above they are the groups of the level below:
    // lane k % 4 of group k / 4 sums up group k.
    struct Group {
        float max_lo[3][kWidth];
        float min_hi[3][kWidth];
        float min_extent[3][kWidth];
        uint32_t min_id[kWidth];

        Summary lane(uint32_t lane) const;
        void set_lane(uint32_t lane, const Summary& summary);
        Summary sum() const;
    };

    // Pairs in one strict order: a chain of ever better pairs cannot turn in a circle.
    struct Key {
        double half_area;
        uint32_t lower, higher;

        friend bool operator<(const Key& a, const Key& b) {
            if (a.half_area != b.half_area) return a.half_area < b.half_area;
            if (a.lower != b.lower) return a.lower < b.lower;
            return a.higher < b.higher;
        }
    };

    // A group that may hold a better partner: no key in it is less than this one.
    struct OpenGroup {
        Key least;
        uint32_t level, group;
    };

    struct Search {
        Cluster cluster;
        Key best;
        uint32_t partner;
        uint32_t open_count;
        std::array<OpenGroup, kWidth * kMaxLevels> open;  // A step takes one and adds at most four of the level below it.
    };

    Group& group(uint32_t level, uint32_t k) { return groups_[level_begin_[level] + k]; }
    uint32_t group_count(uint32_t level) const { return level_begin_[level + 1] - level_begin_[level]; }

    void rebuild();
    void split(size_t begin, size_t middle, size_t end);
    void refit(uint32_t slot);
    void look_into(uint32_t level, uint32_t group, uint32_t skipped_lane, Search* search);

    uint32_t cluster_count_ = 0;
    uint32_t rebuild_count_ = 0;  // So few clusters left, and the tree is built anew.
    uint32_t level_count_ = 0;
    std::array<uint32_t, kMaxLevels + 1> level_begin_{};  // First group of each level; the last level is one group.
    std::vector<Group> groups_;
    std::vector<Cluster> sorted_;          // Scratch of rebuild.
    std::vector<uint32_t> slot_of_id_;     // Lane slot % 4 of group slot / 4 of level 0; kNobody once merged.
    std::vector<uint32_t> partner_of_id_;  // The last answer, or kNobody.
};

}  // namespace zoe
