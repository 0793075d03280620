#pragma once

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/zoetrope.h"

namespace zoe {

/// What a peer, such as Embree, did with the same frame. Times in ms.
struct PeerStats {
    double update_ms = 0, build_tlas_ms = 0, trace_ms = 0;
    uint64_t rays = 0;
    uint64_t disagreements = 0;  ///< Rays whose hit is another than the engine's.
    FrameStats::Kind primary, diffuse, shadow;

    double frame_ms() const { return update_ms + build_tlas_ms + trace_ms; }
};

struct FrameRecord {
    int frame = 0;
    FrameStats stats;
    std::optional<double> samples = std::nullopt;  ///< A pixel, in the mean, where a picture was made.
    std::optional<PeerStats> peer;
};

/// How the peer of a run was set up, and how it compares over all frames.
struct PeerRun {
    /// A way to set the peer up, and what its frames took when it was tried.
    struct Tried {
        std::string configuration;
        double frame_ms = 0.0;
    };
    std::string name, configuration;
    std::vector<Tried> tried;
    /// Disagreements by who is right. The first ones are judged, `not_judged` are left.
    uint64_t ours_right = 0, peer_right = 0, either_right = 0, neither_right = 0, not_judged = 0;
};

/// What a run over a scene measured.
struct RunStats {
    std::string scene;
    int threads = 0;
    uint64_t triangle_count = 0;                    ///< Shown, each node's own.
    std::array<uint32_t, kMotionCount> node_count;  ///< Nodes that show a mesh, by motion class.
    std::string size;                               ///< "512x512" primary rays; empty where frames are pictures of any.
    int repeats = 1;                                ///< Times are the least of so many.
    std::optional<FrameRecord> warm_up;             ///< A first frame that builds and allocates; kept apart.
    std::vector<FrameRecord> frames;
    std::optional<PeerRun> peer;
};

/// How many times faster than the peer: its time over ours, median over the frames. animate and deform are left out: the
/// peer takes what they made. NaN where neither takes 0.02 ms, which no clock tells apart, and without a peer.
struct Ratios {
    double update = 0.0;  ///< update_blas and build_tlas together.
    double primary = 0.0, diffuse = 0.0, shadow = 0.0;
    double frame = 0.0;  ///< All of these together.
};
Ratios ratios_to_peer(const std::vector<FrameRecord>& frames);

/// Fills in everything but the frames.
/// Requires   an `advance` of the scene before.
RunStats describe_run(const std::string& name, const Scene& scene, const Tlas& tlas);

/// The JSON text of `--stats`: the scene, the frames, and the median and 99th percentile of every number over the frames.
std::string stats_json(const RunStats& run);

/// The JSON text of the benchmark: such an object for each scene, in a list, and what it ran on.
/// machine    names and values.
std::string bench_json(const std::vector<RunStats>& runs, const std::vector<std::pair<std::string, std::string>>& machine);

/// The value that `share` of the values do not exceed (nearest rank); between the middle two for a median of an even count.
double percentile(std::vector<double> values, double share);

/// The same of something about each frame's stats; 0 for no frames.
template <typename Value>
double percentile(const std::vector<FrameRecord>& frames, double share, Value&& value) {
    std::vector<double> values;
    values.reserve(frames.size());
    for (const FrameRecord& record : frames) values.push_back(value(record.stats));
    return percentile(std::move(values), share);
}

template <typename Value>
double median(const std::vector<FrameRecord>& frames, Value&& value) {
    return percentile(frames, 0.5, std::forward<Value>(value));
}

}  // namespace zoe
