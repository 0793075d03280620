#pragma once

#include <functional>
#include <string>
#include <vector>

#include "apps/bench/world_mesh.h"
#include "engine/bvh/blas.h"

namespace zoe::chart {

/// A setting of a builder at one of its values, all others as the engine has them.
struct Knob {
    std::string panel, series;
    double value;
    bool is_default;
    /// Leaves the binary tree in scratch->bvh.
    std::function<void(const WorldMesh& mesh, Blas* blas, BlasScratch* scratch)> build;
};

/// Every value that is tried of every setting which has no chart of its own; of each setting one is the default.
std::vector<Knob> builder_knobs();

}  // namespace zoe::chart
