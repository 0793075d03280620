#pragma once

#include <functional>

#include <string>
#include <vector>

#include "apps/bench/peer_tree.h"
#include "apps/bench/world_mesh.h"
#include "apps/chart/measure.h"
#include "apps/chart/sweep.h"
#include "engine/bvh/blas.h"
#include "engine/scene/scene.h"

namespace zoe::chart {

/// A way to build a tree over a mesh.
struct Builder {
    std::string series;
    /// Leaves the binary tree in scratch->bvh.
    std::function<void(const WorldMesh& mesh, Blas* blas, BlasScratch* scratch)> build;
};

Builder builder(BlasBuilder kind);
std::vector<Builder> all_builders();
/// As the engine's binned builder, but for the number of bins.
Builder binned(int bin_count);
const char* series_of(BlasBuilder kind);

/// What the engine builds the trees of a motion class with, unless told otherwise.
BlasBuilder default_builder(Motion motion, uint64_t triangle_count);

/// What a tree cost, and what it is worth.
struct MeasuredTree {
    std::string series;
    Spread build_ms, ray_ns;      ///< A diffuse ray, on all threads.
    double sah = 0.0, epo = 0.0;  ///< 0 of a peer's tree; so is what follows.
    Work work;                    ///< Of a diffuse ray.

    bool is_peer() const { return sah == 0.0; }
};

/// A scene of each motion class whose trees differ in what they cost and are worth.
struct MeshSubject {
    std::string scene;
    Motion motion;
    int side;  ///< Primary rays each way.
};
std::vector<MeshSubject> mesh_subjects(const Settings& settings);

/// A scene's first frame as one mesh in the world, and its diffuse rays.
struct MeshSample {
    WorldMesh mesh;
    std::vector<Ray> rays;
};
MeshSample sample_mesh(const MeshSubject& subject);

/// Builds by each of our ways, and by Embree's where it is asked for, and traces the rays, all in turn.
/// Throws     std::runtime_error where our trees give different hits.
std::vector<MeasuredTree> measure_trees(const MeshSample& sample, const std::vector<Builder>& builders,
                                        const Settings& settings);

}  // namespace zoe::chart
