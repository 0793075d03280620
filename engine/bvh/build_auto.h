#pragma once

#include "engine/bvh/blas.h"

namespace zoe {

struct AutoConfig {
    double rays = 1e12;      ///< That will go through the trees before they are built anew. Chart `pays-off`.
    double budget_s = 30.0;  ///< What building them may take.
};

/// Seconds that a builder takes for so many triangles, on two cores: a prediction, from their number alone; infinite for
/// those that are never chosen.
double predicted_build_s(BlasBuilder builder, uint64_t triangle_count);

/// Chooses what trees are built with: the builder whose build and rays together are predicted to take least, of those that
/// the budget allows. It goes by counts and not by a clock, so that the same scene has the same trees everywhere.
/// triangle_count   of all trees together.
/// Returns    kBinned where there are few rays or little time, else kReinserted.
/// Source     Its own: the crossover of build and trace times that the benchmark's `--trees` measures.
BlasBuilder choose_builder(uint64_t triangle_count, const AutoConfig& config = {});

}  // namespace zoe
