// Boxes around turned meshes: they hold every vertex, and little else.

#include "engine/bvh/reach.h"

#include <cmath>

#include <gtest/gtest.h>
#include <glm/ext/matrix_double3x3.hpp>
#include <glm/ext/vector_double3.hpp>

#include "engine/bvh/traverse.h"
#include "tests/bvh/inputs.h"
#include "tests/math/random_inputs.h"

namespace zoe::test {
namespace {

struct Measured {
    explicit Measured(const TestMesh& from) : mesh(from) {
        build_blas(mesh.positions, mesh.corners, BlasBuilder::kSbvh, &blas);
        if (!blas.tree.nodes.empty()) measure_reach(blas, &reach);
    }
    const TestMesh& mesh;
    Blas blas;
    Reach reach;
};

// Of finite triangles, in double.
struct Extent {
    glm::dvec3 lo{HUGE_VAL}, hi{-HUGE_VAL};
    double half_area() const {
        const glm::dvec3 size = hi - lo;
        return size.x * size.y + size.y * size.z + size.z * size.x;
    }
};
Extent exact_extent(const TestMesh& mesh, const Affine& map) {
    Extent extent;
    for (const glm::uvec3& corners : mesh.corners) {
        const auto& p = mesh.positions;
        if (!is_finite(p[corners.x]) || !is_finite(p[corners.y]) || !is_finite(p[corners.z])) continue;
        for (int k = 0; k < 3; ++k) {
            const glm::dvec3 world = glm::dmat3(map.linear) * glm::dvec3(p[corners[k]]) + glm::dvec3(map.translation);
            extent.lo = glm::min(extent.lo, world);
            extent.hi = glm::max(extent.hi, world);
        }
    }
    return extent;
}

bool contains(const Aabb& box, const Extent& extent) {
    for (int k = 0; k < 3; ++k) {
        if (!(double(box.lo[k]) <= extent.lo[k] && extent.hi[k] <= double(box.hi[k]))) return false;
    }
    return true;
}

Affine random_turn(Rng& rng) {
    Affine map{glm::mat3_cast(random_rotation(rng)), random_point(rng, 10.0f)};
    for (int axis = 0; axis < 3; ++axis) map.linear[axis] *= random_sign(rng) * log_uniform(rng, 0.1, 10.0);
    return map;
}

TestMesh ellipsoid(int triangle_count, uint64_t seed) {
    TestMesh mesh{"ellipsoid", {}, {}};
    Rng rng(seed);
    for (int k = 0; k < triangle_count; ++k) {
        const glm::vec3 p = glm::vec3(3.0f, 1.2f, 2.0f) * random_direction(rng);
        mesh.add(p, p + random_point(rng, 0.02f), p + random_point(rng, 0.02f));
    }
    return mesh;
}

TEST(Reach, BoxesHoldEveryVertexUnderAnyMap) {
    const uint64_t seed = 301;
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Rng rng(seed);
    std::vector<TestMesh> meshes = nasty_meshes();
    meshes.push_back(ellipsoid(500, seed));
    meshes.push_back(random_soup(1, 1.0f, seed));
    int tight_count = 0;
    for (const TestMesh& mesh : meshes) {
        SCOPED_TRACE(mesh.name);
        const Measured measured(mesh);
        const Aabb bounds = measured.blas.tree.bounds();
        if (!bounds.is_proper()) continue;
        for (int round = 0; round < 100; ++round) {
            Affine map = round % 2 == 0 ? random_turn(rng) : random_affine(rng, 0.1, 10.0, 10.0f);
            const float size = log_uniform(rng, 1e-6, 1e6);
            map.linear *= size;
            map.translation *= rng.below(2) ? size : log_uniform(rng, 1e-6, 1e6);
            Affine inverse;
            if (!invert(map, &inverse)) continue;
            const Aabb whole = transform(map, bounds);
            if (!whole.is_finite()) continue;
            const Aabb tight = tight_bounds(measured.reach, map, inverse, whole);
            ASSERT_TRUE(contains(tight, exact_extent(mesh, map))) << "round " << round;
            ASSERT_TRUE(whole.contains(tight)) << "round " << round;
            tight_count += tight.half_area() < 0.99 * whole.half_area();
        }
    }
    EXPECT_GT(tight_count, 200);
}

// A flat axis reaches nowhere: it must not drown what the others do, however small these are.
TEST(Reach, BoxesHoldFlatMeshesOfAnySize) {
    for (const float size : {1e-12f, 1e-6f, 1e-4f, 1e-2f, 1.0f, 1e6f, 1e12f}) {
        for (int flat = 0; flat < 3; ++flat) {
            TestMesh mesh{"card", {}, {}};
            glm::vec3 corner[4];
            for (int k = 0; k < 4; ++k) {
                corner[k][(flat + 1) % 3] = k & 1 ? size : -size;
                corner[k][(flat + 2) % 3] = k & 2 ? 0.5f * size : -size;
                corner[k][flat] = 0.25f * size;
            }
            mesh.add(corner[0], corner[1], corner[3]);
            mesh.add(corner[0], corner[3], corner[2]);
            const Measured measured(mesh);
            Rng rng(471);
            for (int k = 0; k < 2000; ++k) {
                Affine map = random_turn(rng), inverse;
                map.linear *= 1.0f / size;
                ASSERT_TRUE(invert(map, &inverse));
                const Aabb whole = transform(map, measured.blas.tree.bounds());
                EXPECT_TRUE(contains(tight_bounds(measured.reach, map, inverse, whole), exact_extent(mesh, map)))
                    << "size " << size << ", flat along " << flat << ", seed 471, map " << k;
            }
        }
    }
}

TEST(Reach, BoxesHoldLittleElse) {
    const uint64_t seed = 302;
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Rng rng(seed);
    for (const TestMesh& mesh : {ellipsoid(2000, seed), random_soup(40, 1.0f, seed)}) {
        SCOPED_TRACE(mesh.name);
        const Measured measured(mesh);
        double tight_area = 0.0, whole_area = 0.0;
        const int rounds = 1000;
        for (int round = 0; round < rounds; ++round) {
            Affine map{glm::mat3_cast(random_rotation(rng)), random_point(rng, 10.0f)}, inverse;
            ASSERT_TRUE(invert(map, &inverse));
            const Aabb whole = transform(map, measured.blas.tree.bounds());
            const double exact = exact_extent(mesh, map).half_area();
            const Aabb tight = tight_bounds(measured.reach, map, inverse, whole);
            ASSERT_LT(tight.half_area(), 1.15 * exact) << "round " << round;
            tight_area += tight.half_area() / exact / rounds;
            whole_area += whole.half_area() / exact / rounds;
        }
        EXPECT_LT(tight_area, 1.03) << tight_area;
        EXPECT_GT(whole_area, 1.2);
    }
}

TEST(Reach, MapsThatAreSkewedKeepTheWholeBox) {
    const TestMesh mesh = ellipsoid(50, 303);
    const Measured measured(mesh);
    Affine map, inverse;
    map.linear[1][0] = 3.0f;
    ASSERT_TRUE(invert(map, &inverse));
    const Aabb whole = transform(map, measured.blas.tree.bounds());
    const Aabb tight = tight_bounds(measured.reach, map, inverse, whole);
    EXPECT_TRUE(tight.lo == whole.lo && tight.hi == whole.hi);
}

// Where looking for the farthest triangle ends before it is found, nodes' boxes stand in.
TEST(Reach, FlatMeshesTakeNoLongerThanOthers) {
    TestMesh mesh{"plane", {}, {}};
    Rng rng(304);
    for (int k = 0; k < 20000; ++k) {
        const glm::vec3 at(rng.uniform(-1.0f, 1.0f), rng.uniform(-1.0f, 1.0f), 1e-6f * rng.uniform());
        mesh.add(at, at + glm::vec3(0.01f, 0, 0), at + glm::vec3(0, 0.01f, 0));
    }
    const Measured measured(mesh);
    for (int round = 0; round < 100; ++round) {
        const Affine map = random_turn(rng);
        Affine inverse;
        ASSERT_TRUE(invert(map, &inverse));
        const Aabb whole = transform(map, measured.blas.tree.bounds());
        ASSERT_TRUE(contains(tight_bounds(measured.reach, map, inverse, whole), exact_extent(mesh, map)));
    }
}

}  // namespace
}  // namespace zoe::test
