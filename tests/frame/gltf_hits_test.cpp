// Hits of real animated models equal the oracle's, which reads and plays the file itself in double precision.

#include <algorithm>
#include <array>
#include <memory>
#include <numeric>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "engine/frame/classify.h"
#include "engine/zoetrope.h"
#include "tests/support/assets.h"
#include "tests/support/compare.h"
#include "tests/support/gltf_oracle.h"
#include "tests/support/rays.h"

namespace zoe::test {
namespace {

constexpr size_t kRayCount = 400;
/// Shares of the clip: its start, between keys, its end (where it starts again), and a later round.
constexpr std::array<double, 8> kTimes{0.0, 0.13, 0.291, 0.5, 0.7177, 0.983, 1.0, 2.37};

struct Model {
    std::string name, file;
    std::vector<size_t> clips{0};
    double tie_share = 0.01;  ///< Of the rays: what the file's own overlapping triangles call for.
    friend void PrintTo(const Model& model, std::ostream* out) { *out << model.file; }
};

/// Everything about a model but the frame: what a ray may hit.
class GltfHits : public testing::TestWithParam<Model> {
protected:
    void SetUp() override {
        const auto folder = assets_folder(ZOETROPE_SOURCE_DIR);
        if (!folder) GTEST_SKIP() << kNoAssets;
        file_ = *folder / GetParam().file;
        document_ = read_document(file_);
        playback_.clips = GetParam().clips;
        for (const size_t clip : playback_.clips) {
            if (clip < document_.clips.size()) duration_s_ = std::max(duration_s_, document_.clips[clip].duration_s);
        }
        if (duration_s_ == 0.0) duration_s_ = 1.0;
    }

    Scene load() const {
        Scene scene = load_gltf(file_, {.load_images = false});
        scene.playback.clips.clear();
        for (const size_t clip : playback_.clips) {
            if (clip < scene.clips.size()) scene.playback.clips.push_back(ClipId{static_cast<uint32_t>(clip)});
        }
        return scene;
    }
    BruteForce truth_at(double time_s) const { return BruteForce(world_triangles(document_, time_s, playback_)); }

