// Every builder, every instruction set, every call: the hits of the loop over all triangles, bit for bit.

#include <bit>
#include <string>

#include <gtest/gtest.h>

#include "engine/bvh/build_sbvh.h"
#include "engine/bvh/traverse.h"
#include "tests/bvh/copies.h"
#include "tests/bvh/each_target.h"
#include "tests/bvh/inputs.h"
#include "tests/math/random_inputs.h"

namespace zoe::test {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();

bool is_same_hit(const RawHit& hit, const BlasHit& expected) {
    const auto bits = [](float x) { return std::bit_cast<uint32_t>(x); };
    return bits(hit.t) == bits(expected.t) && bits(hit.u) == bits(expected.u) && bits(hit.v) == bits(expected.v) &&
           hit.primitive == expected.primitive;
}

/// A scene of one tree, as it is.
struct OneTree {
    explicit OneTree(const Blas& blas) {
        const Aabb box = blas.tree.bounds();
        Bvh bvh;
        bvh.nodes.push_back({box.lo, 0, box.hi, 1});
        bvh.primitives.push_back(0);
        std::vector<uint32_t> slots;
        CollapseScratch scratch;
        collapse(bvh, {.block_size = 1, .max_leaf_blocks = 1}, &top, &slots, &scratch);
        placed = {.blas = &blas, .id = 3, .is_identity = true};
        bounds = box;
        levels = {&top, &placed, &bounds, top.stack_size() + blas.tree.stack_size() + 1};
    }
    WideBvh top;
    PlacedBlas placed;
    Aabb bounds;
    TwoLevels levels;
};

/// Sixteen rays and more from near one point to a corner, an edge or the inside of a triangle and close by.
std::vector<Ray> coherent_rays(const TestMesh& mesh, int packet_count, uint64_t seed) {
    std::vector<Ray> rays;
    Rng rng(seed);
    for (const Ray& ray : rays_at(mesh, packet_count, seed)) {
        const glm::vec3 target = ray.origin + ray.direction;
        const float size = glm::length(ray.direction);
        for (int k = 0; k < 16; ++k) {
            Ray near = ray;
            if (rng.below(2)) near.origin += 0.01f * size * random_direction(rng);
            near.direction = target + (k % 4 == 0 ? 0.0f : 0.03f * size) * random_direction(rng) - near.origin;
            rays.push_back(near);
        }
    }
    return rays;
}

struct NamedTree {
    std::string name;
    Blas blas;
};

/// By each builder of a BLAS, and by spatial splits alone: the tree of pieces, and what reinsertion makes of it.
std::vector<NamedTree> trees_over(const TestMesh& mesh) {
    std::vector<NamedTree> trees;
    const auto add = [&](const char* name, BlasBuilder builder) {
        trees.push_back({name, {}});
        build_blas(mesh.positions, mesh.corners, builder, &trees.back().blas);
    };
    add("sweep", BlasBuilder::kSweep);
    add("median", BlasBuilder::kMedian);
    add("binned", BlasBuilder::kBinned);
    add("sweep, reinserted", BlasBuilder::kReinserted);
    add("SBVH, reinserted", BlasBuilder::kSbvh);
    const SbvhConfig split_often{.max_reference_growth = 3.0f, .min_overlap = 0.0f};
    trees.push_back({"SBVH", blas_from(build_sbvh(mesh.positions, mesh.corners, split_often), mesh)});
    return trees;
}

std::vector<BlasHit> hits_of_all(const TestMesh& mesh, const std::vector<Ray>& rays) {
    std::vector<BlasHit> hits;
    for (const Ray& ray : rays) hits.push_back(brute_force(mesh, ray));
    return hits;
}

/// Every call: all rays in a batch, each in one of its own, and each with the tree alone; closest and any.
void expect_right(const Blas& blas, const std::vector<Ray>& rays, const std::vector<BlasHit>& expected) {
    const OneTree scene(blas);
    std::vector<RawHit> hits(rays.size());
    std::vector<uint8_t> is_hit(rays.size(), 2);
    closest_hits(scene.levels, rays, hits.data(), nullptr);
    any_hits(scene.levels, rays, is_hit.data(), nullptr);
    for (size_t k = 0; k < rays.size(); ++k) {
        const bool is_any = expected[k].primitive != kEmptyChild;
        ASSERT_TRUE(is_same_hit(hits[k], expected[k])) << "ray " << k << ": " << to_string(expected[k]);
        ASSERT_EQ(hits[k].id, is_any ? 3u : kEmptyChild) << "ray " << k;
        ASSERT_EQ(is_hit[k], is_any) << "ray " << k;
        RawHit alone;
        uint8_t is_alone_hit = 2;
        closest_hits(scene.levels, {&rays[k], 1}, &alone, nullptr);
        any_hits(scene.levels, {&rays[k], 1}, &is_alone_hit, nullptr);
        ASSERT_TRUE(is_same_hit(alone, expected[k])) << "ray " << k << " in a batch of its own";
        ASSERT_EQ(is_alone_hit, is_any) << "ray " << k << " in a batch of its own";
        ASSERT_TRUE(is_same(closest_hit(blas, rays[k]), expected[k])) << "ray " << k << " with the tree";
        ASSERT_EQ(any_hit(blas, rays[k]), is_any) << "ray " << k << " with the tree";
    }
}

/// Every builder's tree with every instruction set.
void expect_right_in_all_trees(const TestMesh& mesh, const std::vector<Ray>& rays) {
    const std::vector<BlasHit> expected = hits_of_all(mesh, rays);
    for (const NamedTree& tree : trees_over(mesh)) {
        SCOPED_TRACE(mesh.name + ", " + tree.name);
        on_each_target([&] { expect_right(tree.blas, rays, expected); });
    }
}

TEST(Targets, BatchesOfAnyRaysGiveTheHitsOfTheLoopOverAllTrianglesInEveryBuildersTree) {
    for (const TestMesh& mesh : nasty_meshes()) {
        if (mesh.corners.size() <= 5000) expect_right_in_all_trees(mesh, rays_at(mesh, 163, 142));
    }
}

TEST(Targets, BatchesOfCoherentRaysDo) {
    for (const TestMesh& mesh : nasty_meshes()) {
        if (mesh.corners.size() <= 5000) expect_right_in_all_trees(mesh, coherent_rays(mesh, 24, 143));
    }
}

TEST(Targets, TrianglesInPiecesAreAmongThem) {
    const TestMesh mesh = large_among_small(147);
    std::string in_pieces;
    for (const NamedTree& tree : trees_over(mesh)) {
        if (tree.blas.has_pieces) in_pieces += tree.name + "; ";
    }
    EXPECT_EQ(in_pieces, "SBVH, reinserted; SBVH; ");
    expect_right_in_all_trees(mesh, rays_at(mesh, 400, 148));
    expect_right_in_all_trees(mesh, coherent_rays(mesh, 40, 149));
}

// Copies that are moved and turned, whose boxes are those of their trees: those must not differ, either.
TEST(Targets, CopiesOfEveryBuildersTreeGiveTheHitsOfTheFirst) {
    for (const uint64_t seed : {241, 242}) {
        SCOPED_TRACE(::testing::Message() << "seed " << seed);
        const TestMesh mesh = seed % 2 == 0 ? random_soup(300, 2.0f, seed) : large_among_small(seed);
        std::vector<Affine> maps = random_affines(6, 0.5, 2.0, 30.0f, seed + 10);
        maps.push_back(Affine{});
        const std::vector<NamedTree> trees = trees_over(mesh);
        std::vector<Ray> rays = rays_at(mesh, 160, seed + 20);
        const std::vector<Ray> coherent = coherent_rays(mesh, 20, seed + 30);
        rays.insert(rays.end(), coherent.begin(), coherent.end());
        for (size_t k = 0; k < rays.size(); ++k) {
            const Affine& map = maps[k / 16 % maps.size()];
            rays[k].origin = map.point(rays[k].origin);
            rays[k].direction = map.vector(rays[k].direction);
        }
        for (const Top top : {Top::kWholeBoxes, Top::kParts}) {
            const Copies reference(mesh, trees[0].blas, maps, 1.0f, top);
            EXPECT_GT(expect_batches_right(reference, rays), 100);
            std::vector<RawHit> expected;
            for (const Ray& ray : rays) expected.push_back(reference.brute_force(ray));
            for (const NamedTree& tree : trees) {
                SCOPED_TRACE(tree.name + (top == Top::kParts ? ", parts" : ", whole"));
                const Copies copies(mesh, tree.blas, maps, 1.0f, top);
                on_each_target([&] {
                    std::vector<RawHit> hits(rays.size());
                    std::vector<uint8_t> is_hit(rays.size(), 2);
                    closest_hits(copies.levels(), rays, hits.data(), nullptr);
                    any_hits(copies.levels(), rays, is_hit.data(), nullptr);
                    for (size_t k = 0; k < rays.size(); ++k) {
                        ASSERT_TRUE(is_same(hits[k], expected[k])) << "ray " << k;
                        ASSERT_EQ(is_hit[k], expected[k].id != kEmptyChild) << "ray " << k;
                    }
                });
            }
        }
    }
}

TEST(Targets, CoherentRaysMayHaveEndsAndBeNoRaysAmongThem) {
    const TestMesh mesh = random_soup(1000, 1.0f, 144);
    Rng rng(145);
    std::vector<Ray> rays = coherent_rays(mesh, 100, 146);
    const float nan = std::nanf("");
    for (Ray& ray : rays) {
        if (rng.below(3) == 0) ray.t_min = rng.uniform(0.0f, 1.2f);
        if (rng.below(3) == 0) ray.t_max = rng.uniform(0.0f, 1.5f);
        if (rng.below(100) == 0) ray.direction[int(rng.below(3))] = rng.below(2) ? nan : 0.0f;
        if (rng.below(100) == 0) ray.origin[int(rng.below(3))] = rng.below(2) ? nan : kInf;
        if (rng.below(100) == 0) (rng.below(2) ? ray.t_min : ray.t_max) = nan;
    }
    expect_right_in_all_trees(mesh, rays);
}

}  // namespace
}  // namespace zoe::test
