#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "apps/chart/chart.h"
#include "engine/bvh/traverse.h"

namespace zoe::chart {

/// What long work calls between its parts.
/// Throws     Interrupted after SIGINT or SIGTERM.
void stop_if_interrupted();

/// Calls each of the works once a round, in turn and beginning with another one each time, so that what disturbs the machine
/// disturbs all alike. A round before those that count warms up.
/// works      each returns what it measured, such as ms.
/// Returns    [works][rounds]
std::vector<std::vector<double>> measure_in_turn(std::span<const std::function<double()>> works, int rounds);

/// What a ray tests, in the mean over rays that are traced one by one.
struct Work {
    double nodes = 0.0, triangles = 0.0;
    uint64_t hits_hash = 0;  ///< Of all hits: the same whatever the tree.
};
Work work_of_rays(const TwoLevels& levels, std::span<const Ray> rays);
Work work_of_rays(const Blas& blas, std::span<const Ray> rays);

/// "3.21", "0.0131", "1,230", "15.2 million": three digits or more that count.
std::string short_number(double number);

}  // namespace zoe::chart
