// Scenes that are too far for Embree, and not for the engine.

#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "apps/bench/peer_embree.h"
#include "content/shapes.h"
#include "engine/math/parallel.h"
#include "tests/apps/run_program.h"
#include "tests/apps/small_scene.h"
#include "tests/support/temp_folder.h"

namespace zoe::test {
namespace {

Outcome run_bench(const TempFolder& folder, std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), ZOETROPE_BENCH);
    return run_program(arguments, folder.path());
}

/// The small scene with its first corner at `x`, and a node less: seen whole.
void write_far_scene(const TempFolder& folder, float x) {
    nlohmann::json json = small_scene();
    for (nlohmann::json& node : json["nodes"]) node.erase("camera");
    write_small_scene(folder, json);
    folder.write("scene.bin", small_buffer(x));
}

TEST(Bench, WhatIsBeyondEmbreesRangeIsRefusedInALineAndNotByEmbree) {
    if (!is_embree_available()) GTEST_SKIP() << "built without Embree";
    const std::vector<std::string> play = {"scene.gltf", "--frames", "2", "--size", "16x16", "--repeats", "1"};
    const std::vector<std::string> trees = {"scene.gltf", "--trees", "--size", "16x16", "--repeats", "1"};
    for (const auto& [x, what] : {std::pair{1.5e18f, "a ray's origin has"}, std::pair{3e18f, "a vertex has"}}) {
        for (std::vector<std::string> arguments : {play, trees}) {
            const TempFolder folder;
            write_far_scene(folder, x);
            const Outcome alone = run_bench(folder, arguments);
            EXPECT_EQ(alone.exit_code, 0) << x << ": " << alone.err;
            arguments.insert(arguments.end(), {"--peer", "embree"});
            const Outcome outcome = run_bench(folder, arguments);
            EXPECT_EQ(outcome.exit_code, 1) << x << ": " << outcome.err;
            ASSERT_EQ(lines(outcome.err).size(), 1u) << outcome.err;
            EXPECT_NE(outcome.err.find(what), std::string::npos) << x << ": " << outcome.err;
        }
    }
    const TempFolder folder;
    write_far_scene(folder, 1e17f);
    std::vector<std::string> near = play;
    near.insert(near.end(), {"--peer", "embree"});
    EXPECT_EQ(run_bench(folder, near).exit_code, 0);
}

TEST(Bench, ARayThatIsBeyondEmbreesRangeInsideOfAnInstanceIsRefusedToo) {
    if (!is_embree_available()) GTEST_SKIP() << "built without Embree";
    Scene scene;
    Node node;
    node.mesh = scene.add(make_grid(2, 2, 1.0f, 1.0f));
    node.local.scale = glm::vec3(1e-3f);
    scene.add(node);
    const Tlas& tlas = advance(scene, 0.0);
    ASSERT_FALSE(tlas.instances.at(0).is_identity);
    EmbreePeer peer({.layout = EmbreeConfig::Layout::kInstances}, thread_count());
    peer.update(scene, tlas);
    const auto trace = [&](const Ray& ray) {
        Hit hit;
        uint8_t is_hit = 0;
        peer.closest_hits({&ray, 1}, RayKind::kPrimary, {&hit, 1});
        peer.any_hits({&ray, 1}, RayKind::kShadow, {&is_hit, 1});
    };
    EXPECT_NO_THROW(trace({.origin = {0, 1e14f, 0}, .direction = {0, -1, 0}}));
    EXPECT_THROW(trace({.origin = {0, 1e16f, 0}, .direction = {0, -1, 0}}), std::runtime_error);
    EXPECT_THROW(trace({.origin = {0, 1, 0}, .direction = {0, -1e16f, 0}}), std::runtime_error);
    EXPECT_THROW(trace({.origin = {0, std::nanf(""), 0}, .direction = {0, -1, 0}}), std::runtime_error);
}

}  // namespace
}  // namespace zoe::test
