// Rays through the tree of one mesh.
#include <cstring>
#include <limits>
#include <map>

#include "engine/bvh/traverse.h"
#include "tests/bench/harness.h"
#include "tests/bench/inputs.h"

namespace zoe::test {

namespace {

constexpr int kSide = 128;
constexpr float kInf = std::numeric_limits<float>::infinity();

BlasHit trace(const Blas& blas, const Ray& ray, TraverseCounts* counts = nullptr) {
    BlasHit hit;
    closest_hit(blas, RayFrame(ray), 0.0f, ray.t_min, &hit, counts);
    return hit;
}

bool is_same(const BlasHit& a, const BlasHit& b) {
    return std::memcmp(&a, &b, sizeof a) == 0;
}

Blas built(const BenchMesh& mesh, BlasBuilder builder) {
    Blas blas;
    build_blas(mesh.positions, mesh.corners, builder, &blas);
    return blas;
}

/// The tree of a mesh, rays at it, and their hits as another tree gives them: the same to the last bit.
struct RayCase {
    Blas blas;
    std::vector<Ray> rays;
    std::vector<BlasHit> hits;
    double hit_share = 0.0;
};

const RayCase& case_named(const std::string& mesh_name, bool is_coherent) {
    static std::map<std::pair<std::string, bool>, RayCase> cases;
    const auto found = cases.find({mesh_name, is_coherent});
    if (found != cases.end()) return found->second;
    RayCase& made = cases[{mesh_name, is_coherent}];
    made.blas = built(mesh_named(mesh_name), BlasBuilder::kSweep);
    const Aabb box = made.blas.tree.bounds();
    made.rays = is_coherent ? coherent_rays(box, kSide) : incoherent_rays(box, kSide * kSide);
    const Blas other = built(mesh_named(mesh_name), BlasBuilder::kBinned);
    for (const Ray& ray : made.rays) {
        made.hits.push_back(trace(other, ray));
        if (made.hits.back().t < kInf) made.hit_share += 1.0 / static_cast<double>(made.rays.size());
    }
    return made;
}

void trace_closest(benchmark::State& state, const std::string& mesh_name, bool is_coherent) {
    const RayCase& input = case_named(mesh_name, is_coherent);
    std::vector<BlasHit> hits(input.rays.size());
    for (auto _ : state) {
        for (size_t k = 0; k < input.rays.size(); ++k) hits[k] = trace(input.blas, input.rays[k]);
        benchmark::ClobberMemory();
    }
    count_per_second(state, "rays", input.rays.size());
    TraverseCounts counts;
    for (size_t k = 0; k < hits.size(); ++k) {
        if (!is_same(hits[k], input.hits[k])) return fail(state, "another tree gives another hit");
        trace(input.blas, input.rays[k], &counts);
    }
    state.counters["hit_share"] = input.hit_share;
    state.counters["boxes_per_ray"] = double(counts.nodes) / double(hits.size());
    state.counters["triangles_per_ray"] = double(counts.triangles) / double(hits.size());
}

void trace_any(benchmark::State& state, const std::string& mesh_name, bool is_coherent) {
    const RayCase& input = case_named(mesh_name, is_coherent);
    std::vector<uint8_t> is_hit(input.rays.size());
    const auto is_any_hit = [&](const Ray& ray, TraverseCounts* counts) {
        return any_hit(input.blas, RayFrame(ray), 0.0f, ray.t_min, ray.t_max, counts);
    };
    for (auto _ : state) {
        for (size_t k = 0; k < input.rays.size(); ++k) is_hit[k] = is_any_hit(input.rays[k], nullptr);
        benchmark::ClobberMemory();
    }
    count_per_second(state, "rays", input.rays.size());
    TraverseCounts counts;
    for (size_t k = 0; k < is_hit.size(); ++k) {
        if (bool(is_hit[k]) != (input.hits[k].t < kInf)) return fail(state, "any hit is not where the closest is");
        is_any_hit(input.rays[k], &counts);
    }
    state.counters["hit_share"] = input.hit_share;
    state.counters["boxes_per_ray"] = double(counts.nodes) / double(is_hit.size());
    state.counters["triangles_per_ray"] = double(counts.triangles) / double(is_hit.size());
}

}  // namespace

void register_rays() {
    for (const std::string mesh : kMeshNames) {
        for (const bool is_coherent : {true, false}) {
            const std::string input = mesh + (is_coherent ? "/coherent" : "/incoherent");
            for (const bool is_any : {false, true}) {
                benchmark::RegisterBenchmark(((is_any ? "any_hit/" : "closest_hit/") + input).c_str(),
                                             is_any ? trace_any : trace_closest, mesh, is_coherent)
                    ->Unit(benchmark::kMillisecond);
            }
        }
    }
}

}  // namespace zoe::test
