// The clusters' index, and the builder on it, against the same clustering by linear search.

#include "engine/bvh/cluster_index.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <limits>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "engine/bvh/build_agglomerative.h"
#include "tests/bvh/inputs.h"
#include "tests/bvh/linear_clustering.h"
#include "tests/math/random_inputs.h"
#include "tests/support/same_bits.h"

namespace zoe::test {
namespace {

using Boxes = std::vector<Aabb>;

struct Distribution {
    const char* name;
    std::function<Aabb(Rng&, uint32_t k, uint32_t count)> box;
};

Aabb about(Rng& rng, const glm::vec3& place, float size) {
    Aabb box;
    box.extend(place + random_point(rng, size));
    box.extend(place + random_point(rng, size));
    return box;
}

glm::vec3 random_corner(Rng& rng, uint32_t size) {
    const auto x = float(rng.below(size)), y = float(rng.below(size)), z = float(rng.below(size));
    return {x, y, z};
}

const std::vector<Distribution>& distributions() {
    static const std::vector<Distribution> list = {
        {"spread", [](Rng& rng, uint32_t, uint32_t) { return about(rng, random_point(rng, 10), 0.5f); }},
        {"overlapping", [](Rng& rng, uint32_t, uint32_t) { return about(rng, random_point(rng, 10), 10); }},
        {"many sizes",
         [](Rng& rng, uint32_t, uint32_t) { return about(rng, random_point(rng, 10), log_uniform(rng, 1e-6, 1e3)); }},
        {"many scales",
         [](Rng& rng, uint32_t, uint32_t) {
             const float scale = log_uniform(rng, 1e-30, 1e30);
             return about(rng, random_point(rng, scale), scale);
         }},
        {"integer boxes",
         [](Rng& rng, uint32_t, uint32_t) {
             const glm::vec3 lo = random_corner(rng, 6);
             return Aabb{lo, lo + random_corner(rng, 3)};
         }},
        {"integer boxes, negative zeros",
         [](Rng& rng, uint32_t, uint32_t) {
             const glm::vec3 lo = random_corner(rng, 3) - 1.0f;
             Aabb box{lo, lo + random_corner(rng, 2)};
             for (int axis = 0; axis < 3; ++axis) {
                 if (box.lo[axis] == 0.0f && rng.below(2)) box.lo[axis] = -0.0f;
                 if (box.hi[axis] == 0.0f && rng.below(2)) box.hi[axis] = -0.0f;
             }
             return box;
         }},
        {"integer points",
         [](Rng& rng, uint32_t, uint32_t) {
             const glm::vec3 p = random_corner(rng, 7);
             return Aabb{p, p};
         }},
        {"a grid",
         [](Rng&, uint32_t k, uint32_t) {
             const glm::vec3 p(k % 8, k / 8 % 8, k / 64);
             return Aabb{p, p + 1.0f};
         }},
        {"coincident",
         [](Rng&, uint32_t, uint32_t) {
             return Aabb{{-1, 0, 2}, {1, 3, 5}};
         }},
        {"one of three",
         [](Rng& rng, uint32_t, uint32_t) {
             const auto s = float(rng.below(3));
             return Aabb{glm::vec3(-s), glm::vec3(s)};
         }},
        {"concentric",
         [](Rng& rng, uint32_t, uint32_t) {
             const float s = rng.uniform(0.1f, 10.0f);
             return Aabb{glm::vec3(-s), glm::vec3(s)};
         }},
        {"points", [](Rng& rng, uint32_t, uint32_t) { return about(rng, random_point(rng, 10), 0); }},
        {"points on a line",
         [](Rng& rng, uint32_t, uint32_t) {
             return about(rng, {rng.uniform(), 0, 0}, 0);
         }},
        {"points in a plane",
         [](Rng& rng, uint32_t, uint32_t) {
             return about(rng, {rng.uniform(), 1, rng.uniform()}, 0);
         }},
        {"boxes on a line",
         [](Rng&, uint32_t k, uint32_t) {
             return Aabb{glm::vec3(k, 0, 0), glm::vec3(k + 1, 1, 1)};
         }},
        {"ever wider apart",
         [](Rng&, uint32_t k, uint32_t) {
             const float x = std::ldexp(1.0f, int(k % 200) - 100);
             return Aabb{{x, 0, 0}, {1.5f * x, 0.1f * x, float(k / 200)}};
         }},
        {"sticks",
         [](Rng& rng, uint32_t k, uint32_t) {
             const glm::vec3 place = random_point(rng, 10);
             glm::vec3 half(0.01f);
             half[int(k % 3)] = 10.0f;
             return Aabb{place - half, place + half};
         }},
        {"one huge box over small ones",
         [](Rng& rng, uint32_t k, uint32_t count) {
             if (k == count / 2) return Aabb{glm::vec3(-100), glm::vec3(100)};
             return about(rng, random_point(rng, 10), 0.1f);
         }},
        {"16 places far apart",
         [](Rng& rng, uint32_t k, uint32_t) {
             return about(rng, glm::vec3(1e6f * float(k % 4), 1e6f * float(k / 4 % 4), 0) + random_point(rng, 10), 0.5f);
         }},
        {"half of them at 1e18",
         [](Rng& rng, uint32_t k, uint32_t) { return about(rng, random_point(rng, 10) + (k % 2 ? 1e18f : 0.0f), 0.5f); }},
        {"as huge as floats go",
         [](Rng& rng, uint32_t k, uint32_t) {
             const float s = std::numeric_limits<float>::max() * rng.uniform(0.5f, 1.0f);
             if (k % 3 == 0) return Aabb{glm::vec3(-s), glm::vec3(s)};
             if (k % 3 == 1) return Aabb{glm::vec3(-s, 0, 0), glm::vec3(s, 0, 0)};
             return Aabb{glm::vec3(s, s, 0), glm::vec3(s, s, 0)};
         }},
        {"denormal", [](Rng& rng, uint32_t, uint32_t) { return about(rng, random_point(rng, 1e-40f), 1e-41f); }},
    };
    return list;
}

Boxes boxes_of(const Distribution& distribution, uint32_t count, uint64_t seed) {
    Rng rng(seed);
    Boxes boxes;
    for (uint32_t k = 0; k < count; ++k) boxes.push_back(distribution.box(rng, k, count));
    return boxes;
}

bool is_same_tree(const Bvh& a, const Bvh& b) {
    return a.primitives == b.primitives && has_same_bits(a.nodes, b.nodes);
}

using Pairs = std::vector<std::pair<uint32_t, uint32_t>>;

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
    for (const Distribution& distribution : distributions()) {
        for (const uint32_t count : {2u, 3u, 4u, 5u, 16u, 17u, 65u, 150u, 290u}) {
            SCOPED_TRACE(::testing::Message() << distribution.name << ", " << count << " boxes, seed " << ++seed);
            const Boxes boxes = boxes_of(distribution, count, seed);
            std::vector<ListedCluster> list;
            for (uint32_t k = 0; k < count; ++k) list.push_back({boxes[k], k});
            ClusterIndex index;
            index.start(boxes);
            for (int round = 0; list.size() > 1 && round < 40; ++round) {
                ASSERT_EQ(index.cluster_count(), list.size());
                index.find_partners();
                const Pairs expected = mutual_pairs(list);
                std::vector<ClusterIndex::Pair> merged;
                index.merge_mutual(&merged);
                Pairs actual;
                for (const auto& [low, high] : merged) actual.push_back({low, high});
                std::sort(actual.begin(), actual.end());
                ASSERT_EQ(actual, expected);
                merge_listed(expected, &list);
            }
        }
    }
}

// In any order, after some rounds or none.
TEST(ClusterIndex, FindsWhatALinearSearchFindsWhateverIsMerged) {
    uint64_t seed = 1500;
    for (const Distribution& distribution : distributions()) {
        for (const uint32_t count : {2u, 3u, 17u, 65u, 150u}) {
            SCOPED_TRACE(::testing::Message() << distribution.name << ", " << count << " boxes, seed " << ++seed);
            const Boxes boxes = boxes_of(distribution, count, seed);
            std::vector<ListedCluster> list;
            for (uint32_t k = 0; k < count; ++k) list.push_back({boxes[k], k});
            ClusterIndex index;
            index.start(boxes);
            Rng rng(seed + 100000);
            for (uint32_t round = rng.below(3); list.size() > 1 && round > 0; --round) {
                std::vector<ClusterIndex::Pair> merged;
                index.find_partners();
                index.merge_mutual(&merged);
                merge_listed(mutual_pairs(list), &list);
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
    for (const Distribution& distribution : distributions()) {
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
    for (const Distribution& distribution : distributions()) {
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
    for (const Distribution& distribution : distributions()) {
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
