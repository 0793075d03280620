#pragma once

#include <array>
#include <string>
#include <vector>

#include "engine/zoetrope.h"

namespace zoe {

struct FrameRecord {
    int frame = 0;
    FrameStats stats;
};

/// What a run over a scene measured.
struct RunStats {
    std::string scene;
    int threads = 0;
    uint64_t triangle_count = 0;                    ///< Shown, each node's own.
    std::array<uint32_t, kMotionCount> node_count;  ///< Nodes that show a mesh, by motion class.
    std::vector<FrameRecord> frames;
};

/// Fills in everything but the frames.
/// Requires   an `advance` of the scene before.
RunStats describe_run(const std::string& name, const Scene& scene, const Tlas& tlas);

/// The JSON text of `--stats`: the scene, the frames, and the median and 99th percentile of every number over the frames.
std::string stats_json(const RunStats& run);

/// The value that `share` of the values do not exceed (nearest rank); between the middle two for a median of an even count.
double percentile(std::vector<double> values, double share);

/// Median over the frames of something about each; 0 for no frames.
template <typename Value>
double median(const std::vector<FrameRecord>& frames, Value&& value) {
    std::vector<double> values;
    values.reserve(frames.size());
    for (const FrameRecord& record : frames) values.push_back(value(record.stats));
    return percentile(std::move(values), 0.5);
}

}  // namespace zoe
