#include "apps/bench/trees.h"

#include <algorithm>
#include <memory>
#include <stdexcept>

#include <fmt/format.h>

#include "apps/bench/compare.h"
#include "apps/bench/frame_run.h"
#include "apps/bench/peer_tree.h"
#include "apps/bench/stopwatch.h"
#include "apps/common/interrupt.h"
#include "engine/bvh/blas.h"
#include "engine/bvh/build_agglomerative.h"
#include "engine/math/parallel.h"

namespace zoe {
namespace {

/// A method that took longer than this is not repeated.
constexpr double kLongBuild_ms = 1000.0;

struct Builder {
    const char* name;
    BlasBuilder builder;
};
constexpr std::array kBuilders = {Builder{"median split", BlasBuilder::kMedian}, Builder{"binned", BlasBuilder::kBinned},
                                  Builder{"sweep", BlasBuilder::kSweep},
                                  Builder{"sweep, reinserted", BlasBuilder::kReinserted},
                                  Builder{"SBVH, reinserted", BlasBuilder::kSbvh}};

struct PeerQuality {
    const char* name;
    PeerTree::Quality quality;
};
constexpr std::array kPeerQualities = {PeerQuality{"Embree LOW", PeerTree::Quality::kLow},
                                       PeerQuality{"Embree MEDIUM", PeerTree::Quality::kMedium},
                                       PeerQuality{"Embree HIGH", PeerTree::Quality::kHigh}};

/// All triangles of a frame, in the world.
struct WorldMesh {
    std::vector<glm::vec3> positions;
    std::vector<glm::uvec3> corners;

    explicit WorldMesh(const Tlas& tlas) {
        for (const Instance& instance : tlas.instances) {
            const auto first = static_cast<uint32_t>(positions.size());
            for (const glm::vec3& p : instance.positions) positions.push_back(instance.world_from_local.point(p));
            for (const glm::uvec3& c : instance.mesh->corners) corners.push_back(c + first);
        }
    }
};

/// The hits of a frame's rays.
struct Hits {
    std::array<std::vector<Hit>, 2> closest;  ///< [primary, diffuse]
    std::vector<uint8_t> is_shadowed;
};

/// A tree that is compared: how its rays are traced is the owner's business.
class Tree {
public:
    virtual ~Tree() = default;
    TreeRow row;

    /// Traces all rays of a kind, keeps the least time.
    virtual void trace_closest(std::span<const Ray> rays, RayKind kind, std::span<Hit> hits) = 0;
    virtual void trace_any(std::span<const Ray> rays, std::span<uint8_t> is_hit) = 0;

protected:
    void keep_least(RayKind kind, double ms) {
        double& least = row.trace_ms[static_cast<size_t>(kind)];
        least = least == 0.0 ? ms : std::min(least, ms);
    }
    void keep_least_single(double ms) {
        row.primary_single_ms = row.primary_single_ms == 0.0 ? ms : std::min(row.primary_single_ms, ms);
    }
};

class OurTree final : public Tree {
public:
    OurTree(const Builder& builder, const WorldMesh& mesh, int repeats) {
        row.name = builder.name;
        row.builder = builder.builder;
        BlasScratch scratch;
        for (int repeat = 0; repeat < repeats; ++repeat) {
            Stopwatch watch;
            build_blas(mesh.positions, mesh.corners, builder.builder, &blas_, &scratch);
            const double ms = watch.restart_ms();
            row.build_ms = repeat == 0 ? ms : std::min(row.build_ms, ms);
            if (ms > kLongBuild_ms) break;
        }
        row.byte_count = blas_.byte_count();
        row.sah = sah_cost(blas_.tree, 1.0f);
        const std::vector<Aabb> bounds = {blas_.tree.bounds()};
        std::vector<uint32_t> slots;
        CollapseScratch collapse_scratch;
        collapse(build_agglomerative(bounds, {}), {.block_size = 1, .max_leaf_blocks = 1}, &top_, &slots, &collapse_scratch);
        placed_ = {.local_from_world = {}, .bounds_world = bounds[0], .blas = &blas_, .id = 0, .is_identity = true};
    }

