#include "apps/bench/trees.h"

#include <algorithm>
#include <memory>
#include <stdexcept>

#include <fmt/format.h>

#include "apps/bench/compare.h"
#include "apps/bench/frame_run.h"
#include "apps/bench/timed_parallel.h"
#include "apps/bench/traced_tree.h"
#include "apps/bench/world_mesh.h"
#include "apps/common/interrupt.h"

namespace zoe {
namespace {

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

/// The hits of a frame's rays.
struct Hits {
    std::array<std::vector<Hit>, 2> closest;  ///< [primary, diffuse]
    std::vector<uint8_t> is_shadowed;
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

/// Takes down how a peer's hits differ, unless more did in a repeat before.
void compare(const std::array<std::vector<Ray>, kRayKindCount>& rays, const Hits& ours, const Hits& peers,
             std::vector<Disagreement>* most) {
    std::vector<Disagreement> found;
    for (const RayKind kind : {RayKind::kPrimary, RayKind::kDiffuse}) {
        const auto k = static_cast<size_t>(kind);
        compare_closest(0, kind, rays[k], ours.closest[k], peers.closest[k], &found);
    }
    compare_any(0, RayKind::kShadow, rays[2], ours.is_shadowed, peers.is_shadowed, &found);
    if (found.size() > most->size()) *most = std::move(found);
}

/// report_within    called with how many are judged.
template <typename ReportWithin>
void judge_row(const WorldMesh& mesh, std::span<const Disagreement> disagreements, TreeRow* row,
               ReportWithin&& report_within) {
    const std::span<const Disagreement> judged = disagreements.first(std::min(disagreements.size(), kMaxJudged));
    row->disagreements = disagreements.size();
    row->not_judged = disagreements.size() - judged.size();
    const Tlas frame = mesh.as_frame();
    for (size_t begin = 0; begin < judged.size(); begin += kJudgedAtOnce) {
        report_within(begin);
        const auto some = judged.subspan(begin, std::min(kJudgedAtOnce, judged.size() - begin));
        for (const Verdict verdict : judge(frame, some)) ++row->verdicts[static_cast<size_t>(verdict)];
    }
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
    Content content = open_bench_scene(scene);
    FrameRun frame_run(content, choose_view(content, scene), scene.size);
    frame_run.run(0, nullptr, false);
    write_instruction_count("the rays are made");
    const WorldMesh mesh(frame_run.tlas());
    if (frame_run.tlas().bounds().is_empty())
        throw std::runtime_error(fmt::format("{}: its first frame shows no triangles to build a tree over", scene.name));
    const auto rays = rays_of(frame_run);

    TreeComparison comparison{.scene = scene.name, .triangle_count = mesh.corners().size(), .rows = {}};
    for (size_t kind = 0; kind < kRayKindCount; ++kind) comparison.ray_count[kind] = rays[kind].size();
    const size_t tree_count = kBuilders.size() + (config.has_peer ? kPeerQualities.size() : 0);
    const double step_count = static_cast<double>(tree_count) * (1.0 + scene.repeats);
    double steps_done = 0.0;
    const auto report_within_step = [&](const std::string& detail) {
        if (is_interrupted()) throw Interrupted("interrupted");
        report(steps_done / step_count, detail);
    };
    const auto report_step = [&](const std::string& detail) {
        report_within_step(detail);
        ++steps_done;
    };

    std::vector<std::unique_ptr<TracedTree>> trees;
    for (const Builder& builder : kBuilders) {
        report_step(fmt::format("building: {}", builder.name));
        trees.push_back(make_our_tree(builder.name, builder.builder, mesh, scene.repeats, rays[0], rays[1]));
    }
    if (config.has_peer) {
        for (const PeerQuality& quality : kPeerQualities) {
            report_step(fmt::format("building: {}", quality.name));
            trees.push_back(make_peer_tree(quality.name, quality.quality, config.peer.is_robust, mesh, scene.repeats));
        }
    }
    Hits expected;
    std::vector<std::vector<Disagreement>> disagreements(trees.size());
    for (int repeat = 0; repeat < scene.repeats; ++repeat) {
        for (size_t place = 0; place < trees.size(); ++place) {
            TracedTree* const tree = trees[place].get();
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
                compare(rays, expected, hits, &disagreements[place]);
            } else if (hits.closest != expected.closest || hits.is_shadowed != expected.is_shadowed) {
                throw std::runtime_error(fmt::format("{}: the trees by {} and {} give different hits", scene.name,
                                                     trees.front()->row.name, tree->row.name));
            }
        }
    }
    for (size_t place = 0; place < trees.size(); ++place) {
        judge_row(mesh, disagreements[place], &trees[place]->row, [&](size_t judged) {
            report_within_step(fmt::format("judging {} of {} rays that disagree", judged, disagreements[place].size()));
        });
        comparison.rows.push_back(trees[place]->row);
    }
    return comparison;
}

}  // namespace zoe
