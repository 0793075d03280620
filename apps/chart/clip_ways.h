#pragma once

#include <cstdint>
#include <vector>

#include "engine/bvh/choose_rebuilds.h"

namespace zoe::chart {

/// What the trees of a clip are worth, each built for one of its frames and refitted to those that follow. Work is counted
/// in tests of a node's eight boxes; the first frame's tree is there.
struct ClipTrees {
    uint32_t triangle_count = 0;
    double rays = 0.0;                               ///< That enter the tree in each frame.
    double build_work = 0.0, refit_work = 0.0;       ///< A frame.
    std::vector<std::vector<TreeReading>> readings;  ///< [built][frame - built] what the sensor sees.
    std::vector<std::vector<double>> ray_work;       ///< [built][frame - built] what a ray takes.

    size_t frame_count() const { return ray_work.size(); }
    double trace_work(size_t built, size_t frame) const { return rays * ray_work[built][frame - built]; }
};

/// All of a clip: rays, refits and rebuilds.
double always_refitted(const ClipTrees& trees);
double always_rebuilt(const ClipTrees& trees);
/// The least of all choices of frames to rebuild in.
double in_hindsight(const ClipTrees& trees);
/// As the engine chooses.
/// threshold  times the work of a rebuild must be lost before one is made: 1, as the engine has it.
double by_sensor(const ClipTrees& trees, double threshold);

}  // namespace zoe::chart
