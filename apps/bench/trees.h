#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "apps/bench/bench_scenes.h"
#include "apps/bench/judge.h"
#include "apps/bench/play.h"
#include "apps/bench/ray_kind.h"
#include "engine/bvh/blas.h"
#include "engine/bvh/epo.h"
#include "engine/bvh/tree_stats.h"

namespace zoe {

/// What a tree over a mesh costs, and what rays through it cost.
struct TreeRow {
    std::string name;                    ///< "binned", "Embree MEDIUM".
    std::optional<BlasBuilder> builder;  ///< None: a peer's.
    double build_ms = 0.0;
    uint64_t byte_count = 0;  ///< Of the form that is traversed.

    // What is not known of a peer's tree is 0.
    double sah = 0.0;                     ///< Of the form that is traversed: 1 a node, 1 a block of triangles.
    int depth = 0;                        ///< Levels of that form.
    TreeStats binary;                     ///< Of the tree that it was made of.
    Epo epo;                              ///< Of that one, too.
    double nodes = 0.0, triangles = 0.0;  ///< That a primary or diffuse ray tests.

    std::array<double, kRayKindCount> trace_ms{};  ///< By kind, in the way of handing rays over that takes least.
    double primary_single_ms = 0.0;                ///< Primary rays, a call each.
    uint64_t disagreements = 0;  ///< Rays that find another hit than in our trees, as `is_disagreement` has it.
    std::array<uint64_t, kVerdictCount> verdicts{};  ///< Of these, by who is right.
    uint64_t not_judged = 0;                         ///< The rest of them.

    bool is_peer() const { return !builder; }
};

struct TreeComparison {
    std::string scene;
    uint64_t triangle_count = 0;
    std::array<uint64_t, kRayKindCount> ray_count{};
    std::vector<TreeRow> rows;

    double mrays_per_s(const TreeRow& row, RayKind kind) const;
    /// ms for building the tree and tracing a million primary and a million diffuse rays: what a mesh costs that is rebuilt
    /// every frame.
    double frame_ms(const TreeRow& row) const;
};

/// Builds a tree by each method over all triangles of a scene's first frame, as one mesh in the world, and traces the
/// frame's rays through all of them in turn. Least times over the repeats, the later builds in the memory of the first; what
/// takes long is built once.
/// Throws     SceneError; std::runtime_error where our trees, or batches and single rays, give different hits; Interrupted.
TreeComparison compare_trees(const BenchScene& scene, const PlayConfig& config, const Report& report);

}  // namespace zoe
