// A scanned mesh, with the needles and slivers that scans have: nothing gets through where it is closed.

#include <filesystem>

#include <gtest/gtest.h>

#include "engine/bvh/blas.h"
#include "engine/scene/gltf.h"
#include "tests/math/random_inputs.h"
#include "tests/support/assets.h"
#include "tests/support/leaks.h"

namespace zoe::test {
namespace {

TEST(Bunny, LetsNothingThroughNearAndFarFromTheOrigin) {
    const auto folder = assets_folder(ZOETROPE_SOURCE_DIR);
    if (!folder) GTEST_SKIP() << kNoAssets;
    const Scene scene = load_gltf((*folder / "static/stanford-bunny.glb").string());
    const Mesh& mesh = scene.meshes[0];
    for (const float distance : {0.0f, 100.0f}) {
        SCOPED_TRACE(distance);
        std::vector<glm::vec3> positions = mesh.positions;
        Aabb box;
        for (glm::vec3& p : positions) {
            p += glm::vec3(distance, -distance, distance) * glm::length(mesh.positions[0]);
            box.extend(p);
        }
        const float size = glm::length(box.extent());
        const auto from_outside = [&](Rng& rng) {
            return box.centre() + random_direction(rng) * rng.uniform(1.0f, 4.0f) * size;
        };
        const auto from_within = [&](Rng& rng) { return box.centre() + random_point(rng, 0.2f * size); };
        for (const BlasBuilder builder : {BlasBuilder::kSweep, BlasBuilder::kSbvh}) {
            SCOPED_TRACE(builder == BlasBuilder::kSbvh ? "of pieces" : "of whole triangles");
            Blas blas;
            build_blas(positions, mesh.corners, builder, &blas);
            EXPECT_EQ(blas.has_pieces, builder == BlasBuilder::kSbvh);
            expect_no_leaks(blas, positions, mesh.corners, from_outside, 161, leak_ray_count() / 8);
            expect_no_leaks(blas, positions, mesh.corners, from_within, 162, leak_ray_count() / 8);
        }
    }
}

}  // namespace
}  // namespace zoe::test
