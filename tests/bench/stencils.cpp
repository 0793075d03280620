// Stencils of a subdivision surface, beside a memcpy that moves as many bytes. Bytes count what is read and what is written:
// the table and the new vertices once, the cage once (it stays in the cache).
#include <cmath>
#include <vector>

#include <glm/geometric.hpp>

#include "engine/deform/stencils.h"
#include "engine/deform/subdivide.h"
#include "tests/bench/harness.h"

namespace zoe::test {

namespace {

constexpr uint32_t kCageSide = 100;

/// A closed cage of side * side quads: a grid whose ends meet.
Cage wrapped_grid(uint32_t side) {
    Cage cage;
    for (uint32_t y = 0; y < side; ++y) {
        for (uint32_t x = 0; x < side; ++x) {
            const uint32_t right = (x + 1) % side, below = (y + 1) % side;
            cage.face_sizes.push_back(4);
            for (const uint32_t v : {y * side + x, y * side + right, below * side + right, below * side + x}) {
                cage.vertices.push_back(v);
            }
        }
    }
    return cage;
}

/// Two rounds over 10,000 quads: 160,000 vertices.
const StencilTable& stencils_of_cage() {
    static const StencilTable table =
        make_subdivision(wrapped_grid(kCageSide), size_t(kCageSide) * kCageSide, SubdivisionOptions{.level = 2}).stencils;
    return table;
}

size_t moved_bytes(bool has_normals) {
    const StencilTable& table = stencils_of_cage();
    const size_t read_by_entry = sizeof(uint32_t) + (has_normals ? 3 : 1) * sizeof(float);
    const size_t vector_count = kCageSide * kCageSide + (has_normals ? 2 : 1) * table.vertex_count();
    return table.indices.size() * read_by_entry + table.offsets.size() * sizeof(uint32_t) + vector_count * sizeof(glm::vec3);
}

void stencils(benchmark::State& state, bool has_normals) {
    const StencilTable& table = stencils_of_cage();
    const std::vector<glm::vec3> cage = random_points(kCageSide * kCageSide, 51);
    std::vector<glm::vec3> out(table.vertex_count()), normals(has_normals ? table.vertex_count() : 0);
    for (auto _ : state) {
        evaluate(table, cage, out, normals);
        benchmark::DoNotOptimize(out.data());
        benchmark::ClobberMemory();
    }
    count_per_second(state, "vertices", table.vertex_count());
    state.counters["entries_per_vertex"] = double(table.indices.size()) / double(table.vertex_count());
    count_per_second(state, "bytes", moved_bytes(has_normals));
    for (size_t v = 0; v < table.vertex_count(); ++v) {
        glm::dvec3 expected(0.0);
        for (uint32_t k = table.offsets[v]; k < table.offsets[v + 1]; ++k) {
            expected += double(table.weights[k]) * glm::dvec3(cage[table.indices[k]]);
        }
        if (!is_near(out[v], expected)) return fail(state, "vertex " + std::to_string(v) + " is in a wrong place");
        if (has_normals && !(std::abs(glm::length(normals[v]) - 1.0f) < 1e-3f)) {
            return fail(state, "the normal of vertex " + std::to_string(v) + " has another length than 1");
        }
    }
}

void copy_as_much(benchmark::State& state, bool has_normals) {
    copy_bytes(state, moved_bytes(has_normals));
}

}  // namespace

void register_stencils() {
    for (const bool has_normals : {false, true}) {
        const std::string name = std::string("stencils/") + (has_normals ? "positions_and_normals" : "positions");
        benchmark::RegisterBenchmark(name.c_str(), stencils, has_normals)->Unit(benchmark::kMicrosecond);
        benchmark::RegisterBenchmark((name + "/memcpy").c_str(), copy_as_much, has_normals)->Unit(benchmark::kMicrosecond);
    }
}

}  // namespace zoe::test
