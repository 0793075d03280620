#include <algorithm>
#include <set>
#include <tuple>

#include <gtest/gtest.h>

#include "engine/bvh/build_agglomerative.h"
#include "engine/bvh/build_sweep.h"
#include "tests/bvh/inputs.h"
#include "tests/math/random_inputs.h"

namespace zoe::test {
namespace {

using LeafSet = std::set<uint32_t>;

struct Greedy {
    std::set<LeafSet> clusters;  ///< Every cluster that was ever made, by its primitives.
    double area = 0.0;           ///< Half areas of all merges, summed.
};

/// The definition, by trying every pair every time: O(n^3).
Greedy greedy(const std::vector<Aabb>& boxes) {
    struct Cluster {
        Aabb bounds;
        LeafSet leaves;
        uint32_t id;
    };
    Greedy result;
    std::vector<Cluster> open;
    for (uint32_t k = 0; k < boxes.size(); ++k) {
        open.push_back({boxes[k], {k}, k});
        result.clusters.insert({k});
    }
    auto next_id = static_cast<uint32_t>(boxes.size());
    while (open.size() > 1) {
        size_t best_a = 0, best_b = 0;
        std::tuple<float, uint32_t, uint32_t> best{std::numeric_limits<float>::infinity(), 0xffffffffu, 0xffffffffu};
        for (size_t a = 0; a < open.size(); ++a) {
            for (size_t b = a + 1; b < open.size(); ++b) {
                const std::tuple key{merge(open[a].bounds, open[b].bounds).half_area(), std::min(open[a].id, open[b].id),
                                     std::max(open[a].id, open[b].id)};
                if (key < best) {
                    best = key;
                    best_a = a;
                    best_b = b;
                }
            }
        }
        Cluster merged{merge(open[best_a].bounds, open[best_b].bounds), open[best_a].leaves, next_id++};
        merged.leaves.insert(open[best_b].leaves.begin(), open[best_b].leaves.end());
        result.clusters.insert(merged.leaves);
        result.area += double{merged.bounds.half_area()};
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

TEST(Agglomerative, IsTheCubicGreedyOffTies) {
    for (uint64_t seed = 101; seed < 121; ++seed) {
        SCOPED_TRACE(::testing::Message() << "seed " << seed);
        Rng rng(seed);
        std::vector<Aabb> boxes;
        for (uint32_t k = 0; k < 3 + 6 * (seed - 101); ++k) {
            Aabb box;
            const glm::vec3 place = random_point(rng, 10.0f);
            const float size = log_uniform(rng, 0.01, 5.0);
            box.extend(place + random_point(rng, size));
            box.extend(place + random_point(rng, size));
            boxes.push_back(box);
        }
        const Greedy expected = greedy(boxes), actual = of_tree(build_agglomerative(boxes));
        EXPECT_EQ(actual.clusters, expected.clusters) << boxes.size() << " boxes";
        EXPECT_NEAR(actual.area, expected.area, 1e-9 * expected.area);
    }
}

TEST(Agglomerative, StaysWithinOnePercentOfTheGreedyOnTies) {
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
        EXPECT_NEAR(actual.area, expected.area, 0.01 * expected.area) << "input " << k;
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
