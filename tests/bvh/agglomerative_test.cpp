#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <tuple>

#include <gtest/gtest.h>

#include "engine/bvh/build_agglomerative.h"
#include "engine/bvh/build_sweep.h"
#include "engine/math/parallel.h"
#include "tests/bvh/each_target.h"
#include "tests/bvh/inputs.h"
#include "tests/math/random_inputs.h"
#include "tests/support/allocation_count.h"
#include "tests/support/same_bits.h"

namespace zoe::test {
namespace {

using LeafSet = std::set<uint32_t>;

struct Greedy {
    std::set<LeafSet> clusters;  ///< Every cluster that was ever made, by its primitives.
    double area = 0.0;           ///< Half areas of all merges, summed.
    bool has_near_ties = false;  ///< Some merge was as good as another of one of the two, but for rounding to float.
};

/// The definition, by trying every pair every time: O(n^3). In double precision.
Greedy greedy(const std::vector<Aabb>& boxes) {
    struct Cluster {
        Aabb bounds;
        LeafSet leaves;
    };
    Greedy result;
    std::vector<Cluster> open;
    for (uint32_t k = 0; k < boxes.size(); ++k) {
        open.push_back({boxes[k], {k}});
        result.clusters.insert({k});
    }
    while (open.size() > 1) {
        size_t best_a = 0, best_b = 0;
        using Key = std::tuple<double, size_t, uint32_t, uint32_t>;
        Key best{std::numeric_limits<double>::infinity(), 0, 0, 0};
        const auto key = [&open](size_t a, size_t b) {
            const uint32_t first = *open[a].leaves.begin(), second = *open[b].leaves.begin();
            return Key{merge(open[a].bounds, open[b].bounds).half_area(), open[a].leaves.size() + open[b].leaves.size(),
                       std::min(first, second), std::max(first, second)};
        };
        for (size_t a = 0; a < open.size(); ++a) {
            for (size_t b = a + 1; b < open.size(); ++b) {
                if (!(key(a, b) < best)) continue;
                best = key(a, b);
                best_a = a;
                best_b = b;
            }
        }
        const double area = std::get<0>(best);
        for (size_t k = 0; k < open.size(); ++k) {
            if (k == best_a || k == best_b) continue;
            for (const size_t half : {best_a, best_b}) {
                const double other = std::get<0>(key(half, k));
                result.has_near_ties |= other != area && other < area * (1.0 + 1e-6);
            }
        }
        Cluster merged{merge(open[best_a].bounds, open[best_b].bounds), open[best_a].leaves};
        merged.leaves.insert(open[best_b].leaves.begin(), open[best_b].leaves.end());
        result.clusters.insert(merged.leaves);
        result.area += area;
        open.erase(open.begin() + ptrdiff_t(best_b));
        open.erase(open.begin() + ptrdiff_t(best_a));
        open.push_back(merged);
    }
    return result;
}

Greedy of_tree(const Bvh& bvh) {
    Greedy result;
    std::vector<LeafSet> leaves(bvh.nodes.size());
    for (size_t k = bvh.nodes.size(); k-- > 0;) {
        const BvhNode& node = bvh.nodes[k];
        if (node.is_leaf()) {
            EXPECT_EQ(node.count, 1u) << "leaves hold one primitive";
            leaves[k] = {bvh.primitives[node.first]};
        } else {
            leaves[k] = leaves[node.first];
            leaves[k].insert(leaves[node.first + 1].begin(), leaves[node.first + 1].end());
            result.area += double{node.bounds().half_area()};
        }
        result.clusters.insert(leaves[k]);
    }
    return result;
}

Aabb about(Rng& rng, const glm::vec3& place, float size) {
    Aabb box;
    box.extend(place + random_point(rng, size));
    box.extend(place + random_point(rng, size));
    return box;
}

/// Of seven kinds.
std::vector<Aabb> small_scene(uint64_t seed) {
    Rng rng(seed);
    std::vector<Aabb> boxes;
    const uint32_t count = 2 + rng.below(29);
    for (uint32_t k = 0; k < count; ++k) {
        switch (seed % 7) {
            case 0:  // Uniform.
                boxes.push_back(about(rng, random_point(rng, 10.0f), log_uniform(rng, 0.01, 5.0)));
                break;
            case 1: {  // Clustered.
                Rng cluster(seed + k % 4);
                boxes.push_back(about(rng, random_point(cluster, 100.0f) + random_point(rng, 3.0f), 0.5f));
                break;
            }
            case 2:  // A stadium.
                boxes.push_back(k == count / 2 ? about(rng, glm::vec3(0), 300.0f)
                                               : about(rng, random_point(rng, 50.0f), 0.3f));
                break;
            case 3:  // Growing spacing.
                boxes.push_back(about(rng, {std::pow(1.3f, float(k)), rng.uniform(), 0}, 0.2f));
                break;
            case 4: {  // A grid.
                const glm::vec3 place(k % 3, k / 3 % 3, k / 9);
                boxes.push_back({place, place + 0.5f});
                break;
            }
            case 5: {  // A grid with many copies.
                const glm::vec3 place(rng.below(3), rng.below(3), rng.below(3));
                boxes.push_back({place, place + 1.0f});
                break;
            }
            default:  // Coincident.
                boxes.push_back({glm::vec3(-1), glm::vec3(2)});
        }
    }
    return boxes;
}

// Ties included: of equal areas, boxes and ids decide, which do not depend on what was merged first.
TEST(Agglomerative, IsTheCubicGreedyOnAThousandScenes) {
    int compared_count = 0;
    for (uint64_t seed = 100'000; seed < 101'000; ++seed) {
        SCOPED_TRACE(::testing::Message() << "seed " << seed);
        const std::vector<Aabb> boxes = small_scene(seed);
        const Greedy expected = greedy(boxes), actual = of_tree(build_agglomerative(boxes));
        if (expected.has_near_ties) continue;
        ++compared_count;
        ASSERT_EQ(actual.clusters, expected.clusters) << boxes.size() << " boxes";
        EXPECT_NEAR(actual.area, expected.area, 1e-12 * expected.area);
    }
    EXPECT_GE(compared_count, 990);
}

// Enough of them for a tree of groups.
TEST(Agglomerative, IsTheCubicGreedyOfManyBoxes) {
    for (uint64_t seed = 101; seed < 105; ++seed) {
        SCOPED_TRACE(::testing::Message() << "seed " << seed);
        Rng rng(seed);
        std::vector<Aabb> boxes;
        for (int k = 0; k < 260; ++k) boxes.push_back(about(rng, random_point(rng, 10.0f), log_uniform(rng, 0.1, 0.5)));
        const Greedy expected = greedy(boxes), actual = of_tree(build_agglomerative(boxes));
        ASSERT_FALSE(expected.has_near_ties);
        EXPECT_EQ(actual.clusters, expected.clusters) << boxes.size() << " boxes";
    }
}

bool is_same_tree(const Bvh& a, const Bvh& b) {
    return a.primitives == b.primitives && has_same_bits(a.nodes, b.nodes);
}

TEST(Agglomerative, IsTheCubicGreedyOnTies) {
    std::vector<std::vector<Aabb>> inputs(4);
    for (int y = 0; y < 8; ++y) {
        for (int x = 0; x < 8; ++x) inputs[0].push_back({glm::vec3(x, y, 0), glm::vec3(x, y, 0) + 0.5f});
    }
    for (int z = 0; z < 4; ++z) {
        for (int y = 0; y < 4; ++y) {
            for (int x = 0; x < 4; ++x) inputs[1].push_back({glm::vec3(x, y, z), glm::vec3(x, y, z) + 1.0f});
        }
    }
    for (int k = 0; k < 60; ++k) inputs[2].push_back({glm::vec3(k, 0, 0), glm::vec3(k + 1, 1, 1)});
    for (int k = 0; k < 60; ++k) inputs[3].push_back({glm::vec3(k / 10, 0, 0), glm::vec3(k / 10 + 1, 1, 1)});
    for (size_t k = 0; k < inputs.size(); ++k) {
        const Greedy expected = greedy(inputs[k]), actual = of_tree(build_agglomerative(inputs[k]));
        EXPECT_EQ(actual.clusters, expected.clusters) << "input " << k;
    }
}

TEST(Agglomerative, EndsOnCoincidentBoxes) {
    const Aabb box{{-1, 0, 2}, {1, 3, 5}};
    const Aabb point{{1, 1, 1}, {1, 1, 1}};
    for (const Aabb& copy : {box, point}) {
        const std::vector<Aabb> boxes(2000, copy);
        const Bvh bvh = build_agglomerative(boxes);
        EXPECT_EQ(validate(bvh, boxes), "");
        EXPECT_EQ(bvh.nodes.size(), 2 * boxes.size() - 1);
    }
}

TEST(Agglomerative, EndsWhereAreasOverflow) {
    const float huge = std::numeric_limits<float>::max();
    std::vector<Aabb> boxes;
    for (int k = 0; k < 40; ++k) {
        const float s = huge * (1.0f - 0.01f * k);
        boxes.push_back({glm::vec3(-s), glm::vec3(s)});
        boxes.push_back({glm::vec3(-s, 0, 0), glm::vec3(s, 0, 0)});  // Infinity times 0 in the area.
        boxes.push_back({glm::vec3(s, s, 0), glm::vec3(s, s, 0)});
    }
    EXPECT_EQ(validate(build_agglomerative(boxes), boxes), "");
}

TEST(Agglomerative, TakesNoBoxesAndOneAndTwo) {
    const Aabb box{{-1, 0, 2}, {1, 3, 5}}, other{{4, 0, 2}, {5, 3, 5}};
    for (const std::vector<Aabb>& boxes : {std::vector<Aabb>{}, {box}, {box, other}, {box, box}}) {
        const Bvh bvh = build_agglomerative(boxes);
        EXPECT_EQ(validate(bvh, boxes), "");
        EXPECT_EQ(bvh.nodes.size(), boxes.empty() ? 0 : 2 * boxes.size() - 1);
    }
}

TEST(Agglomerative, TakesBoxesThatAreNone) {
    const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
    const Aabb none[] = {{},
                         {{nan, 0, 0}, {1, 1, 1}},
                         {{0, 0, 0}, {1, nan, 1}},
                         {{0, -infinity, 0}, {1, 1, 1}},
                         {{0, 0, 0}, {1, 1, infinity}},
                         {{2, 0, 0}, {1, 1, 1}}};
    Rng rng(140);
    for (const uint32_t one_in : {1, 2, 50}) {  // So many are boxes; 1: none is.
        std::vector<Aabb> boxes, proper;
        for (uint32_t k = 0; k < 3000; ++k) {
            const bool is_box = one_in > 1 && rng.below(one_in) != 0;
            boxes.push_back(is_box ? about(rng, random_point(rng, 10.0f), 0.1) : none[rng.below(6)]);
            if (boxes.back().is_proper()) proper.push_back(boxes.back());
        }
        const Bvh bvh = build_agglomerative(boxes);
        EXPECT_EQ(validate(bvh, boxes), "") << "one in " << one_in << ", seed 140";
        // The others' tree is the one that they have by themselves, and the root is over it.
        const auto sum_up = [](const Bvh& tree) {
            std::pair<double, size_t> sum;
            for (const BvhNode& node : tree.nodes) {
                if (node.bounds().is_empty()) continue;
                sum.first += node.bounds().half_area();
                ++sum.second;
            }
            return sum;
        };
        const auto [all_area, all_count] = sum_up(bvh);
        const auto [own_area, own_count] = sum_up(build_agglomerative(proper));
        EXPECT_EQ(all_count, own_count + (proper.empty() ? 0 : 1)) << one_in;
        EXPECT_NEAR(all_area, own_area + (proper.empty() ? 0.0 : bvh.nodes[0].bounds().half_area()), 1e-6 * own_area)
            << one_in;
    }
}

TEST(Agglomerative, IsTheSameOnAnyNumberOfThreadsAndEveryInstructionSet) {
    Rng rng(130);
    std::vector<Aabb> boxes;
    for (int k = 0; k < 5000; ++k) boxes.push_back(about(rng, random_point(rng, 10.0f), log_uniform(rng, 1e-3, 1.0)));
    set_thread_count(1);
    const Bvh expected = build_agglomerative(boxes);
    for (const int threads : {2, 3, 7}) {
        set_thread_count(threads);
        EXPECT_TRUE(is_same_tree(build_agglomerative(boxes), expected)) << threads << " threads, seed 130";
    }
    set_thread_count(0);
    on_each_target([&] { EXPECT_TRUE(is_same_tree(build_agglomerative(boxes), expected)) << "seed 130"; });
}

TEST(Agglomerative, AllocatesNothingTheSecondTime) {
    set_thread_count(1);  // With more, the scheduler allocates its own tasks.
    const std::vector<Aabb> boxes = random_soup(5000, 1.0f, 131).boxes(), others = random_soup(5000, 1.0f, 132).boxes();
    Bvh bvh = build_agglomerative(others);
    const size_t before = allocation_count();
    bvh = build_agglomerative(boxes, std::move(bvh));
    EXPECT_EQ(allocation_count() - before, 0u);
    set_thread_count(0);
}

TEST(Agglomerative, PermutingTheBoxesPermutesTheTreeOnly) {
    const std::vector<Aabb> boxes = random_soup(100, 1.0f, 121).boxes();
    std::vector<uint32_t> old_of_new(boxes.size());
    for (uint32_t k = 0; k < boxes.size(); ++k) old_of_new[k] = k;
    Rng rng(122);
    for (uint32_t k = 100; k > 1; --k) std::swap(old_of_new[k - 1], old_of_new[rng.below(k)]);
    std::vector<Aabb> permuted;
    for (const uint32_t k : old_of_new) permuted.push_back(boxes[k]);
    std::set<LeafSet> renamed;
    for (const LeafSet& cluster : of_tree(build_agglomerative(permuted)).clusters) {
        LeafSet names;
        for (const uint32_t k : cluster) names.insert(old_of_new[k]);
        renamed.insert(names);
    }
    EXPECT_EQ(renamed, of_tree(build_agglomerative(boxes)).clusters);
}

}  // namespace
}  // namespace zoe::test
