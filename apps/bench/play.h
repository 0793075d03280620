#pragma once

#include <functional>
#include <string>
#include <vector>

#include "apps/bench/bench_scenes.h"
#include "apps/bench/judge.h"
#include "apps/bench/peer_options.h"
#include "apps/common/stats_json.h"

namespace zoe {

struct PlayConfig {
    bool is_exact = false;  ///< The top level is clustered exactly.
    bool has_peer = false;
    PeerOptions peer;
};

struct Played {
    RunStats run;
    std::vector<Disagreement> disagreements;  ///< The first ones, judged.
    std::vector<Verdict> verdicts;            ///< [disagreements]
};

/// Called with the share that is done and what is being done.
using Report = std::function<void(double share, const std::string& detail)>;

/// Plays a scene and times every stage of every frame: frame 0 warms up, 1 to frame_count are measured. Every repeat starts
/// afresh and does the same work; what counts is each stage's least time. The peer, where there is one, gets the same
/// vertices, matrices and rays, next to ours, in turns of who is first; before that its configurations are tried on a few
/// frames of the clip, and the fastest one stays.
/// Throws     SceneError; std::runtime_error where hits differ between repeats; Interrupted.
Played play(const BenchScene& scene, const PlayConfig& config, const Report& report);

}  // namespace zoe
