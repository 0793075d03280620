#include "engine/bvh/blas.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "tests/bvh/inputs.h"

namespace zoe::test {
namespace {

TEST(Blas, EveryBuilderGivesTheHitsOfTheLoopOverAllTrianglesToTheLastBit) {
    const uint64_t seed = 81;
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    for (const TestMesh& mesh : nasty_meshes()) {
        const std::vector<Aabb> boxes = mesh.boxes();
        const std::vector<Ray> rays = rays_at(mesh, mesh.corners.size() > 10000 ? 48 : 320, seed);
        std::vector<BlasHit> expected;
        for (const Ray& ray : rays) expected.push_back(brute_force(mesh, ray));
        for (const NamedBuilder& builder : all_builders()) {
            if (!accepts(builder, boxes)) continue;
            const Blas blas = blas_from(builder.build(boxes), mesh);
            for (size_t k = 0; k < rays.size(); ++k) {
                const BlasHit hit = closest_hit(blas, rays[k]);
                ASSERT_TRUE(is_same(hit, expected[k])) << builder.name << " on " << mesh.name << ", ray " << k << ": "
                                                       << to_string(hit) << ", expected " << to_string(expected[k]);
                ASSERT_EQ(any_hit(blas, rays[k]), expected[k].primitive != 0xffffffffu)
                    << builder.name << " on " << mesh.name << ", ray " << k;
            }
        }
    }
}

TEST(Blas, RaysAtNastyMeshesDoHitThem) {
    // Guards the test above against comparing misses with misses.
    for (const TestMesh& mesh : nasty_meshes()) {
        if (mesh.corners.empty() || mesh.corners.size() > 10000) continue;
        if (mesh.name == "nothing finite" || mesh.name == "on a line" || mesh.name == "in one point") continue;
        if (mesh.name.starts_with("as huge as floats go"))
            continue;  // Products overflow above about 1e18: valid, never hit.
        int hits = 0;
        for (const Ray& ray : rays_at(mesh, 320, 81)) hits += brute_force(mesh, ray).primitive != 0xffffffffu;
        EXPECT_GE(hits, mesh.name == "one finite triangle among broken ones" ? 0 : 20) << mesh.name;
    }
}

TEST(Blas, TiesGoToTheLowestPrimitive) {
    TestMesh copies{"copies", {}, {}};
    copies.add({-1, -1, -2}, {1, -1, -2}, {0, 1, -2});
    copies.corners.assign(3000, copies.corners[0]);
    for (const BlasBuilder builder : {BlasBuilder::kSweep, BlasBuilder::kBinned}) {
        Blas blas;
        build_blas(copies.positions, copies.corners, builder, &blas);
        const BlasHit hit = closest_hit(blas, {{0, 0, 0}, {0, 0, -1}});
        EXPECT_EQ(hit.primitive, 0u);
        EXPECT_EQ(hit.t, 2.0f);
    }
}

TEST(Blas, HoldsEveryTriangleInALeafThatContainsIt) {
    for (const TestMesh& mesh : nasty_meshes()) {
        for (const BlasBuilder builder : {BlasBuilder::kSweep, BlasBuilder::kBinned}) {
            Blas blas;
            build_blas(mesh.positions, mesh.corners, builder, &blas);
            EXPECT_EQ(validate(blas, mesh.positions, mesh.corners), "") << mesh.name;
        }
    }
}

TEST(Blas, CountsTrianglesThatAreNotFinite) {
    const std::vector<TestMesh> meshes = nasty_meshes();
    const auto broken = std::find_if(meshes.begin(), meshes.end(),
                                     [](const TestMesh& mesh) { return mesh.name == "every fifth triangle not finite"; });
    ASSERT_NE(broken, meshes.end());
    for (const BlasBuilder builder : {BlasBuilder::kSweep, BlasBuilder::kBinned}) {
        Blas blas;
        build_blas(broken->positions, broken->corners, builder, &blas);
        EXPECT_EQ(blas.not_finite_count, 400u);
        refit_blas(broken->positions, broken->corners, &blas);
        EXPECT_EQ(blas.not_finite_count, 400u);
    }
}

TEST(Blas, IsReusedForMeshesOfAnySize) {
    Blas blas;
    for (const int count : {500, 1, 3000, 0, 20}) {
        const TestMesh soup = random_soup(count, 1.0f, 83 + count);
        for (const BlasBuilder builder : {BlasBuilder::kBinned, BlasBuilder::kSweep}) {
            build_blas(soup.positions, soup.corners, builder, &blas);
            EXPECT_EQ(validate(blas, soup.positions, soup.corners), "");
            for (const Ray& ray : rays_at(soup, 100, 84)) {
                ASSERT_TRUE(is_same(closest_hit(blas, ray), brute_force(soup, ray))) << count << " triangles";
            }
        }
    }
}

}  // namespace
}  // namespace zoe::test