    std::filesystem::path file_;
    Document document_;
    OraclePlayback playback_;
    double duration_s_ = 0.0;
};

/// Nodes that show something, by whether their vertices can move in their own space.
struct Shown {
    uint32_t stiff_count = 0, deforming_count = 0;
};

Shown count_shown(const Scene& scene) {
    Shown shown;
    for (size_t i = 0; i < scene.nodes.size(); ++i) {
        const Node& node = scene.nodes[i];
        if (node.mesh == kNone<MeshId> || !node.is_shown) continue;
        const bool is_stiff = motion(scene, NodeId{static_cast<uint32_t>(i)}) < Motion::kDeforming;
        ++(is_stiff ? shown.stiff_count : shown.deforming_count);
    }
    return shown;
}

TEST_P(GltfHits, EqualTheOraclesAtEightTimes) {
    Scene scene = load();
    Agreement total;
    for (size_t k = 0; k < kTimes.size(); ++k) {
        const double time_s = kTimes[k] * duration_s_;
        const uint64_t seed = 100 + k;
        SCOPED_TRACE(fmt::format("{} at {} s, seed {}", GetParam().file, time_s, seed));
        const BruteForce truth = truth_at(time_s);
        const Tlas& tlas = advance(scene, time_s);
        Agreement closest, any;
        for (const OracleRay& ray : rays_around(truth.triangles(), kRayCount, seed)) {
            const Hit hit = closest_hit(tlas, engine_ray(ray));
            const bool is_hit = any_hit(tlas, engine_ray(ray));
            compare_closest(truth, ray, hit, &closest);
            compare_any(truth, ray, is_hit, &any);
            EXPECT_EQ(static_cast<bool>(hit), is_hit) << "closest and any hit disagree";
        }
        EXPECT_TRUE(closest.verdict(GetParam().tie_share));
        EXPECT_TRUE(any.verdict());
        EXPECT_GT(closest.hit_count, kRayCount / 4);
        total.add(closest);
    }
    fmt::print("{}: {}\n", GetParam().name, total.verdict(GetParam().tie_share).message());
}

TEST_P(GltfHits, DoNotDependOnTheFramesBefore) {
    Scene played = load(), jumped = load();
    for (const double share : kTimes) advance(played, share * duration_s_);
    for (const double share : {kTimes[4], kTimes[1]}) {
        const double time_s = share * duration_s_;
        const BruteForce truth = truth_at(time_s);
        const Tlas& after_others = advance(played, time_s);
        jumped.touch();
        const Tlas& at_once = advance(jumped, time_s);
        for (const OracleRay& ray : rays_around(truth.triangles(), kRayCount, 7)) {
            ASSERT_EQ(closest_hit(after_others, engine_ray(ray)), closest_hit(at_once, engine_ray(ray))) << time_s << " s";
        }
    }
}

TEST_P(GltfHits, KeepTheTreesOfNodesThatDoNotDeform) {
    Scene scene = load();
    scene.rebuild.frame_rays = 0.0;  // Nothing is lost by refitting.
    FrameStats first;
    advance(scene, 0.0, &first);
    const Shown shown = count_shown(scene);
    EXPECT_EQ(first.kept + first.refitted + first.rebuilt, shown.stiff_count + shown.deforming_count);
    for (size_t k = 1; k < kTimes.size(); ++k) {
        FrameStats stats;
        advance(scene, kTimes[k] * duration_s_, &stats);
        EXPECT_EQ(stats.kept + stats.refitted + stats.rebuilt, shown.stiff_count + shown.deforming_count);
        EXPECT_GE(stats.kept, shown.stiff_count);
        EXPECT_LE(stats.refitted, shown.deforming_count);
        EXPECT_EQ(stats.rebuilt, 0u);
        FrameStats again;
        advance(scene, kTimes[k] * duration_s_, &again);
        EXPECT_EQ(again.kept, shown.stiff_count + shown.deforming_count) << "a paused scene does no work";
    }
}

std::vector<size_t> all_clips(size_t count) {
    std::vector<size_t> clips(count);
    std::iota(clips.begin(), clips.end(), size_t{0});
    return clips;
}

INSTANTIATE_TEST_SUITE_P(
    Models, GltfHits,
    testing::Values(Model{"FoxSurvey", "skinned/Fox.glb", {0}}, Model{"FoxWalk", "skinned/Fox.glb", {1}},
                    Model{"FoxRun", "skinned/Fox.glb", {2}}, Model{"CesiumMan", "skinned/CesiumMan.glb"},
                    Model{"RiggedSimple", "skinned/RiggedSimple.glb"},
                    Model{"SimpleSkin", "skinned/SimpleSkin/SimpleSkin.gltf"},
                    Model{"Mannequiny", "skinned/mannequiny.glb", {3}},
                    Model{"PlatformerPlayer", "skinned/godot-platformer-player.glb", {1}},
                    Model{"UnassignedSkeleton", "edge/unassigned-skeleton.gltf"},
                    Model{"SkinTwoMeshes", "asset-generator/Animation_Skin/Animation_Skin_04.gltf"},
                    Model{"SkinShared", "asset-generator/Instancing/Instancing_08.gltf"},
                    Model{"AnimatedMorphCube", "morph/AnimatedMorphCube.glb"},
                    Model{"AnimatedMorphCubeQuantized", "morph/AnimatedMorphCube-Quantized/AnimatedMorphCube.gltf"},
                    Model{"AnimatedMorphSphere", "morph/AnimatedMorphSphere.glb"},
                    Model{"SimpleMorph", "morph/SimpleMorph/SimpleMorph.gltf"},
                    Model{"MorphPrimitivesTest", "morph/MorphPrimitivesTest.glb"},
                    Model{"SparseBlendshapeCube", "morph/singleBlendshapeCube_sparse.glb"},
                    Model{"InterpolationTestFirst", "rigid/InterpolationTest.glb"},
                    Model{"InterpolationTestAll", "rigid/InterpolationTest.glb", all_clips(9)},
                    // Its bevels are quads cut along both diagonals: their two triangles overlap.
                    Model{"BoxAnimated", "rigid/BoxAnimated.glb", {0}, 0.2},
                    Model{"AnimatedCube", "rigid/AnimatedCube/AnimatedCube.gltf"},
                    Model{"AnimatedTriangle", "rigid/AnimatedTriangle/AnimatedTriangle.gltf"},
                    Model{"CesiumMilkTruck", "rigid/CesiumMilkTruck.glb"}, Model{"Receiver", "rigid/receiver/scene.gltf"},
                    Model{"SplineTranslation", "asset-generator/Animation_Node/Animation_Node_04.gltf"},
                    Model{"RobotExpressiveDance", "mixed/RobotExpressive.glb", {0}},
                    Model{"RobotExpressiveWalk", "mixed/RobotExpressive.glb", {10}},
                    Model{"RobotExpressiveAll", "mixed/RobotExpressive.glb", all_clips(14)},
                    Model{"LittlestTokyo", "mixed/LittlestTokyo.glb"},
                    Model{"SimpleInstancing", "edge/SimpleInstancing.glb"},
                    Model{"NegativeScale", "edge/NegativeScaleTest.glb"},
                    Model{"PrimitiveModes", "edge/MeshPrimitiveModes/MeshPrimitiveModes.gltf"},
                    Model{"MultipleScenes", "edge/MultipleScenes/MultipleScenes.gltf"},
                    Model{"DuckQuantized", "edge/Duck-Quantized/Duck.gltf"},
                    Model{"SparsePositions", "edge/SimpleSparseAccessor/SimpleSparseAccessor.gltf"},
                    Model{"ManyCubes", "edge/many-cubes/many-cubes.gltf"}, Model{"Interleaved", "edge/BoxInterleaved.glb"},
                    Model{"RetroUfo", "rigid/retroufo.glb"}),
    [](const testing::TestParamInfo<Model>& info) { return info.param.name; });

}  // namespace
}  // namespace zoe::test
