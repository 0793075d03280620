#include "engine/deform/stencils.h"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/deform/subdivide.h"
#include "engine/math/parallel.h"
#include "tests/bvh/each_target.h"
#include "tests/deform/subdivide_oracle.h"
#include "tests/math/random_inputs.h"
#include "tests/support/allocation_count.h"
#include "tests/support/same_bits.h"

namespace zoe::test {
namespace {

using Points = std::vector<glm::vec3>;

// In plain floats, term after term.
Points plain_sums(const StencilTable& table, const std::vector<float>& weights, const Points& cage) {
    Points sums(table.vertex_count(), glm::vec3(0.0f));
    for (size_t v = 0; v < sums.size(); ++v) {
        for (uint32_t k = table.offsets[v]; k < table.offsets[v + 1]; ++k) sums[v] += weights[k] * cage[table.indices[k]];
    }
    return sums;
}

// u x v, of length 1: worked out in double, vertex by vertex.
Points plain_normals(const StencilTable& table, const Points& cage) {
    const Points u = plain_sums(table, table.u_weights, cage), v = plain_sums(table, table.v_weights, cage);
    Points normals(u.size(), glm::vec3(0.0f));
    for (size_t k = 0; k < u.size(); ++k) {
        const glm::dvec3 across = glm::cross(glm::dvec3(u[k]), glm::dvec3(v[k]));
        const double square = glm::dot(across, across);
        if (square > 0.0) normals[k] = glm::vec3(across * (1.0 / std::sqrt(square)));
    }
    return normals;
}

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
    const Points expected_normals = plain_normals(table, cage);
    on_each_target([&] {
        for (const int threads : {1, 2, 5}) {
            SCOPED_TRACE(::testing::Message() << threads << " threads");
            set_thread_count(threads);
            Points positions(expected.size()), alone(expected.size()), normals(expected.size());
            evaluate(table, cage, positions, normals);
            evaluate(table, cage, alone, {});
            EXPECT_TRUE(has_same_bits(positions, expected));
            EXPECT_TRUE(has_same_bits(alone, expected));
            EXPECT_TRUE(has_same_bits(normals, expected_normals));
        }
    });
    set_thread_count(0);
}

// Whatever part of a vector the last vertices fill, and nothing behind them is written.
TEST(Stencils, AnyNumberOfVertices) {
    const uint64_t seed = 622;
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Rng rng(seed);
    Points cage;
    for (int k = 0; k < 9; ++k) cage.push_back(random_point(rng, 3.0f));
    for (const size_t count : {1u, 2u, 3u, 4u, 5u, 7u, 8u, 15u, 16u, 17u, 63u, 64u, 65u, 2047u, 2049u}) {
        StencilTable table;
        table.offsets.push_back(0);
        for (size_t v = 0; v < count; ++v) {
            for (uint32_t k = 4 * (1 + rng.below(3)); k > 0; --k) {
                table.indices.push_back(rng.below(9));  // The last one, too, behind which nothing may be read.
                for (auto* weights : {&table.weights, &table.u_weights, &table.v_weights}) {
                    weights->push_back(rng.uniform(-1.0f, 1.0f));
                }
            }
            table.offsets.push_back(static_cast<uint32_t>(table.indices.size()));
        }
        const glm::vec3 untouched(7.0f);
        on_each_target([&] {
            Points positions(count + 1, untouched), normals(count + 1, untouched);
            evaluate(table, cage, std::span(positions).first(count), std::span(normals).first(count));
            EXPECT_EQ(positions[count], untouched);
            EXPECT_EQ(normals[count], untouched);
            positions.pop_back();
            normals.pop_back();
            EXPECT_TRUE(has_same_bits(positions, plain_sums(table, table.weights, cage))) << count << " vertices";
            EXPECT_TRUE(has_same_bits(normals, plain_normals(table, cage))) << count << " vertices";
        });
    }
}

// Against sums in double. A sum of n terms is off by at most n roundings of the sum of their sizes, each term by one of its
// own; a normal by those of its tangents, over their sine and lengths.
TEST(Stencils, AgreeWithDouble) {
    const uint64_t seed = 623;
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Rng rng(seed);
    const PolygonMesh mesh = random_closed(rng, 60, 0);
    const Points cage = mesh.positions();
    const StencilTable table = make_subdivision(mesh.cage(), cage.size(), {.level = 3}).stencils;
    struct Sum {
        glm::dvec3 value{0.0};
        double error = 0.0;  // Of its length, at most.
    };
    const auto sum_of = [&](size_t v, const std::vector<float>& weights) {
        Sum sum;
        double size = 0.0;
        for (uint32_t k = table.offsets[v]; k < table.offsets[v + 1]; ++k) {
            const glm::dvec3 term = double(weights[k]) * glm::dvec3(cage[table.indices[k]]);
            sum.value += term;
            size += glm::length(term);
        }
        constexpr double kUnit = 5.9604645e-8;  // Of one rounding.
        sum.error = (table.offsets[v + 1] - table.offsets[v] + 1) * kUnit * size;
        return sum;
    };
    on_each_target([&] {
        Points positions(table.vertex_count()), normals(positions.size());
        evaluate(table, cage, positions, normals);
        double worst = 0.0;
        for (size_t v = 0; v < positions.size(); ++v) {
            const Sum position = sum_of(v, table.weights), a = sum_of(v, table.u_weights), b = sum_of(v, table.v_weights);
            ASSERT_LE(glm::distance(glm::dvec3(positions[v]), position.value), position.error) << "vertex " << v;
            const glm::dvec3 across = glm::cross(a.value, b.value);
            const double area = glm::length(across);
            const double area_error = a.error * glm::length(b.value) + b.error * glm::length(a.value) + a.error * b.error;
            if (!(area > 2.0 * area_error)) continue;  // No direction to compare.
            // Twice, as the length by which it is divided is off, too; and what is left of it is rounded.
            const double bound = 2.0 * area_error / (area - area_error) + 1e-7;
            const double error = glm::distance(glm::dvec3(normals[v]), across / area);
            ASSERT_LE(error, bound) << "vertex " << v;
            worst = std::max(worst, error / bound);
        }
        EXPECT_GT(worst, 0.01) << "the bound says nothing";
    });
}

TEST(Stencils, EvaluationAllocatesNothing) {
    set_thread_count(1);  // With more, the scheduler allocates its own tasks.
    const PolygonMesh mesh = sheet(20);
    const Points cage = mesh.positions();
    const Subdivision made = make_subdivision(mesh.cage(), cage.size(), {.level = 3});
    Points positions(made.stencils.vertex_count()), normals(positions.size());
    evaluate(made.stencils, cage, positions, normals);  // The first one makes room.
    const size_t before = allocation_count();
    evaluate(made.stencils, cage, positions, normals);
    EXPECT_EQ(allocation_count(), before);
    EXPECT_GT(before, 0u);
    set_thread_count(0);
}

}  // namespace
}  // namespace zoe::test
