// The clusters' index, and the builder on it, against the same clustering by linear search.

#include "engine/bvh/cluster_index.h"

#include <algorithm>
#include <bit>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "engine/bvh/build_agglomerative.h"
#include "tests/bvh/box_distributions.h"
#include "tests/bvh/inputs.h"
#include "tests/bvh/linear_clustering.h"
#include "tests/math/random_inputs.h"
#include "tests/support/same_bits.h"

namespace zoe::test {
namespace {

using Boxes = std::vector<Aabb>;

bool is_same_tree(const Bvh& a, const Bvh& b) {
    return a.primitives == b.primitives && has_same_bits(a.nodes, b.nodes);
}

using Pairs = std::vector<std::pair<uint32_t, uint32_t>>;

std::vector<ListedCluster> listed(const Boxes& boxes) {
    std::vector<ListedCluster> list;
    for (const Aabb& box : boxes) list.push_back({grown(box), uint32_t(list.size())});
    return list;
}

/// Of one round.
Pairs merge_in_round(ClusterIndex* index) {
    std::vector<ClusterIndex::Pair> merged;
    index->find_partners();
    index->merge_mutual(&merged);
    Pairs pairs;
    for (const auto& [low, high] : merged) pairs.push_back({low, high});
    std::sort(pairs.begin(), pairs.end());
    return pairs;
}

/// Those that are each other's best partners, sorted.
Pairs mutual_pairs(const std::vector<ListedCluster>& list) {
    std::vector<size_t> partners;
    for (size_t k = 0; k < list.size(); ++k) partners.push_back(linear_best_partner(list, k));
    Pairs pairs;
    for (size_t k = 0; k < list.size(); ++k) {
        if (partners[partners[k]] == k && list[k].id < list[partners[k]].id)
            pairs.push_back({list[k].id, list[partners[k]].id});
    }
    std::sort(pairs.begin(), pairs.end());
    return pairs;
}

void merge_listed(const Pairs& pairs, std::vector<ListedCluster>* list) {
    for (const auto& [low, high] : pairs) {
        const auto at = [&](uint32_t id) { return std::ranges::find(*list, id, &ListedCluster::id); };
        const ListedCluster second = *at(high);
        list->erase(at(high));
        at(low)->bounds.extend(second.bounds);
        at(low)->box_count += second.box_count;
    }
}

TEST(ClusterIndex, MergesInRoundsWhatALinearSearchDoes) {
    uint64_t seed = 1000;
    for (const BoxDistribution& distribution : distributions()) {
        for (const uint32_t count : {2u, 3u, 4u, 5u, 16u, 17u, 65u, 150u, 290u}) {
            SCOPED_TRACE(::testing::Message() << distribution.name << ", " << count << " boxes, seed " << ++seed);
            const Boxes boxes = boxes_of(distribution, count, seed);
            std::vector<ListedCluster> list = listed(boxes);
            ClusterIndex index;
            index.start(boxes);
            for (int round = 0; list.size() > 1 && round < 40; ++round) {
                ASSERT_EQ(index.cluster_count(), list.size());
                const Pairs expected = mutual_pairs(list);
                ASSERT_EQ(merge_in_round(&index), expected);
                merge_listed(expected, &list);
            }
        }
    }
}

// In any order, after some rounds or none.
TEST(ClusterIndex, FindsWhatALinearSearchFindsWhateverIsMerged) {
    uint64_t seed = 1500;
    for (const BoxDistribution& distribution : distributions()) {
        for (const uint32_t count : {2u, 3u, 17u, 65u, 150u}) {
            SCOPED_TRACE(::testing::Message() << distribution.name << ", " << count << " boxes, seed " << ++seed);
            const Boxes boxes = boxes_of(distribution, count, seed);
            std::vector<ListedCluster> list = listed(boxes);
            ClusterIndex index;
            index.start(boxes);
            Rng rng(seed + 100000);
            for (uint32_t round = rng.below(3); list.size() > 1 && round > 0; --round) {
                merge_listed(merge_in_round(&index), &list);
            }
            while (list.size() > 1) {
                for (int query = 0; query < 4; ++query) {
                    const size_t k = rng.below(uint32_t(list.size()));
                    ASSERT_EQ(index.partner(list[k].id), list[linear_best_partner(list, k)].id) << "of " << list[k].id;
                }
                const Pairs mutual = mutual_pairs(list);
                const auto [low, high] = mutual[rng.below(uint32_t(mutual.size()))];
                index.merge({low, high});
                merge_listed({{low, high}}, &list);
                ASSERT_EQ(index.cluster_count(), list.size());
            }
        }
    }
}

TEST(ClusterIndex, GivesTheTreeOfALinearSearchBitForBit) {
    uint64_t seed = 2000;
    Bvh tree;  // Its memory is used again and again, as is the index's.
    for (const BoxDistribution& distribution : distributions()) {
        for (const uint32_t count :
             {1u, 2u, 3u, 4u, 5u, 6u, 15u, 16u, 17u, 31u, 64u, 65u, 100u, 129u, 200u, 257u, 400u, 600u}) {
            SCOPED_TRACE(::testing::Message() << distribution.name << ", " << count << " boxes, seed " << ++seed);
            const Boxes boxes = boxes_of(distribution, count, seed);
            tree = build_agglomerative(boxes, std::move(tree));
            ASSERT_TRUE(is_same_tree(tree, linear_clustering(boxes)));
            ASSERT_EQ(validate(tree, boxes), "");
        }
    }
}

TEST(ClusterIndex, GivesTheTreeOfALinearSearchOnManySeeds) {
    for (const BoxDistribution& distribution : distributions()) {
        for (uint64_t seed = 3000; seed < 3050; ++seed) {
            const Boxes boxes = boxes_of(distribution, 2 + uint32_t(seed * 7919 % 80), seed);
            ASSERT_TRUE(is_same_tree(build_agglomerative(boxes), linear_clustering(boxes)))
                << distribution.name << ", " << boxes.size() << " boxes, seed " << seed;
        }
    }
}

TEST(ClusterIndex, GivesTheTreeOfALinearSearchOnMeshes) {
    for (const TestMesh& mesh : nasty_meshes()) {
        Boxes boxes;
        for (const Aabb& box : mesh.boxes()) {
            if (!box.is_empty() && boxes.size() < 600) boxes.push_back(box);
        }
        EXPECT_TRUE(is_same_tree(build_agglomerative(boxes), linear_clustering(boxes))) << mesh.name;
    }
}

// What a linear search takes minutes for, all of them together.
TEST(ClusterIndex, TakesManyBoxesOfEveryKind) {
    for (const BoxDistribution& distribution : distributions()) {
        SCOPED_TRACE(distribution.name);
        const Boxes boxes = boxes_of(distribution, 5000, 4000);
        EXPECT_EQ(validate(build_agglomerative(boxes), boxes), "");
    }
}

TEST(ClusterIndex, MakesABalancedTreeOfCoincidentBoxes) {
    for (const float size : {0.0f, 1.0f}) {
        const Boxes boxes(100'000, Aabb{glm::vec3(-size), glm::vec3(size)});
        const Bvh bvh = build_agglomerative(boxes);
        EXPECT_EQ(validate(bvh, boxes), "");
        EXPECT_LE(depth(bvh), int(std::bit_width(boxes.size())) + 1);
    }
}

TEST(ClusterIndex, BuildsOnTwoThreadsAtOnce) {
    const Boxes boxes[2] = {boxes_of(distributions()[0], 2000, 5000), boxes_of(distributions()[4], 1500, 5001)};
    const Bvh expected[2] = {build_agglomerative(boxes[0]), build_agglomerative(boxes[1])};
    bool is_same[2] = {true, true};
    const auto build = [&](int which) {
        for (int round = 0; round < 5; ++round) {
            if (!is_same_tree(build_agglomerative(boxes[which]), expected[which])) is_same[which] = false;
        }
    };
    std::thread other(build, 1);
    build(0);
    other.join();
    EXPECT_TRUE(is_same[0]);
    EXPECT_TRUE(is_same[1]);
}

}  // namespace
}  // namespace zoe::test
