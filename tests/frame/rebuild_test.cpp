// When trees of deforming nodes are rebuilt.

#include <cmath>
#include <numeric>
#include <stdexcept>

#include <gtest/gtest.h>

#include "content/shapes.h"
#include "engine/bvh/blas.h"
#include "engine/bvh/choose_rebuilds.h"
#include "engine/math/parallel.h"
#include "tests/frame/motion_class.h"
#include "tests/frame/rebuild_sequences.h"
#include "tests/math/random_inputs.h"

namespace zoe::test {
namespace {

TEST(Rebuild, OfManyTheMostWornComeFirstAndAFrameDoesNotPayForAll) {
    // [tree] All of one size but the last, which has lost most, but least for its size.
    std::vector<TreeWatch> trees;
    for (int k = 0; k < 15; ++k) trees.push_back({.triangle_count = 100, .lost_work = 1e4 * (1 + k % 5)});
    trees.push_back({.triangle_count = 1700, .lost_work = 6e4});
    std::vector<const TreeWatch*> watches;
    for (const TreeWatch& tree : trees) watches.push_back(&tree);
    std::vector<uint32_t> chosen;
    choose_rebuilds({.triangle_work = 20.0, .most_share = 0.125}, watches, &chosen);
    EXPECT_EQ(chosen, (std::vector<uint32_t>{4, 9, 14, 3})) << "400 of 3200 triangles";
    choose_rebuilds({.triangle_work = 20.0, .most_share = 0.0}, watches, &chosen);
    EXPECT_EQ(chosen, (std::vector<uint32_t>{4})) << "one is always rebuilt";
    choose_rebuilds({.triangle_work = 20.0, .most_share = 1.0}, watches, &chosen);
    EXPECT_EQ(chosen.size(), 16u);
    EXPECT_EQ(chosen.back(), 15u);
    choose_rebuilds({.triangle_work = 450.0, .most_share = 1.0}, watches, &chosen);
    EXPECT_EQ(chosen, (std::vector<uint32_t>{4, 9, 14})) << "the others have not lost what rebuilding costs";
    for (const size_t k : {0, 5, 15}) trees[k].frame_loss = trees[k].lost_work;
    choose_rebuilds({.triangle_work = 20.0, .most_share = 0.125}, watches, &chosen);
    EXPECT_EQ(chosen, (std::vector<uint32_t>{4, 9, 14, 3, 0, 5, 15})) << "and three that pay within the frame";
    for (TreeWatch& tree : trees) tree.lost_work = tree.frame_loss = 0.0;
    choose_rebuilds({.triangle_work = 0.0}, watches, &chosen);
    EXPECT_TRUE(chosen.empty()) << "nothing is lost";
}

TEST(Rebuild, WaitsWhileItIsDearBesideAllOtherWork) {
    const auto is_chosen = [](const TreeWatch& tree, double share = 0.1) {
        const TreeWatch* const watches[] = {&tree};
        std::vector<uint32_t> chosen;
        choose_rebuilds({.triangle_work = 10.0, .share = share}, watches, &chosen);
        return !chosen.empty();
    };
    const auto lost_and_needed = [](double lost, double needed) {
        return TreeWatch{.triangle_count = 100, .lost_work = lost, .needed_work = needed};
    };
    EXPECT_FALSE(is_chosen(lost_and_needed(999, 1e9))) << "has not lost a rebuild's work";
    EXPECT_TRUE(is_chosen(lost_and_needed(1000, 0)));
    EXPECT_FALSE(is_chosen(lost_and_needed(3999, 3000)));
    EXPECT_TRUE(is_chosen(lost_and_needed(4000, 3000))) << "has lost that and all that the rays needed";
    EXPECT_FALSE(is_chosen(lost_and_needed(1999, 8000)));
    EXPECT_TRUE(is_chosen(lost_and_needed(2000, 8000))) << "a tenth of all work";
    EXPECT_TRUE(is_chosen(lost_and_needed(1000, 9000)));
    EXPECT_TRUE(is_chosen(lost_and_needed(1000, 3000), 1.0)) << "no share is too large";
    TreeWatch tree = lost_and_needed(1500, 3000);
    tree.frame_loss = 1000;
    EXPECT_TRUE(is_chosen(tree)) << "pays within the frame";
}

TEST(Rebuild, AfterAJumpThePoseIsExpectedToBeHeldForAsLongAsTheLast) {
    const auto is_chosen = [](const TreeWatch& tree) {
        const TreeWatch* const watches[] = {&tree};
        std::vector<uint32_t> chosen;
        choose_rebuilds({.triangle_work = 10.0}, watches, &chosen);
        return !chosen.empty();
    };
    constexpr double kRays = 5.0, kBuildWork = 1000.0;
    const auto pass_frames = [](int count, TreeWatch* tree) {
        for (int k = 0; k < count; ++k) add_loss(kRays, kBuildWork, tree);
    };
    TreeWatch tree;
    note_build({.cost = 20.0, .triangle_area = 1.0}, 100, &tree);
    pass_frames(10, &tree);
    note_refit({.cost = 60.0, .triangle_area = 1.0}, &tree);
    pass_frames(8, &tree);
    EXPECT_EQ(tree.coming_work, 0.0) << "the first jump says nothing";
    EXPECT_FALSE(is_chosen(tree));
    note_build({.cost = 20.0, .triangle_area = 1.0}, 100, &tree);
    for (const double cost : {39.0, 70.0, 100.0}) {
        note_refit({.cost = cost, .triangle_area = 1.0}, &tree);
        pass_frames(1, &tree);
    }
    EXPECT_EQ(tree.coming_work, 0.0) << "creeping is no jump";
    note_build({.cost = 20.0, .triangle_area = 1.0}, 100, &tree);
    pass_frames(7, &tree);
    note_refit({.cost = 60.0, .triangle_area = 1.0}, &tree);
    pass_frames(1, &tree);
    EXPECT_EQ(tree.held, 18u);
    EXPECT_EQ(tree.coming_work, 18 * kRays * 40.0);
    tree.spare_work = 0.0;
    EXPECT_TRUE(is_chosen(tree)) << "a rebuild is all work since the last: 8 * 100 that was needed, and 200";
    TreeWatch dear = tree;
    dear.needed_work -= 1.0;
    EXPECT_FALSE(is_chosen(dear));
    dear.spare_work = 1.0;
    EXPECT_FALSE(is_chosen(dear)) << "jumps that are not regular may be those of two poses";
    dear.regular_jumps = 2;
    EXPECT_TRUE(is_chosen(dear)) << "what was spare before";
    pass_frames(13, &tree);
    EXPECT_EQ(tree.coming_work, 5 * kRays * 40.0) << "what is left of it";
    pass_frames(10, &tree);
    EXPECT_EQ(tree.coming_work, 0.0);
    note_refit({}, &tree);
    pass_frames(1, &tree);
    EXPECT_EQ(tree.growth, 1.0) << "of no area";
}

TEST(Rebuild, WhatIsSpareIsTwiceWhatHindsightTakesAtLeastLessWhatWasDone) {
    constexpr double kBuildWork = 1000.0;
    TreeWatch tree;
    note_build({.cost = 20.0, .triangle_area = 1.0}, 100, &tree);
    EXPECT_EQ(tree.spare_work, 0.0) << "the first tree is everybody's";
    note_refit({.cost = 60.0, .triangle_area = 1.0}, &tree);
    for (int frame = 0; frame < 3; ++frame) add_loss(5.0, kBuildWork, &tree);
    ASSERT_EQ(tree.lost_work, 600.0);
    note_build({.cost = 20.0, .triangle_area = 1.0}, 100, &tree);
    EXPECT_EQ(tree.spare_work, 2 * (300 + 600) - (300 + 400 + kBuildWork)) << "in the third frame the new tree is traced";
    EXPECT_EQ(tree.open_work, 400.0);
    const double before = tree.spare_work;
    for (const double lost : {200.0, 400.0, 400.0}) {  // While the pose is held, up to a rebuild's work.
        add_loss(5.0, kBuildWork, &tree);
        EXPECT_EQ(tree.spare_work, before + 2 * lost);
    }
    TreeWatch moved = tree;
    moved.open_work = 400.0;
    note_refit({.cost = 20.0, .triangle_area = 1.0}, &moved);
    EXPECT_EQ(moved.open_work, 400.0) << "the same pose";
    note_refit({.cost = 21.0, .triangle_area = 1.0}, &moved);
    EXPECT_EQ(moved.open_work, 0.0);
    note_build({.cost = 20.0, .triangle_area = 1.0}, 100, &tree);
    note_build({.cost = 20.0, .triangle_area = 1.0}, 100, &tree);
    EXPECT_EQ(tree.spare_work, 0.0) << "never less: nobody chose to rebuild for nothing";
}

/// However much others lose, each that is due has its turn.
TEST(Rebuild, ATreeLargerThanAFramesShareHasItsTurn) {
    const RebuildConfig config{.triangle_work = 10.0, .most_share = 0.01};
    std::vector<TreeWatch> trees(20, {.triangle_count = 100, .ray_loss = 0.9});
    trees.push_back({.triangle_count = 100'000, .ray_loss = 100.0});
    std::vector<const TreeWatch*> watches;
    for (const TreeWatch& tree : trees) watches.push_back(&tree);
    std::vector<uint32_t> chosen;
    std::vector<int> rebuilt(trees.size(), 0);
    for (int frame = 0; frame < 1000; ++frame) {
        for (TreeWatch& tree : trees) add_loss(1000.0, 1000.0, &tree);
        choose_rebuilds(config, watches, &chosen);
        for (const uint32_t k : chosen) {
            ++rebuilt[k];
            trees[k].lost_work = 0.0;
        }
    }
    for (size_t k = 0; k < trees.size(); ++k) EXPECT_GE(rebuilt[k], 10) << "tree " << k;
}

TEST(Rebuild, WhatIsLostIsTheCostAboveThatOfANewTree) {
    TreeWatch tree;
    note_build({.cost = 20.0, .triangle_area = 4.0}, 100, &tree);
    add_loss(1e6, 1000.0, &tree);
    EXPECT_EQ(tree.lost_work, 0.0) << "as it was built";
    EXPECT_EQ(tree.needed_work, 20e6);
    note_refit({.cost = 15.0, .triangle_area = 4.0}, &tree);
    add_loss(1e6, 1000.0, &tree);
    EXPECT_EQ(tree.lost_work, 0.0) << "a tree that is better than it was";
    note_refit({.cost = 21.9, .triangle_area = 5.0}, &tree);
    add_loss(1e6, 1000.0, &tree);
    EXPECT_EQ(tree.lost_work, 0.0) << "not a tenth worse";
    note_refit({.cost = 24.0, .triangle_area = 5.0}, &tree);
    add_loss(1e3, 1000.0, &tree);
    EXPECT_EQ(tree.lost_work, 4e3);
    add_loss(1e3, 1000.0, &tree);
    EXPECT_EQ(tree.lost_work, 8e3) << "a pose that is held";
    EXPECT_EQ(tree.frame_loss, 4e3);
    note_refit({.cost = 15.0, .triangle_area = 1.0}, &tree);
    add_loss(1e3, 1000.0, &tree);
    EXPECT_EQ(tree.lost_work, 17.25e3) << "of triangles a quarter as large, a new tree is expected to cost its root and a "
                                          "quarter of the rest";
    note_build({.cost = 30.0, .triangle_area = 1.0}, 100, &tree);
    add_loss(1e3, 1000.0, &tree);
    EXPECT_EQ(tree.lost_work, 0.0);
    note_build({}, 100, &tree);
    note_refit({.cost = 5.0, .triangle_area = 1.0}, &tree);
    add_loss(1e3, 1000.0, &tree);
    EXPECT_EQ(tree.lost_work, 5e3) << "built where it had no area";
}

TEST(Rebuild, ReadingsAreThoseOfTheTreeAndItsTriangles) {
    const Mesh ball = make_sphere(1.0f, 8, 8);
    Blas blas;
    build_blas(ball.positions, ball.corners, BlasBuilder::kSweep, &blas);
    double area = 0.0;
    for (const glm::uvec3& corners : ball.corners) {
        Aabb box;
        for (int k = 0; k < 3; ++k) box.extend(ball.positions[corners[k]]);
        area += box.half_area();
    }
    const TreeReading reading = read_tree(blas);
    const double expected_cost = sah_cost(blas.tree, CollapseConfig{}.block_cost);
    EXPECT_NEAR(reading.cost, expected_cost, 1e-12 * expected_cost);
    EXPECT_NEAR(reading.triangle_area, area / blas.tree.bounds().half_area(), 1e-12 * area);
    const std::vector<glm::vec3> one_place(ball.positions.size(), glm::vec3(1.0f));
    refit_blas(one_place, ball.corners, &blas);
    EXPECT_EQ(read_tree(blas).cost, 0.0) << "no area at all";
    std::vector<glm::vec3> broken = ball.positions;
    broken[3] = glm::vec3(NAN);
    refit_blas(broken, ball.corners, &blas);
    EXPECT_GT(read_tree(blas).triangle_area, 0.0);
}

/// Balls whose triangles are set out of order by morph targets between 0.5 s and 1 s.
Content make_scrambled(int ball_count) {
    Content content;
    Scene& scene = content.scene;
    Mesh ball = from_triangles(make_sphere(0.5f, 16, 16));
    Rng rng(114);
    std::vector<uint32_t> places(ball.corners.size());
    for (uint32_t k = 0; k < places.size(); ++k) places[k] = k;
    for (auto k = static_cast<uint32_t>(places.size()); k > 1; --k) std::swap(places[k - 1], places[rng.below(k)]);
    ball.targets.resize(1);
    for (uint32_t v = 0; v < ball.positions.size(); ++v) {
        ball.targets[0].positions.push_back(ball.positions[3 * places[v / 3] + v % 3] - ball.positions[v]);
    }
    ball.default_weights = {0};
    const MeshId mesh = scene.add(std::move(ball));
    Clip clip;
    clip.duration_s = 4.0;
    clip.samplers = {{.width = 1, .times_s = {0, 0.5f, 1, 4}, .values = {0, 0, 1, 1}}};
    for (int k = 0; k < ball_count; ++k) {
        Node node;
        node.mesh = mesh;
        node.local.translation = {1.5f * static_cast<float>(k % 4), 0, 1.5f * static_cast<float>(k / 4)};
        clip.channels.push_back({scene.add(std::move(node)), ChannelPath::kWeights, 0});
    }
    scene.clips.push_back(clip);
    scene.playback.clips = {ClipId{0}};
    scene.clip_poses = 1;  // Or trees would be ready for what comes.
    return content;
}

/// Hits of rays that cross a box.
std::vector<Hit> hits_of(const Tlas& tlas, const Aabb& box, uint64_t seed) {
    Rng rng(seed);
    std::vector<Hit> hits;
    for (int k = 0; k < 500; ++k) {
        Ray ray;
        ray.origin = box.centre() + glm::length(box.extent()) * random_direction(rng);
        ray.direction = box.lo + glm::vec3(rng.uniform(), rng.uniform(), rng.uniform()) * box.extent() - ray.origin;
        hits.push_back(closest_hit(tlas, ray));
    }
    return hits;
}

TEST(Rebuild, TreesThatWearOutInOneFrameAreRebuiltInSeveral) {
    constexpr int kBalls = 16;
    Content content = make_scrambled(kBalls), refitted = make_scrambled(kBalls);
    content.scene.rebuild.frame_rays = 300.0;  // Few enough that no rebuild pays within a frame.
    refitted.scene.rebuild.frame_rays = 0.0;
    const Aabb box = play(content, 0.0).bounds();
    play(refitted, 0.0);
    uint32_t rebuilt = 0;
    const auto advance_to = [&](double time_s) {
        FrameStats stats;
        const Tlas& tlas = play(content, time_s, &stats);
        for (const Instance& instance : tlas.instances) {
            EXPECT_EQ(validate(*instance.blas, instance.positions, instance.mesh->corners), "") << "at " << time_s;
        }
        EXPECT_EQ(hits_of(tlas, box, 115), hits_of(play(refitted, time_s), box, 115)) << "at " << time_s;
        EXPECT_EQ(stats.kept + stats.refitted + stats.rebuilt, kBalls);
        EXPECT_LE(stats.rebuilt, 2u) << "an eighth";
        rebuilt += stats.rebuilt;
        return stats;
    };
    EXPECT_EQ(advance_to(0.4).kept, uint32_t(kBalls));
    // Nothing moves after the first of these: trees that are due are rebuilt none the less.
    for (int frame = 0; frame < 24; ++frame) advance_to(1.0 + frame / 24.0);
    EXPECT_EQ(rebuilt, uint32_t(kBalls));
    EXPECT_EQ(advance_to(3.0).kept, uint32_t(kBalls));
}

TEST(Rebuild, AllAtOnceWhereEachPaysWithinTheFrame) {
    Content content = make_scrambled(16);
    play(content, 0.0);
    FrameStats stats;
    play(content, 1.0, &stats);
    EXPECT_EQ(stats.rebuilt, 16u);
}

TEST(Rebuild, HappensWhereRaysAreLostAndTheSameOnAnyNumberOfThreads) {
    const auto rebuilt_by = [](uint64_t frame_rays, int threads) {
        set_thread_count(threads);
        Content content = make_scrambled(5);
        std::vector<uint32_t> rebuilt;
        for (int frame = 0; frame < 40; ++frame) {
            FrameStats stats;
            play(content, 0.04 * frame, &stats);
            report_rays(content.scene, frame_rays);
            if (frame > 0) rebuilt.push_back(stats.rebuilt);
        }
        set_thread_count(0);
        return rebuilt;
    };
    const auto sum = [](const std::vector<uint32_t>& counts) { return std::reduce(counts.begin(), counts.end()); };
    Scene unmade;
    EXPECT_THROW(report_rays(unmade, 1), std::logic_error);
    EXPECT_EQ(sum(rebuilt_by(0, 1)), 0u);
    EXPECT_EQ(sum(rebuilt_by(1, 1)), 0u) << "too few to pay for a build";
    EXPECT_GE(sum(rebuilt_by(100'000, 1)), 5u);
    EXPECT_EQ(rebuilt_by(100'000, 1), rebuilt_by(100'000, 3));
}

}  // namespace
}  // namespace zoe::test
