#include <algorithm>
#include <atomic>
#include <chrono>
#include <string>
#include <vector>

#include "engine/bvh/cache.h"
#include "engine/bvh/reserve_builds.h"
#include "engine/bvh/tree_file.h"
#include "engine/frame/clip_trees.h"
#include "engine/frame/frame.h"
#include "engine/frame/frame_state.h"
#include "engine/math/parallel.h"

namespace zoe {

TreeMethod method_for(Motion motion, const FrameState& state) {
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

namespace {

// The cheapest that leaves the tree valid for this frame's vertices.
TreeAction action_for(const Shape& shape, const FrameState& state) {
    if (!shape.has_blas || shape.is_topology_changed) return TreeAction::kRebuilt;
    if (!shape.is_changed) return TreeAction::kKept;
    return method_for(shape.motion.motion, state).is_refitted ? TreeAction::kRefitted : TreeAction::kRebuilt;
}

struct CacheCounts {
    std::atomic<uint32_t> loaded{0}, stored{0};
};

// Builds a tree, or reads it where that is faster.
// scratch    null where the tree is not rebuilt every frame.
void make(std::span<const glm::vec3> positions, std::span<const glm::uvec3> corners, const TreeMethod& method,
          TreeCache* cache, Blas* blas, BlasScratch* scratch, CacheCounts* counts) {
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

// Puts a tree that was built over a clip's poses into this frame's. What is looked for later is a cost that the clip does
// not explain: one above that of its worst pose.
void pose(const ClipTree& of_clip, Shape* shape) {
    std::vector<Aabb> boxes;
    add_boxes(*shape, &boxes);
    Bvh tree = of_clip.tree;
    const double cost = fit(boxes, &tree);
    BlasScratch scratch;
    make_blas(of_clip.tree, shape->positions, shape->shown->corners, shape->blas, &scratch);
    refit_blas(shape->positions, shape->shown->corners, shape->blas);
    TreeReading reading = read_tree(*shape->blas);
    if (cost > 0.0) reading.cost *= std::max(1.0, of_clip.worst_cost / cost);
    note_build(reading, shape->blas->triangle_count, &shape->own->watch);
}

void watch_anew(Shape* shape) {
    const TreeReading reading = read_tree(*shape->blas);
    note_build(reading, shape->blas->triangle_count, &shape->own->watch);
}

void update(const Scene& scene, const FrameState& state, Shape* shape, CacheCounts* counts) {
    const Mesh& mesh = *shape->shown;
    if (action_for(*shape, state) == TreeAction::kRefitted) {
        const bool is_other = refit_blas(shape->positions, mesh.corners, shape->blas).changed > 0;
        if (is_other) note_refit(read_tree(*shape->blas), &shape->own->watch);
    } else {
        const TreeMethod method = method_for(shape->motion.motion, state);
        const bool is_rebuilt_often = shape->motion.motion == Motion::kArbitrary;
        const ClipTree* of_clip = state.clip_trees.empty() ? nullptr : &state.clip_trees[index(shape->mesh)];
        if (method.is_refitted && of_clip && of_clip->tree.primitives.size() == mesh.corners.size()) {
            pose(*of_clip, shape);
        } else {
            make(shape->positions, mesh.corners, method, scene.tree_cache.get(), shape->blas,
                 is_rebuilt_often ? &shape->own->blas_scratch : nullptr, counts);
            if (method.is_refitted) watch_anew(shape);
        }
        if (method.is_refitted) reserve_builds(shape->blas);
    }
    shape->has_blas = true;
}

// How many of a frame's rays enter a shape: of random lines through a convex body, the share that meets one inside of it is
// that of their surfaces. As it stood in the last frame; none where it was not shown.
double rays_into(const Shape& shape, const FrameState& state, double frame_rays) {
    const Tlas& tlas = state.tlas;
    if (tlas.instance_of_node.empty()) return 0.0;
    const uint32_t at = tlas.instance_of_node[index(shape.node)];
    if (at == kNoInstance) return 0.0;
    const double all = tlas.bounds_world.half_area(), own = tlas.instances[at].bounds_world.half_area();
    return frame_rays * (all > own ? own / all : 1.0);
}

// Takes the memory of rebuilds where trees are new that may be rebuilt: then their frames take none.
void reserve_rebuilds(BlasWork* work) {
    const auto triangle_count = [](const Shape* shape) { return shape->blas->triangle_count; };
    const Shape* largest = *std::ranges::max_element(work->refitted, {}, triangle_count);
    work->watches.reserve(work->refitted.size());
    work->worn.reserve(work->refitted.size());
    const size_t lane_count = std::min(static_cast<size_t>(thread_count()), work->refitted.size());
    if (largest->blas->triangle_count <= work->reserved_triangle_count && lane_count <= work->scratches.size()) return;
    work->reserved_triangle_count = std::max(largest->blas->triangle_count, work->reserved_triangle_count);
    work->scratches = std::vector<BlasScratch>(lane_count);
    parallel_for(0, work->scratches.size(), 1, [&](size_t k, size_t) {
        reserve_builds(largest->positions, largest->shown->corners, &work->scratches[k]);
    });
}

// Rebuilds trees that have worn out.
void rebuild_worn(const Scene& scene, FrameState* state, FrameStats* stats) {
    BlasWork& work = state->blas_work;
    work.watches.clear();
    const double frame_rays = state->traced_rays.is_told ? state->traced_rays.mean : scene.rebuild.frame_rays;
    for (Shape* shape : work.refitted) {
        const double build_work = scene.rebuild.triangle_work * shape->blas->triangle_count;
        add_loss(rays_into(*shape, *state, frame_rays), build_work, &shape->own->watch);
        work.watches.push_back(&shape->own->watch);
    }
    choose_rebuilds(scene.rebuild, work.watches, &work.worn);
    const size_t lane_count = work.scratches.size();
    parallel_for(0, lane_count, 1, [&](size_t lane, size_t) {
        for (size_t k = lane; k < work.worn.size(); k += lane_count) {
            Shape* shape = work.refitted[work.worn[k]];
            build_blas(shape->positions, shape->shown->corners, BlasBuilder::kBinned, shape->blas, &work.scratches[lane]);
            watch_anew(shape);
        }
    });
    for (const uint32_t k : work.worn) {
        --(work.refitted[k]->is_changed ? stats->refitted : stats->kept);
        ++stats->rebuilt;
        work.refitted[k]->action = TreeAction::kRebuilt;
    }
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
    std::vector<Shape*>& work = state->blas_work.changed;
    std::vector<Shape*>& refitted = state->blas_work.refitted;
    work.clear();
    refitted.clear();
    bool is_any_new = false;
    for (Shape& shape : state->shapes) {
        const TreeAction action = shape.action = action_for(shape, *state);
        if (method_for(shape.motion.motion, *state).is_refitted) {
            refitted.push_back(&shape);
            is_any_new |= action == TreeAction::kRebuilt;
        }
        (action == TreeAction::kKept       ? stats->kept
         : action == TreeAction::kRefitted ? stats->refitted
                                           : stats->rebuilt) += 1;
        if (action == TreeAction::kKept) continue;
        const bool is_shared = shape.is_shared();
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
    if (is_any_new) reserve_rebuilds(&state->blas_work);
    std::vector<ClipTree>().swap(state->clip_trees);  // All have theirs now.
    rebuild_worn(scene, state, stats);
    warn_of_not_finite(scene, work);
}

}  // namespace zoe
