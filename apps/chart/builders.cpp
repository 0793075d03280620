#include "apps/chart/builders.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <memory>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "apps/bench/frame_run.h"
#include "apps/bench/stopwatch.h"
#include "apps/bench/timed_parallel.h"
#include "apps/common/lone_blas.h"
#include "engine/bvh/build_auto.h"
#include "engine/bvh/epo.h"
#include "engine/math/parallel.h"

namespace zoe::chart {
namespace {

constexpr size_t kGrain = 4096;

struct PeerQuality {
    const char* series;
    PeerTree::Quality quality;
};
constexpr PeerQuality kPeerQualities[] = {{"Embree LOW", PeerTree::Quality::kLow},
                                          {"Embree MEDIUM", PeerTree::Quality::kMedium},
                                          {"Embree HIGH", PeerTree::Quality::kHigh}};

/// A tree of ours, built again and again in its own memory.
struct OurTree {
    Blas blas;
    BlasScratch scratch;
    std::vector<RawHit> hits;

    double build_ms(const Builder& builder, const WorldMesh& mesh) {
        Stopwatch watch;
        builder.build(mesh, &blas, &scratch);
        return watch.restart_ms();
    }
    double ray_ns(std::span<const Ray> rays) {
        hits.resize(rays.size());
        const LoneBlas frame(blas);
        const double ms = timed_parallel(rays.size(), kRaysATask, [&](size_t begin, size_t end) {
            closest_hits(frame.levels(), rays.subspan(begin, end - begin), hits.data() + begin, nullptr);
        });
        return 1e6 * ms / static_cast<double>(rays.size());
    }
};

double epo(const Bvh& bvh, const WorldMesh& mesh) {
    std::vector<Triangle> triangles;
    for (const uint32_t primitive : bvh.primitives) triangles.push_back(mesh.triangle(primitive));
    return epo_cost(bvh, triangles);
}

void require_same_hits(const std::vector<OurTree>& trees, const std::vector<Builder>& builders) {
    for (size_t k = 1; k < trees.size(); ++k) {
        const std::vector<RawHit>&a = trees[0].hits, &b = trees[k].hits;
        if (std::memcmp(a.data(), b.data(), a.size() * sizeof(RawHit)) != 0)
            throw std::runtime_error(
                fmt::format("the trees by {} and {} give different hits", builders[0].series, builders[k].series));
    }
}

}  // namespace

const char* series_of(BlasBuilder kind) {
    switch (kind) {
        case BlasBuilder::kBinned:
            return "binned";
        case BlasBuilder::kSweep:
            return "sweep";
        case BlasBuilder::kReinserted:
            return "reinserted";
        case BlasBuilder::kSbvh:
            return "SBVH";
        case BlasBuilder::kMedian:
            return "median split";
    }
    throw std::logic_error("no such builder");
}

Builder builder(BlasBuilder kind) {
    return {.series = series_of(kind), .build = [=](const WorldMesh& mesh, Blas* blas, BlasScratch* scratch) {
                build_blas(mesh.positions(), mesh.corners(), kind, blas, scratch);
            }};
}

std::vector<Builder> all_builders() {
    std::vector<Builder> builders;
    for (const BlasBuilder kind :
         {BlasBuilder::kMedian, BlasBuilder::kBinned, BlasBuilder::kSweep, BlasBuilder::kReinserted, BlasBuilder::kSbvh})
        builders.push_back(builder(kind));
    return builders;
}

Builder binned(int bin_count) {
    return {.series = "binned", .build = [=](const WorldMesh& mesh, Blas* blas, BlasScratch* scratch) {
                const size_t count = mesh.corners().size();
                BinnedConfig config = blas_binned_config();
                config.bin_count = bin_count;
                scratch->binned.items.resize(count);
                parallel_for(0, count, kGrain, [&](size_t begin, size_t end) {
                    for (size_t k = begin; k < end; ++k) {
                        const auto primitive = static_cast<uint32_t>(k);
                        scratch->binned.items[k] = binning::Item(bounds(mesh.triangle(primitive)), primitive);
                    }
                });
                scratch->bvh = build_binned_items(config, std::move(scratch->bvh), &scratch->binned);
                make_blas(scratch->bvh, mesh.positions(), mesh.corners(), blas, scratch);
            }};
}

BlasBuilder default_builder(Motion motion, uint64_t triangle_count) {
    switch (motion) {
        case Motion::kStatic:
        case Motion::kRigid:
            return choose_builder(triangle_count);
        case Motion::kDeforming:
            return BlasBuilder::kSweep;
        case Motion::kArbitrary:
            return BlasBuilder::kBinned;
    }
    throw std::logic_error("no such motion class");
}

std::vector<MeshSubject> mesh_subjects(const Settings& settings) {
    return {
        {settings.pick("static-3000", "static-100000", "static-1000000"), Motion::kStatic, settings.pick(32, 192, 512)},
        {settings.pick("deforming-20", "deforming-150", "deforming-500"), Motion::kDeforming, settings.pick(32, 192, 512)},
        {settings.pick("arbitrary-1000", "arbitrary-20000", "arbitrary-100000"), Motion::kArbitrary,
         settings.pick(32, 384, 512)}};
}

MeshSample sample_mesh(const MeshSubject& subject) {
    const BenchScene scene{
        .name = subject.scene, .scene = subject.scene, .size = {subject.side, subject.side}, .description = ""};
    Content content = open_scene(subject.scene, kBenchFps);
    FrameRun frame_run(content, choose_view(content, scene), scene.size);
    frame_run.run(0, nullptr, false);
    const std::span<const Ray> rays = frame_run.rays(RayKind::kDiffuse);
    return {.mesh = WorldMesh(frame_run.tlas()), .rays = {rays.begin(), rays.end()}};
}

std::vector<MeasuredTree> measure_trees(const MeshSample& sample, const std::vector<Builder>& builders,
                                        const Settings& settings) {
    const int rounds = settings.pick(3, 5, 5);
    const WorldMesh& mesh = sample.mesh;
    std::vector<OurTree> trees(builders.size());
    std::vector<std::unique_ptr<PeerTree>> peers;
    std::vector<std::function<double()>> builds, traces;
    for (size_t k = 0; k < builders.size(); ++k) {
        builds.emplace_back([&, k] { return trees[k].build_ms(builders[k], mesh); });
        traces.emplace_back([&, k] { return trees[k].ray_ns(sample.rays); });
    }
    std::vector<Hit> peer_hits(sample.rays.size());
    if (settings.has_peer) {
        for (const PeerQuality& quality : kPeerQualities) {
            peers.push_back(
                std::make_unique<PeerTree>(quality.quality, false, mesh.positions(), mesh.corners(), thread_count()));
            PeerTree* const peer = peers.back().get();
            builds.emplace_back([peer] { return peer->rebuild(); });
            // In the form of rays that takes it less.
            traces.emplace_back([&, peer] {
                double least_ms = std::numeric_limits<double>::infinity();
                for (const EmbreeRays form : forms_of(RayKind::kDiffuse))
                    least_ms = std::min(least_ms, peer->closest_hits(sample.rays, form, peer_hits));
                return 1e6 * least_ms / static_cast<double>(sample.rays.size());
            });
        }
    }
    const std::vector<std::vector<double>> build_ms = measure_in_turn(builds, rounds);
    const std::vector<std::vector<double>> ray_ns = measure_in_turn(traces, rounds);
    require_same_hits(trees, builders);
    std::vector<MeasuredTree> measured;
    for (size_t k = 0; k < builds.size(); ++k) {
        MeasuredTree tree{.build_ms = spread_of(build_ms[k]), .ray_ns = spread_of(ray_ns[k])};
        if (k < builders.size()) {
            tree.series = builders[k].series;
            tree.sah = sah_cost(trees[k].blas.tree, 1.0f);
            tree.epo = epo(trees[k].scratch.bvh, mesh);
            tree.work = work_of_rays(trees[k].blas, sample.rays);
        } else {
            tree.series = kPeerQualities[k - builders.size()].series;
        }
        measured.push_back(std::move(tree));
    }
    return measured;
}

}  // namespace zoe::chart
