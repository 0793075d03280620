#include "apps/bench/traced_tree.h"

#include <algorithm>
#include <stdexcept>
#include <string_view>

#include <fmt/format.h>

#include "apps/bench/stopwatch.h"
#include "apps/bench/timed_parallel.h"
#include "apps/common/interrupt.h"
#include "apps/common/lone_blas.h"
#include "engine/math/parallel.h"

namespace zoe {
namespace {

/// A method that took longer than this is not repeated.
constexpr double kLongBuild_ms = 1000.0;
/// A tree whose end-point overlap takes more walks than this through nodes has it estimated: of copies of one triangle,
/// each is in every node.
constexpr uint64_t kMostEpoVisits = 500'000'000;
constexpr std::string_view kSingle = "single";

void stop_if_interrupted() {
    if (is_interrupted()) throw Interrupted("interrupted");
}

const char* name(EmbreeRays form) {
    constexpr std::array names = {kSingle.data(), "packets", "coherent packets"};
    return names[static_cast<size_t>(form)];
}

class OurTree final : public TracedTree {
public:
    OurTree(const char* name, BlasBuilder builder, const WorldMesh& mesh, int repeats) {
        row.name = name;
        row.builder = builder;
        BlasScratch scratch;
        for (int repeat = 0; repeat < repeats; ++repeat) {
            Stopwatch watch;
            build_blas(mesh.positions(), mesh.corners(), builder, &blas_, &scratch);
            const double ms = watch.restart_ms();
            row.build_ms = repeat == 0 ? ms : std::min(row.build_ms, ms);
            stop_if_interrupted();
            if (ms > kLongBuild_ms) break;
        }
        row.byte_count = blas_.byte_count();
        row.sah = sah_cost(blas_.tree, 1.0f);
        row.depth = static_cast<int>(blas_.tree.level_ends.size());
        describe_binary(scratch.bvh, mesh);

        frame_.emplace(blas_);
    }

    /// One ray a call: packets share their work.
    TraverseCounts count(std::span<const Ray> rays) const {
        TraverseCounts counts;
        RawHit hit;
        for (const Ray& ray : rays) {
            stop_if_interrupted();
            closest_hits(scene(), {&ray, 1}, &hit, &counts);
        }
        return counts;
    }

    void trace_closest(std::span<const Ray> rays, RayKind kind, std::span<Hit> hits) override {
        raw_.resize(rays.size());
        keep(kind, "batch", rays.size(), timed_parallel(rays.size(), kRaysATask, [&](size_t begin, size_t end) {
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
        keep(kind, kSingle.data(), rays.size(), timed_parallel(rays.size(), kRaysATask, [&](size_t begin, size_t end) {
                 for (size_t k = begin; k < end; ++k) closest_hits(scene(), rays.subspan(k, 1), &singles_[k], nullptr);
             }));
        for (size_t k = 0; k < rays.size(); ++k) {
            if (std::memcmp(&singles_[k], &raw_[k], sizeof(RawHit)) != 0)
                throw std::runtime_error(fmt::format("{}: ray {} alone gives another hit than in a batch", row.name, k));
        }
    }
    void trace_any(std::span<const Ray> rays, std::span<uint8_t> is_hit) override {
        keep(RayKind::kShadow, "batch", rays.size(), timed_parallel(rays.size(), kRaysATask, [&](size_t begin, size_t end) {
                 any_hits(scene(), rays.subspan(begin, end - begin), is_hit.data() + begin, nullptr);
             }));
    }

private:
    void describe_binary(const Bvh& bvh, const WorldMesh& mesh) {
        row.binary = tree_stats(bvh);
        std::vector<Triangle> triangles;
        triangles.reserve(bvh.primitives.size());
        for (const uint32_t primitive : bvh.primitives) triangles.push_back(mesh.triangle(primitive));
        row.epo = epo(bvh, triangles, {.max_visits = kMostEpoVisits, .cancel = &is_interrupted()});
        stop_if_interrupted();
    }
    TwoLevels scene() const { return frame_->levels(); }

    Blas blas_;
    std::optional<LoneBlas> frame_;
    std::vector<RawHit> raw_, singles_;
};

class EmbreeTree final : public TracedTree {
public:
    EmbreeTree(const char* name, PeerTree::Quality quality, bool is_robust, const WorldMesh& mesh, int repeats)
        : tree_(quality, is_robust, mesh.positions(), mesh.corners(), thread_count()) {
        row.name = name;
        row.build_ms = tree_.build_ms();
        for (int repeat = 1; repeat < repeats && tree_.build_ms() <= kLongBuild_ms; ++repeat) {
            row.build_ms = std::min(row.build_ms, tree_.rebuild());
        }
        row.byte_count = tree_.byte_count();
    }

    void trace_closest(std::span<const Ray> rays, RayKind kind, std::span<Hit> hits) override {
        for (const EmbreeRays form : forms_of(kind)) {
            const double ms = tree_.closest_hits(rays, form, hits);
            keep(kind, name(form), rays.size(), ms);
        }
    }
    void trace_any(std::span<const Ray> rays, std::span<uint8_t> is_hit) override {
        for (const EmbreeRays form : forms_of(RayKind::kShadow)) {
            const double ms = tree_.any_hits(rays, form, is_hit);
            keep(RayKind::kShadow, name(form), rays.size(), ms);
        }
    }

private:
    PeerTree tree_;
};

void take_least(double ms, double* least) {
    *least = *least == 0.0 ? ms : std::min(*least, ms);
}

}  // namespace

void TracedTree::keep(RayKind kind, const char* way, size_t ray_count, double ms) {
    write_instruction_count(fmt::format("{} rays, {}, {}, {}", ray_count, row.name, zoe::name(kind), way));
    const bool is_single = kind == RayKind::kPrimary && way == kSingle;
    if (is_single) take_least(ms, &row.primary_single_ms);
    take_least(ms, &row.trace_ms[static_cast<size_t>(kind)]);
}

std::unique_ptr<TracedTree> make_our_tree(const char* name, BlasBuilder builder, const WorldMesh& mesh, int repeats,
                                          std::span<const Ray> primary, std::span<const Ray> diffuse) {
    auto tree = std::make_unique<OurTree>(name, builder, mesh, repeats);
    const TraverseCounts a = tree->count(primary), b = tree->count(diffuse);
    const double count = std::max<double>(1.0, static_cast<double>(primary.size() + diffuse.size()));
    tree->row.nodes = (double(a.nodes) + double(b.nodes)) / count;
    tree->row.triangles = (double(a.triangles) + double(b.triangles)) / count;
    return tree;
}

std::unique_ptr<TracedTree> make_peer_tree(const char* name, PeerTree::Quality quality, bool is_robust,
                                           const WorldMesh& mesh, int repeats) {
    return std::make_unique<EmbreeTree>(name, quality, is_robust, mesh, repeats);
}

}  // namespace zoe
