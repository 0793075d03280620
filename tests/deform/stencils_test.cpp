#include "engine/deform/stencils.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "engine/deform/subdivide.h"
#include "engine/math/parallel.h"
#include "tests/deform/subdivide_oracle.h"
#include "tests/support/allocation_count.h"

namespace zoe::test {
namespace {

using Points = std::vector<glm::vec3>;

TEST(Stencils, HandComputed) {
    const StencilTable table = {.offsets = {0, 4, 12},
                                .indices = {0, 1, 1, 1, 0, 1, 2, 2, 2, 2, 2, 2},
                                .weights = {0.25f, 0.75f, 0, 0, 0, 0, 0.5f, 0.25f, 0.125f, 0.125f, 0, 0},
                                .u_weights = {-1, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0},
                                .v_weights = {-1, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0}};
    const Points cage = {{0, 0, 0}, {4, 0, 0}, {0, 8, 2}};
    Points positions(2), normals(2, glm::vec3(7.0f));
    evaluate(table, cage, positions, normals);
    EXPECT_EQ(positions[0], glm::vec3(3, 0, 0));
    EXPECT_EQ(positions[1], glm::vec3(0, 8, 2));
    EXPECT_EQ(normals[0], glm::vec3(0.0f));  // Parallel tangents.
    EXPECT_EQ(normals[1], glm::vec3(0.0f));  // None.
    StencilTable turned = table;
    turned.indices[2] = 2;
    evaluate(turned, cage, positions, normals);
    EXPECT_NEAR(normals[0].y, -2 / std::sqrt(68.0f), 1e-6f);
    EXPECT_NEAR(normals[0].z, 8 / std::sqrt(68.0f), 1e-6f);
    evaluate({}, {}, {}, {});
}

TEST(Stencils, TinyAndHugeCagesHaveNormals) {
    for (const float scale : {1e-30f, 1e-15f, 1.0f, 1e15f, 1e30f}) {
        PolygonMesh mesh = sheet(4);
        for (glm::dvec3& p : mesh.points) p *= double(scale);
        const Subdivision made = make_subdivision(mesh.cage(), mesh.points.size(), {.level = 2});
        Points positions(made.stencils.vertex_count()), normals(positions.size());
        evaluate(made.stencils, mesh.positions(), positions, normals);
        for (const glm::vec3& n : normals) ASSERT_EQ(n, glm::vec3(0, 0, 1)) << "scale " << scale;
    }
}

TEST(Stencils, SumsAreInOrderWhateverTheThreads) {
    const uint64_t seed = 621;
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Rng rng(seed);
    const PolygonMesh mesh = random_closed(rng, 60, 4);
    const Points cage = mesh.positions();
    const StencilTable table = make_subdivision(mesh.cage(), cage.size(), {.level = 3}).stencils;
    ASSERT_GT(table.vertex_count(), 20000u);
    Points expected(table.vertex_count(), glm::vec3(0.0f));
    for (size_t v = 0; v < expected.size(); ++v) {
        ASSERT_EQ(table.offsets[v] % 4, 0u);
        float sum = 0.0f;
        for (uint32_t k = table.offsets[v]; k < table.offsets[v + 1]; ++k) {
            expected[v] += table.weights[k] * cage[table.indices[k]];
            sum += table.weights[k];
        }
        ASSERT_NEAR(sum, 1.0f, 1e-6f);
    }
    for (const int threads : {1, 2, 5}) {
        set_thread_count(threads);
        Points positions(expected.size()), alone(expected.size()), normals(expected.size());
        evaluate(table, cage, positions, normals);
        evaluate(table, cage, alone, {});
        const size_t bytes = expected.size() * sizeof(glm::vec3);
        EXPECT_EQ(std::memcmp(positions.data(), expected.data(), bytes), 0) << threads << " threads";
        EXPECT_EQ(std::memcmp(alone.data(), expected.data(), bytes), 0) << threads << " threads";
        static Points first_normals = normals;
        EXPECT_EQ(std::memcmp(normals.data(), first_normals.data(), bytes), 0) << threads << " threads";
    }
    set_thread_count(0);
}

TEST(Stencils, EvaluationAllocatesNothing) {
    set_thread_count(1);  // With more, the scheduler allocates its own tasks.
    const PolygonMesh mesh = sheet(20);
    const Points cage = mesh.positions();
    const Subdivision made = make_subdivision(mesh.cage(), cage.size(), {.level = 3});
    Points positions(made.stencils.vertex_count()), normals(positions.size());
    const size_t before = allocation_count();
    evaluate(made.stencils, cage, positions, normals);
    EXPECT_EQ(allocation_count(), before);
    EXPECT_GT(before, 0u);
    set_thread_count(0);
}

}  // namespace
}  // namespace zoe::test
