// What makes trees and keeps them: builders, refit, clustering.
#include <map>
#include <utility>

#include "engine/bvh/blas.h"
#include "engine/bvh/build_agglomerative.h"
#include "engine/bvh/build_binned.h"
#include "engine/bvh/build_sweep.h"
#include "engine/bvh/epo.h"
#include "tests/bench/harness.h"
#include "tests/bench/inputs.h"
#include "tests/math/random_inputs.h"

namespace zoe::test {

namespace {

struct TreeQuality {
    double sah, epo, depth;
};

/// Adds what a tree is worth to the counters, or fails where it is broken. The quality is worked out once a benchmark,
/// however often the library repeats it: it takes longer than a build.
void report_tree(benchmark::State& state, const std::string& name, const Bvh& bvh, const BenchMesh& mesh) {
    if (const std::string fault = validate(bvh, mesh.boxes()); !fault.empty()) return fail(state, fault);
    static std::map<std::string, TreeQuality> known;
    if (!known.contains(name)) {
        std::vector<Triangle> triangles;
        for (const uint32_t k : bvh.primitives) {
            const glm::uvec3 c = mesh.corners[k];
            triangles.push_back({mesh.positions[c.x], mesh.positions[c.y], mesh.positions[c.z], k});
        }
        known[name] = {sah_cost(bvh), epo_cost(bvh, triangles), double(depth(bvh))};
    }
    const TreeQuality& quality = known[name];
    state.counters["sah"] = quality.sah;
    state.counters["epo"] = quality.epo;
    state.counters["depth"] = quality.depth;
}

void build(benchmark::State& state, const std::string& name, BlasBuilder builder, const std::string& mesh_name) {
    const BenchMesh& mesh = mesh_named(mesh_name);
    const std::vector<Aabb> boxes = mesh.boxes();
    Bvh bvh;
    for (auto _ : state) {
        bvh = builder == BlasBuilder::kSweep ? build_sweep(boxes, {}, std::move(bvh))
                                             : build_binned(boxes, {}, std::move(bvh));
        benchmark::DoNotOptimize(bvh.nodes.data());
    }
    count_per_second(state, "triangles", mesh.corners.size());
    report_tree(state, name, bvh, mesh);
}

double bytes_per_triangle(const Blas& blas) {
    return static_cast<double>(blas.byte_count()) / static_cast<double>(blas.triangle_count);
}

/// From vertices to what is traversed.
void make_traversed(benchmark::State& state, BlasBuilder builder, const std::string& mesh_name) {
    const BenchMesh& mesh = mesh_named(mesh_name);
    Blas blas;
    BlasScratch scratch;
    for (auto _ : state) {
        build_blas(mesh.positions, mesh.corners, builder, &blas, &scratch);
        benchmark::DoNotOptimize(blas.blocks.data());
    }
    count_per_second(state, "triangles", mesh.corners.size());
    state.counters["bytes_per_triangle"] = bytes_per_triangle(blas);
    state.counters["sah"] = sah_cost(blas.tree, 1.0f);
    if (const std::string fault = validate(blas, mesh.positions, mesh.corners); !fault.empty()) fail(state, fault);
}

/// The tree of the mesh at rest, fitted to where it moved. SAH is the wide tree's: a node's eight boxes cost as much as a
/// block of four triangles.
void refit_moved(benchmark::State& state, const std::string& mesh_name) {
    const BenchMesh& mesh = mesh_named(mesh_name);
    Blas blas;
    build_blas(mesh.rest, mesh.corners, BlasBuilder::kSweep, &blas);
    state.counters["sah_at_rest"] = sah_cost(blas.tree, 1.0f);
    for (auto _ : state) {
        refit_blas(mesh.positions, mesh.corners, &blas);
        benchmark::DoNotOptimize(blas.blocks.data());
        benchmark::ClobberMemory();
    }
    count_per_second(state, "triangles", mesh.corners.size());
    state.counters["sah_moved"] = sah_cost(blas.tree, 1.0f);
    if (const std::string fault = validate(blas, mesh.positions, mesh.corners); !fault.empty()) fail(state, fault);
}

/// Boxes of about the same size all over a cube: instances of a crowd.
std::vector<Aabb> spread_boxes(int count) {
    Rng rng(21);
    std::vector<Aabb> boxes;
    for (int k = 0; k < count; ++k) {
        const glm::vec3 middle = random_point(rng, 100.0f), half = glm::vec3(0.5f) + glm::abs(random_point(rng, 1.0f));
        boxes.push_back({middle - half, middle + half});
    }
    return boxes;
}

void cluster(benchmark::State& state, int count) {
    const std::vector<Aabb> boxes = spread_boxes(count);
    Bvh bvh;
    for (auto _ : state) {
        bvh = build_agglomerative(boxes, std::move(bvh));
        benchmark::DoNotOptimize(bvh.nodes.data());
    }
    count_per_second(state, "instances", boxes.size());
    state.counters["sah"] = sah_cost(bvh);
    state.counters["depth"] = depth(bvh);
    if (const std::string fault = validate(bvh, boxes); !fault.empty()) fail(state, fault);
}

}  // namespace

void register_builders() {
    const auto add = [](const std::string& name, auto run) {
        benchmark::RegisterBenchmark(name.c_str(), run, name)->Unit(benchmark::kMillisecond);
    };
    for (const std::string mesh : kMeshNames) {
        add("build_sweep/" + mesh,
            [=](benchmark::State& state, const std::string& name) { build(state, name, BlasBuilder::kSweep, mesh); });
        add("build_binned/" + mesh,
            [=](benchmark::State& state, const std::string& name) { build(state, name, BlasBuilder::kBinned, mesh); });
        add("build_blas_binned/" + mesh,
            [=](benchmark::State& state, const std::string&) { make_traversed(state, BlasBuilder::kBinned, mesh); });
        add("build_blas_sweep/" + mesh,
            [=](benchmark::State& state, const std::string&) { make_traversed(state, BlasBuilder::kSweep, mesh); });
        add("refit_blas/" + mesh, [=](benchmark::State& state, const std::string&) { refit_moved(state, mesh); });
    }
    for (const int count : {1000, 10000}) {
        add("build_agglomerative/" + std::to_string(count),
            [=](benchmark::State& state, const std::string&) { cluster(state, count); });
    }
}

}  // namespace zoe::test
