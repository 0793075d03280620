// Vertices of whole files in the world, after sampling, morphing and skinning, against the oracle's, which plays the file in
// double precision: in units in the last place of the largest coordinate of the scene's box.

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "engine/zoetrope.h"
#include "tests/support/assets.h"
#include "tests/support/gltf_oracle.h"

namespace zoe::test {
namespace {

glm::dvec3 in_world(const Instance& instance, uint32_t vertex) {
    return glm::dmat3(instance.world_from_local.linear) * glm::dvec3(instance.positions[vertex]) +
           glm::dvec3(instance.world_from_local.translation);
}

struct Worst {
    double ulps = 0.0;
    size_t compared = 0;
};

Worst worst_error(const std::filesystem::path& file, double time_s) {
    Scene scene = load_gltf(file, {.load_images = false});
    const Tlas& tlas = advance(scene, time_s);
    const std::vector<WorldTriangle> triangles = world_triangles(read_document(file), time_s);
    double size = 0.0, error = 0.0;
    Worst worst;
    for (const WorldTriangle& t : triangles) {
        for (const glm::dvec3& p : {t.a, t.b, t.c}) size = std::max({size, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
        const Node& node = scene.nodes.at(t.node);
        if (node.sequence) continue;
        if (tlas.instance_of_node.at(t.node) == kNoInstance) continue;  // Without size.
        const Instance& instance = tlas[NodeId{t.node}];
        const glm::uvec3& corners = instance.mesh->corners.at(t.primitive);
        const glm::dvec3* expected[] = {&t.a, &t.b, &t.c};
        for (int k = 0; k < 3; ++k) {
            const double off = glm::length(in_world(instance, corners[k]) - *expected[k]);
            if (!(off <= error)) error = off;
            ++worst.compared;
        }
    }
    worst.ulps = error / (size * 1.1920929e-7);
    return worst;
}

TEST(Accuracy, TheDefaultScenesVerticesAreWithinUlpsOfItsBox) {
    const std::filesystem::path file = std::filesystem::path(ZOETROPE_SOURCE_DIR) / "content/default.glb";
    for (const double time_s : {0.0, 0.37, 1.5, 2.9}) {
        const Worst worst = worst_error(file, time_s);
        EXPECT_LT(worst.ulps, 1.0) << "at " << time_s;
        EXPECT_GT(worst.compared, 10000u);
    }
}

TEST(Accuracy, VerticesOfRealFiguresAreWithinUlpsOfTheirBoxes) {
    const auto folder = assets_folder(ZOETROPE_SOURCE_DIR);
    if (!folder) GTEST_SKIP() << kNoAssets;
    for (const char* const name :
         {"skinned/CesiumMan.glb", "skinned/Fox.glb", "mixed/RobotExpressive.glb", "morph/AnimatedMorphCube.glb"}) {
        if (!std::filesystem::exists(*folder / name)) continue;
        for (const double time_s : {0.0, 0.37, 1.5}) {
            const Worst worst = worst_error(*folder / name, time_s);
            EXPECT_LT(worst.ulps, 4.0) << name << " at " << time_s;
            EXPECT_GT(worst.compared, 10u) << name;
        }
    }
}

}  // namespace
}  // namespace zoe::test