    void trace_closest(std::span<const Ray> rays, RayKind kind, std::span<Hit> hits) override {
        raw_.resize(rays.size());
        keep_least(kind, timed(rays.size(), [&](size_t begin, size_t end) {
                       closest_hits(scene(), rays.subspan(begin, end - begin), raw_.data() + begin, nullptr);
                   }));
        for (size_t k = 0; k < rays.size(); ++k) {
            const RawHit& hit = raw_[k];
            hits[k] = hit.id == kEmptyChild
                          ? Hit{}
                          : Hit{.t = hit.t, .u = hit.u, .v = hit.v, .node = NodeId{0}, .primitive = hit.primitive};
        }
        if (kind != RayKind::kPrimary) return;
        singles_.resize(rays.size());
        keep_least_single(timed(rays.size(), [&](size_t begin, size_t end) {
            for (size_t k = begin; k < end; ++k) closest_hits(scene(), rays.subspan(k, 1), &singles_[k], nullptr);
        }));
        for (size_t k = 0; k < rays.size(); ++k) {
            if (singles_[k].t != raw_[k].t || singles_[k].primitive != raw_[k].primitive)
                throw std::runtime_error(fmt::format("{}: ray {} alone gives another hit than in a batch", row.name, k));
        }
    }
    void trace_any(std::span<const Ray> rays, std::span<uint8_t> is_hit) override {
        keep_least(RayKind::kShadow, timed(rays.size(), [&](size_t begin, size_t end) {
                       any_hits(scene(), rays.subspan(begin, end - begin), is_hit.data() + begin, nullptr);
                   }));
    }
    /// One ray a call: packets share their work.
    TraverseCounts count(std::span<const Ray> rays) {
        TraverseCounts counts;
        RawHit hit;
        for (const Ray& ray : rays) closest_hits(scene(), {&ray, 1}, &hit, &counts);
        return counts;
    }

private:
    TwoLevels scene() const {
        return {.top = &top_, .instances = &placed_, .stack_size = top_.stack_size() + blas_.tree.stack_size() + 1};
    }
    template <typename Trace>
    static double timed(size_t count, Trace&& trace) {
        Stopwatch watch;
        parallel_for(0, count, kRaysATask, trace);
        return watch.restart_ms();
    }

    Blas blas_;
    WideBvh top_;
    PlacedBlas placed_;
    std::vector<RawHit> raw_, singles_;
};

class EmbreeTree final : public Tree {
public:
    EmbreeTree(const PeerQuality& quality, bool is_robust, const WorldMesh& mesh, int repeats)
        : tree_(quality.quality, is_robust, mesh.positions, mesh.corners, thread_count()) {
        row.name = quality.name;
        row.build_ms = tree_.build_ms();
        for (int repeat = 1; repeat < repeats && tree_.build_ms() <= kLongBuild_ms; ++repeat) {
            row.build_ms = std::min(row.build_ms, tree_.rebuild());
        }
        row.byte_count = tree_.byte_count();
    }

