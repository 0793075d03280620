#include <atomic>
#include <chrono>
#include <string>
#include <vector>

#include "engine/bvh/cache.h"
#include "engine/bvh/tree_file.h"
#include "engine/frame/frame.h"
#include "engine/frame/frame_state.h"
#include "engine/math/parallel.h"

namespace zoe {

namespace {

struct Method {
    bool is_refitted;  // Moved vertices refit the tree; else they rebuild it.
    bool is_cached;    // The tree is built once, and kept on disk where the scene has a cache.
    BlasBuilder builder;
};

// By motion class: what moving vertices do to a BLAS, and what it is built with.
Method method_for(Motion motion, const FrameState& state) {
    switch (motion) {
        case Motion::kStatic:
        case Motion::kRigid:  // The rays are transformed.
            return {.is_refitted = false, .is_cached = true, .builder = state.still_builder};
        case Motion::kDeforming:
            return {.is_refitted = true, .is_cached = false, .builder = BlasBuilder::kSweep};
        case Motion::kArbitrary:
            break;
    }
    return {.is_refitted = false, .is_cached = false, .builder = BlasBuilder::kBinned};
}

enum class Action { kKeep, kRefit, kRebuild };

// The cheapest that leaves the tree valid for this frame's vertices.
Action action_for(const Shape& shape, const FrameState& state) {
    if (!shape.has_blas || shape.is_topology_changed) return Action::kRebuild;
    if (!shape.is_changed) return Action::kKeep;
    return method_for(shape.motion.motion, state).is_refitted ? Action::kRefit : Action::kRebuild;
}

struct CacheCounts {
    std::atomic<uint32_t> loaded{0}, stored{0};
};

// Builds a tree, or reads it where that is faster.
// scratch    null where the tree is not rebuilt every frame.
void make(std::span<const glm::vec3> positions, std::span<const glm::uvec3> corners, const Method& method, TreeCache* cache,
          Blas* blas, BlasScratch* scratch, CacheCounts* counts) {
    using Clock = std::chrono::steady_clock;
    const bool is_cached = cache && method.is_cached && corners.size() >= kFewestCachedTriangles;
    const Hash128 key = is_cached ? tree_key(positions, corners, method.builder) : Hash128{};
    if (is_cached && cache->load(key, positions, corners, blas)) {
        ++counts->loaded;
        return;
    }
    const Clock::time_point start = Clock::now();
    if (scratch) {
        build_blas(positions, corners, method.builder, blas, scratch);
    } else {
        build_blas(positions, corners, method.builder, blas);
    }
    const double build_ms = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
    if (is_cached && is_worth_keeping(build_ms, *blas) && cache->store(key, *blas)) ++counts->stored;
}

void update(const Scene& scene, const FrameState& state, Shape* shape, CacheCounts* counts) {
    const Mesh& mesh = scene[shape->mesh];
    if (action_for(*shape, state) == Action::kRefit) {
        refit_blas(shape->positions, mesh.corners, shape->blas);
    } else {
        const bool is_rebuilt_often = shape->motion.motion == Motion::kArbitrary;
        make(shape->positions, mesh.corners, method_for(shape->motion.motion, state), scene.tree_cache.get(), shape->blas,
             is_rebuilt_often ? &shape->blas_scratch : nullptr, counts);
    }
    shape->has_blas = true;
}

void warn_of_cache(Scene& scene) {
    for (const auto& [text, count] : scene.tree_cache->take_warnings()) {
        for (uint64_t k = 0; k < count; ++k) scene.warn(text);
    }
}

// Once a tree, and again where the number has doubled since: what moves each frame says it a few times at most.
void warn_of_not_finite(Scene& scene, std::span<Shape* const> work) {
    for (Shape* shape : work) {
        const uint32_t count = shape->blas->not_finite_count;
        if (count == 0 || count / 2 < shape->warned_not_finite_count) continue;
        shape->warned_not_finite_count = count;
        const std::string text = "node " + std::to_string(index(shape->node)) + " '" + scene[shape->node].name +
                                 "': " + std::to_string(count) + (count == 1 ? " triangle" : " triangles") +
                                 " with NaN or infinite corners: never hit";
        if (!scene.warnings().contains(text)) scene.warn(text);  // A scene that was touched is built anew.
    }
}

}  // namespace

void update_blas(Scene& scene, FrameState* state, FrameStats* stats) {
    // A shared BLAS is built by the first node that shows it; the work list holds every tree once.
    std::vector<Shape*>& work = state->blas_work;
    work.clear();
    for (Shape& shape : state->shapes) {
        const Action action = action_for(shape, *state);
        (action == Action::kKeep ? stats->kept : action == Action::kRefit ? stats->refitted : stats->rebuilt) += 1;
        if (action == Action::kKeep) continue;
        const bool is_shared = shape.blas != &shape.own_blas;
        if (is_shared && state->is_shared_blas_built[index(shape.mesh)]) {
            shape.has_blas = true;
            continue;
        }
        if (is_shared) state->is_shared_blas_built[index(shape.mesh)] = 1;
        work.push_back(&shape);
    }
    CacheCounts counts;
    parallel_for(0, work.size(), 1, [&](size_t begin, size_t end) {
        for (size_t k = begin; k < end; ++k) update(scene, *state, work[k], &counts);
    });
    stats->loaded += counts.loaded;
    stats->stored += counts.stored;
    if (scene.tree_cache) warn_of_cache(scene);
    warn_of_not_finite(scene, work);
}

}  // namespace zoe
