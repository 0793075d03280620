// What makes trees and keeps them: builders, refit, clustering.
#include <map>
#include <utility>

#include "engine/bvh/blas.h"
#include "engine/bvh/build_binned.h"
#include "engine/bvh/build_clusters.h"
#include "engine/bvh/build_median.h"
#include "engine/bvh/build_sbvh.h"
#include "engine/bvh/build_sweep.h"
#include "engine/bvh/epo.h"
#include "engine/bvh/reinsert.h"
#include "engine/bvh/tree_stats.h"
#include "tests/bench/harness.h"
#include "tests/bench/inputs.h"
#include "tests/math/random_inputs.h"

namespace zoe::test {

namespace {

/// Adds what a tree is worth to the counters. The quality is worked out once a benchmark, however often the library repeats
/// it: it takes longer than a build.
void report_tree(benchmark::State& state, const std::string& name, const Bvh& bvh, const BenchMesh& mesh) {
    struct Quality {
        TreeStats stats;
        double epo;
    };
    static std::map<std::string, Quality> known;
    if (!known.contains(name)) {
        std::vector<Triangle> triangles;
        for (const uint32_t k : bvh.primitives) {
            const glm::uvec3 c = mesh.corners[k];
            triangles.push_back({mesh.positions[c.x], mesh.positions[c.y], mesh.positions[c.z], k});
        }
        known[name] = {tree_stats(bvh), epo_cost(bvh, triangles)};
    }
    const auto& [stats, epo] = known[name];
    state.counters["sah"] = stats.sah;
    state.counters["epo"] = epo;
    state.counters["depth"] = stats.depth;
    state.counters["duplicates"] = stats.duplicate_count;
    count_per_second(state, "triangles", mesh.corners.size());
}

/// build      makes a Bvh of boxes.
template <typename Build>
void build(benchmark::State& state, const std::string& name, const std::string& mesh_name, const Build& build) {
    const BenchMesh& mesh = mesh_named(mesh_name);
    const std::vector<Aabb> boxes = mesh.boxes();
    Bvh bvh;
    for (auto _ : state) {
        bvh = build(boxes, std::move(bvh));
        benchmark::DoNotOptimize(bvh.nodes.data());
    }
    if (const std::string fault = validate(bvh, boxes); !fault.empty()) return fail(state, fault);
    report_tree(state, name, bvh, mesh);
}

void build_with_pieces(benchmark::State& state, const std::string& name, const std::string& mesh_name) {
    const BenchMesh& mesh = mesh_named(mesh_name);
    StaticBvh bvh;
    for (auto _ : state) {
        bvh = build_sbvh(mesh.positions, mesh.corners);
        benchmark::DoNotOptimize(bvh.tree.nodes.data());
    }
    if (const std::string fault = validate(bvh, mesh.positions, mesh.corners); !fault.empty()) return fail(state, fault);
    report_tree(state, name, bvh.tree, mesh);
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

void cluster(benchmark::State& state, int count, const ClusterConfig& config) {
    const std::vector<Aabb> boxes = spread_boxes(count);
    PlocScratch scratch;
    Bvh bvh;
    for (auto _ : state) {
        bvh = build_clusters(boxes, config, std::move(bvh), &scratch);
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
        using Boxes = std::span<const Aabb>;
        const auto add_builder = [&](const std::string& method, auto builder) {
            add(method + "/" + mesh,
                [=](benchmark::State& state, const std::string& name) { build(state, name, mesh, builder); });
        };
        add_builder("build_median", [](Boxes boxes, Bvh storage) { return build_median(boxes, 4, std::move(storage)); });
        add_builder("build_binned", [](Boxes boxes, Bvh storage) { return build_binned(boxes, {}, std::move(storage)); });
        add_builder("build_sweep", [](Boxes boxes, Bvh storage) { return build_sweep(boxes, {}, std::move(storage)); });
        add_builder("build_sweep_and_reinsert", [](Boxes boxes, Bvh storage) {
            Bvh bvh = build_sweep(boxes, {}, std::move(storage));
            reinsert(&bvh);
            return bvh;
        });
        add("build_sbvh/" + mesh,
            [=](benchmark::State& state, const std::string& name) { build_with_pieces(state, name, mesh); });
        const std::pair<const char*, BlasBuilder> blas_builders[] = {{"build_blas_binned/", BlasBuilder::kBinned},
                                                                     {"build_blas_sweep/", BlasBuilder::kSweep},
                                                                     {"build_blas_reinserted/", BlasBuilder::kReinserted},
                                                                     {"build_blas_sbvh/", BlasBuilder::kSbvh}};
        for (const auto& [method, builder] : blas_builders) {
            add(method + mesh, [=, builder = builder](benchmark::State& state, const std::string&) {
                make_traversed(state, builder, mesh);
            });
        }
        add("refit_blas/" + mesh, [=](benchmark::State& state, const std::string&) { refit_moved(state, mesh); });
    }
    for (const int count : {1000, 10000, 100000}) {
        add("build_agglomerative/" + std::to_string(count),
            [=](benchmark::State& state, const std::string&) { cluster(state, count, {.exact_up_to = 0xffffffff}); });
        add("build_ploc/" + std::to_string(count),
            [=](benchmark::State& state, const std::string&) { cluster(state, count, {.exact_up_to = 0}); });
    }
}

}  // namespace zoe::test