    void trace_closest(std::span<const Ray> rays, RayKind kind, std::span<Hit> hits) override {
        for (const EmbreeRays form : forms_of(kind)) {
            const double ms = tree_.closest_hits(rays, form, hits);
            keep_least(kind, ms);
            if (kind == RayKind::kPrimary && form == EmbreeRays::kSingle) keep_least_single(ms);
        }
    }
    void trace_any(std::span<const Ray> rays, std::span<uint8_t> is_hit) override {
        for (const EmbreeRays form : forms_of(RayKind::kShadow)) {
            keep_least(RayKind::kShadow, tree_.any_hits(rays, form, is_hit));
        }
    }

private:
    PeerTree tree_;
};

/// The rays of a scene's first frame, by kind, made with hits that the engine itself finds.
std::array<std::vector<Ray>, kRayKindCount> rays_of(FrameRun& frame_run) {
    std::array<std::vector<Ray>, kRayKindCount> rays;
    for (const RayKind kind : kRayKinds) {
        const std::span<const Ray> made = frame_run.rays(kind);
        rays[static_cast<size_t>(kind)].assign(made.begin(), made.end());
    }
    return rays;
}

uint64_t count_differences(const Hits& expected, const Hits& found) {
    uint64_t count = 0;
    for (size_t kind = 0; kind < 2; ++kind) {
        for (size_t k = 0; k < expected.closest[kind].size(); ++k)
            count += is_disagreement(expected.closest[kind][k], found.closest[kind][k]);
    }
    for (size_t k = 0; k < expected.is_shadowed.size(); ++k) count += expected.is_shadowed[k] != found.is_shadowed[k];
    return count;
}

}  // namespace

double TreeComparison::mrays_per_s(const TreeRow& row, RayKind kind) const {
    const size_t k = static_cast<size_t>(kind);
    return row.trace_ms[k] > 0.0 ? static_cast<double>(ray_count[k]) / row.trace_ms[k] / 1000.0 : 0.0;
}

double TreeComparison::frame_ms(const TreeRow& row) const {
    double ms = row.build_ms;
    for (const RayKind kind : {RayKind::kPrimary, RayKind::kDiffuse}) {
        const double rate = mrays_per_s(row, kind);
        if (rate > 0.0) ms += 1000.0 / rate;
    }
    return ms;
}

TreeComparison compare_trees(const BenchScene& scene, const PlayConfig& config, const Report& report) {
    Content content = open_scene(scene.scene, kBenchFps);
    FrameRun frame_run(content, choose_view(content, scene), scene.size);
    frame_run.run(0, nullptr, false);
    const WorldMesh mesh(frame_run.tlas());
    const auto rays = rays_of(frame_run);

    TreeComparison comparison{.scene = scene.name, .triangle_count = mesh.corners.size(), .rows = {}};
    for (size_t kind = 0; kind < kRayKindCount; ++kind) comparison.ray_count[kind] = rays[kind].size();
    const size_t tree_count = kBuilders.size() + (config.has_peer ? kPeerQualities.size() : 0);
    const double step_count = static_cast<double>(tree_count) * (1.0 + scene.repeats);
    double steps_done = 0.0;
    const auto report_step = [&](const std::string& detail) {
        if (is_interrupted()) throw Interrupted("interrupted");
        report(steps_done++ / step_count, detail);
    };

    std::vector<std::unique_ptr<Tree>> trees;
    for (const Builder& builder : kBuilders) {
        report_step(fmt::format("building: {}", builder.name));
        auto tree = std::make_unique<OurTree>(builder, mesh, scene.repeats);
        const TraverseCounts primary = tree->count(rays[0]), diffuse = tree->count(rays[1]);
        const double count = std::max<double>(1.0, static_cast<double>(rays[0].size() + rays[1].size()));
        tree->row.nodes = (double(primary.nodes) + double(diffuse.nodes)) / count;
        tree->row.triangles = (double(primary.triangles) + double(diffuse.triangles)) / count;
        trees.push_back(std::move(tree));
    }
    if (config.has_peer) {
        for (const PeerQuality& quality : kPeerQualities) {
            report_step(fmt::format("building: {}", quality.name));
            trees.push_back(std::make_unique<EmbreeTree>(quality, config.is_peer_robust, mesh, scene.repeats));
        }
    }
    Hits expected;
    for (int repeat = 0; repeat < scene.repeats; ++repeat) {
        for (const auto& tree : trees) {
            report_step(fmt::format("repeat {}/{}: {}", repeat + 1, scene.repeats, tree->row.name));
            Hits hits;
            for (const RayKind kind : {RayKind::kPrimary, RayKind::kDiffuse}) {
                const size_t k = static_cast<size_t>(kind);
                hits.closest[k].resize(rays[k].size());
                tree->trace_closest(rays[k], kind, hits.closest[k]);
            }
            hits.is_shadowed.resize(rays[2].size());
            tree->trace_any(rays[2], hits.is_shadowed);
            if (expected.is_shadowed.empty() && expected.closest[0].empty()) expected = hits;
            if (tree->row.is_peer()) {
                tree->row.disagreements = std::max(tree->row.disagreements, count_differences(expected, hits));
            } else if (hits.closest != expected.closest || hits.is_shadowed != expected.is_shadowed) {
                throw std::runtime_error(fmt::format("{}: the trees by {} and {} give different hits", scene.name,
                                                     trees.front()->row.name, tree->row.name));
            }
        }
    }
    for (const auto& tree : trees) comparison.rows.push_back(tree->row);
    return comparison;
}

}  // namespace zoe
