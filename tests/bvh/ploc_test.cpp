// Locally-ordered clustering in Morton order: what the other builders' tests do not ask of it.

#include "engine/bvh/build_ploc.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <tuple>

#include <gtest/gtest.h>

#include "engine/bvh/build_agglomerative.h"
#include "engine/bvh/build_binned.h"
#include "engine/math/parallel.h"
#include "tests/bvh/each_target.h"
#include "tests/bvh/inputs.h"
#include "tests/math/random_inputs.h"
#include "tests/support/allocation_count.h"
#include "tests/support/same_bits.h"

namespace zoe::test {
namespace {

using Boxes = std::vector<Aabb>;

Bvh ploc(const Boxes& boxes, uint32_t search_radius = PlocConfig{}.search_radius,
         uint32_t top_count = PlocConfig{}.top_count) {
    PlocScratch scratch;
    return build_ploc(boxes, {.search_radius = search_radius, .top_count = top_count}, {}, &scratch);
}

Aabb about(const glm::vec3& place, float size) {
    return {place - size, place + size};
}

Boxes spread(int count, uint64_t seed, float size = 0.2f) {
    Rng rng(seed);
    Boxes boxes;
    for (int k = 0; k < count; ++k) {
        Aabb box;
        const glm::vec3 place = random_point(rng, 10.0f);
        box.extend(place + random_point(rng, size));
        box.extend(place + random_point(rng, size));
        boxes.push_back(box);
    }
    return boxes;
}

bool is_same_tree(const Bvh& a, const Bvh& b) {
    return a.primitives == b.primitives && has_same_bits(a.nodes, b.nodes);
}

// Of inner nodes below the root: the others' are the same whatever the tree.
double sum_of_areas(const Bvh& bvh) {
    double sum = 0.0;
    for (size_t k = 1; k < bvh.nodes.size(); ++k) sum += bvh.nodes[k].is_leaf() ? 0.0 : bvh.nodes[k].bounds().half_area();
    return sum;
}

std::set<std::set<uint32_t>> clusters_of(const Bvh& bvh) {
    std::vector<std::set<uint32_t>> leaves(bvh.nodes.size());
    for (size_t k = bvh.nodes.size(); k-- > 0;) {
        const BvhNode& node = bvh.nodes[k];
        if (node.is_leaf()) {
            leaves[k] = {bvh.primitives[node.first]};
        } else {
            leaves[k] = leaves[node.first];
            leaves[k].insert(leaves[node.first + 1].begin(), leaves[node.first + 1].end());
        }
    }
    return {leaves.begin(), leaves.end()};
}

TEST(Ploc, TakesNoBoxesAndFew) {
    PlocScratch scratch;
    EXPECT_TRUE(build_ploc({}, {}, ploc(spread(10, 1)), &scratch).nodes.empty());
    for (int count = 1; count <= 40; ++count) {
        const Boxes boxes = spread(count, 300 + uint64_t(count));
        for (const uint32_t radius : {0u, 1u, 3u, 16u, 1000u, 0xffffffffu}) {
            const Bvh bvh = ploc(boxes, radius);
            ASSERT_EQ(validate(bvh, boxes), "") << count << " boxes, radius " << radius;
            ASSERT_EQ(bvh.nodes.size(), 2 * boxes.size() - 1);
        }
    }
}

TEST(Ploc, LookingEverywhereIsExactOffTies) {
    for (uint64_t seed = 310; seed < 330; ++seed) {
        // So small that hardly any lie in each other, which makes ties.
        const Boxes boxes = spread(int(5 + 17 * (seed - 310)), seed, 0.01f);
        const Bvh everywhere = ploc(boxes, uint32_t(boxes.size()), 1);
        EXPECT_EQ(clusters_of(everywhere), clusters_of(build_agglomerative(boxes))) << "seed " << seed;
    }
}

TEST(Ploc, KeepsToTheLogarithmWhereBoxesCoincide) {
    const Boxes boxes(100'000, about({1, 2, 3}, 0.5f)), points(100'000, about({1, 2, 3}, 0.0f));
    for (const Boxes* input : {&boxes, &points}) {
        const Bvh bvh = ploc(*input);
        EXPECT_EQ(validate(bvh, *input), "");
        EXPECT_LE(depth(bvh), 19);
    }
}

TEST(Ploc, IsAboutTwiceTheLogarithmDeepInUsualScenes) {
    for (const int count : {300, 3000, 30'000, 300'000}) {
        for (const uint32_t radius : {1u, 8u}) {
            const Bvh bvh = ploc(spread(count, 335), radius);
            EXPECT_LE(depth(bvh), 2.0 * std::log2(count)) << count << " boxes, radius " << radius << ", seed 335";
        }
    }
}

// Far below what the docstring has: no input is known that comes near that.
constexpr int kDeepest = 60;

// Where each box is nearer to the one before it than to the next, only the first two choose each other.
TEST(Ploc, IsNotDeepWhereGapsGrow) {
    Rng rng(345);
    Boxes by_squares, by_factors, nested, shuffled;
    for (int k = 0; k < 100'000; ++k) by_squares.push_back(about({float(k) * float(k), 0, 0}, 0.1f));
    for (int k = 0; k < 20'000; ++k) by_factors.push_back(about({std::exp(0.002f * float(k)), 0, 0}, 0.1f));
    for (int k = 0; k < 20'000; ++k) nested.push_back(about(glm::vec3(0), 1.0f + 0.001f * float(k)));
    shuffled = nested;
    for (size_t k = shuffled.size(); k > 1; --k) std::swap(shuffled[k - 1], shuffled[rng.below(uint32_t(k))]);
    for (const Boxes* boxes : {&by_squares, &by_factors, &nested, &shuffled}) {
        for (const uint32_t radius : {1u, 8u}) {
            const Bvh bvh = ploc(*boxes, radius);
            EXPECT_EQ(validate(bvh, *boxes), "");
            EXPECT_LE(depth(bvh), kDeepest) << boxes->size() << " boxes, radius " << radius << ", seed 345";
        }
    }
}

TEST(Ploc, TakesBoxesThatAreNone) {
    const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
    const float huge = std::numeric_limits<float>::max();
    Rng rng(340);
    for (const int one_in : {1, 2, 100}) {  // One in so many is well-formed; 1: one in seven.
        Boxes boxes;
        for (int k = 0; k < 20'000; ++k) {
            Aabb box = about(random_point(rng, 1.0f), 0.01f);
            if (k % one_in != 0 || one_in == 1) {
                switch (rng.below(one_in == 1 ? 7 : 6)) {
                    case 0:
                        box = {};
                        break;
                    case 1:
                        box = about(glm::vec3(0), inf);
                        break;
                    case 2:
                        box.lo[int(rng.below(3))] = nan;
                        break;
                    case 3:
                        box.hi[int(rng.below(3))] = inf;
                        break;
                    case 4:
                        box = about(glm::vec3(0), huge);
                        break;
                    case 5:
                        box = {glm::vec3(-huge, 0, 0), glm::vec3(huge, 0, 0)};  // Infinity times 0 in the area.
                        break;
                    default:
                        break;
                }
            }
            boxes.push_back(box);
        }
        for (const uint32_t radius : {1u, 8u}) {
            const Bvh bvh = ploc(boxes, radius);
            EXPECT_EQ(validate(bvh, boxes), "");
            EXPECT_LE(depth(bvh), kDeepest) << "one in " << one_in << ", radius " << radius;
        }
    }
    const Boxes none(1000, Aabb{}), broken(1000, about(glm::vec3(nan), 1.0f));
    for (const Boxes* boxes : {&none, &broken}) {
        const Bvh bvh = ploc(*boxes);
        EXPECT_EQ(validate(bvh, *boxes), "");
        EXPECT_TRUE(bvh.bounds().is_empty());
        EXPECT_LE(depth(bvh), 12);
    }
}

TEST(Ploc, IsTheSameOnAnyNumberOfThreads) {
    Boxes gaps;
    for (int k = 0; k < 20'000; ++k) gaps.push_back(about({float(k) * float(k), 0, 0}, 0.1f));
    for (const Boxes& boxes : {spread(70'000, 350), gaps}) {
        set_thread_count(1);
        const Bvh expected = ploc(boxes);
        for (const int threads : {2, 5}) {
            set_thread_count(threads);
            EXPECT_TRUE(is_same_tree(ploc(boxes), expected)) << threads << " threads";
        }
    }
    set_thread_count(0);
}

TEST(Ploc, IsTheSameOnEveryInstructionSet) {
    const Boxes boxes = spread(3000, 355), coincident(500, about({1, 2, 3}, 0.5f));
    const Bvh expected[] = {ploc(boxes), ploc(boxes, 100), ploc(coincident)};
    on_each_target([&] {
        EXPECT_TRUE(is_same_tree(ploc(boxes), expected[0]));
        EXPECT_TRUE(is_same_tree(ploc(boxes, 100), expected[1]));
        EXPECT_TRUE(is_same_tree(ploc(coincident), expected[2]));
    });
}

TEST(Ploc, AllocatesNothingTheSecondTimeAndChangesNothing) {
    set_thread_count(1);
    const Boxes boxes = spread(20'000, 360), others = spread(20'000, 361);
    const Bvh expected = ploc(boxes);
    PlocScratch scratch;
    Bvh bvh = build_ploc(others, {}, {}, &scratch);
    const size_t before = allocation_count();
    bvh = build_ploc(boxes, {}, std::move(bvh), &scratch);
    EXPECT_EQ(allocation_count() - before, 0u);
    EXPECT_TRUE(is_same_tree(bvh, expected));
    set_thread_count(0);
}

// All others may fall into one cell of a grid that spans it, too.
TEST(Ploc, OneBoxFarAwayDoesNotSpoilTheOthers) {
    for (const float size : {0.2f, 20.0f}) {
        const Boxes boxes = spread(10'000, 365, 0.01f * size);
        const Bvh alone = ploc(boxes);
        const double expected = alone.bounds().half_area() + sum_of_areas(alone);
        for (const float distance : {1e3f, 1e6f, 1e9f, 1e18f, -1e9f, -1e18f}) {
            for (const size_t at : {size_t{0}, boxes.size() / 3, boxes.size()}) {
                Boxes more = boxes;
                const Aabb far = about(glm::vec3(0.3f, 1.0f, 0.1f) * distance, 0.1f);
                more.insert(more.begin() + ptrdiff_t(at), far);
                const Bvh bvh = ploc(more);
                EXPECT_EQ(validate(bvh, more), "");
                double sum = 0.0;
                for (const BvhNode& node : bvh.nodes) {
                    if (!node.is_leaf() && !node.bounds().contains(far)) sum += node.bounds().half_area();
                }
                EXPECT_LE(sum, 1.1 * expected) << "box " << at << " is " << distance << " away, seed 365";
            }
        }
    }
}

TEST(Ploc, ATopByBinnedSahMakesTheSumOfAreasNoLarger) {
    for (uint64_t seed = 380; seed < 460; ++seed) {
        Rng rng(seed);
        const Boxes boxes = spread(int(2 + rng.below(600)), seed, log_uniform(rng, 0.01, 3.0));
        const double clustered = sum_of_areas(ploc(boxes, 8, 1));
        for (const uint32_t top_count : {0u, 2u, 3u, 50u, 256u, 0xffffffffu}) {
            const Bvh bvh = ploc(boxes, 8, top_count);
            ASSERT_EQ(validate(bvh, boxes), "") << "seed " << seed << ", top of " << top_count;
            EXPECT_LE(sum_of_areas(bvh), (1.0 + 1e-9) * clustered) << "seed " << seed << ", top of " << top_count;
            if (top_count < boxes.size()) continue;
            const double binned = sum_of_areas(build_binned(boxes, {.max_leaf_size = 1}));
            EXPECT_LE(sum_of_areas(bvh), (1.0 + 1e-9) * binned) << "seed " << seed << ", all of them the top";
        }
    }
}

// Top levels that others are bad at: no worse than a binned tree of single boxes. Of places far apart, most of the sum is
// that of the few nodes that hold several of them, and what is built bottom up makes these no better: by exact clustering it
// is 1.9 % worse, by the fast form, whose top is binned, 0.2 %.
TEST(Ploc, SumOfAreasIsAtMostThatOfBinned) {
    Rng rng(370);
    Boxes huge = spread(10'000, 371), places, gaps;
    huge[5000] = about(glm::vec3(0), 100.0f);
    for (int k = 0; k < 10'000; ++k) {
        Rng cluster(372 + k % 16);
        places.push_back(about(random_point(cluster, 1000.0f) + random_point(rng, 10.0f), rng.uniform(0.05f, 0.5f)));
        const float x = float(k) * float(k) * 1e-4f;
        gaps.push_back(about({x, rng.uniform(), rng.uniform()}, 0.1f));
    }
    const std::tuple<const char*, const Boxes*, double, double> scenes[] = {{"one huge and many small", &huge, 1.0, 1.0},
                                                                            {"16 clusters", &places, 1.003, 1.02},
                                                                            {"growing gaps", &gaps, 1.0, 1.0}};
    for (const auto& [name, boxes, most_fast, most_exact] : scenes) {
        const double binned = sum_of_areas(build_binned(*boxes, {.max_leaf_size = 1}));
        EXPECT_LE(sum_of_areas(ploc(*boxes)), most_fast * binned) << name;
        EXPECT_LE(sum_of_areas(build_agglomerative(*boxes)), most_exact * binned) << name;
    }
}

}  // namespace
}  // namespace zoe::test
