#include "apps/common/stats_json.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace zoe {
namespace {

using Json = nlohmann::ordered_json;

Json kind_json(const FrameStats::Kind& kind) {
    return {{"rays", kind.rays}, {"ms", kind.ms}};
}

/// Everything about a frame that has a median.
Json numbers_json(const FrameStats& stats) {
    return {{"animate_ms", stats.animate_ms},
            {"deform_ms", stats.deform_ms},
            {"update_blas_ms", stats.update_blas_ms},
            {"build_tlas_ms", stats.build_tlas_ms},
            {"trace_ms", stats.trace_ms},
            {"frame_ms", stats.frame_ms()},
            {"kept", stats.kept},
            {"refitted", stats.refitted},
            {"rebuilt", stats.rebuilt},
            {"loaded", stats.loaded},
            {"stored", stats.stored},
            {"rays", stats.rays},
            {"hits", stats.hits},
            {"kinds",
             {{"primary", kind_json(stats.primary)},
              {"diffuse", kind_json(stats.diffuse)},
              {"shadow", kind_json(stats.shadow)}}}};
}

Json numbers_json(const PeerStats& peer) {
    return {
        {"update_ms", peer.update_ms},
        {"build_tlas_ms", peer.build_tlas_ms},
        {"trace_ms", peer.trace_ms},
        {"frame_ms", peer.frame_ms()},
        {"rays", peer.rays},
        {"disagreements", peer.disagreements},
        {"kinds",
         {{"primary", kind_json(peer.primary)}, {"diffuse", kind_json(peer.diffuse)}, {"shadow", kind_json(peer.shadow)}}}};
}

Json numbers_json(const FrameRecord& record) {
    Json json = numbers_json(record.stats);
    if (record.samples) json["samples"] = *record.samples;
    if (record.peer) json["peer"] = numbers_json(*record.peer);
    return json;
}

Json frame_json(const FrameRecord& record) {
    Json frame = {{"frame", record.frame}};
    frame.update(numbers_json(record));
    frame["hits_hash"] = fmt::format("{:016x}", record.stats.hits_hash);
    return frame;
}

// JSON has no NaN.
Json number_or_null(double value) {
    return std::isnan(value) ? Json(nullptr) : Json(value);
}

Json ratios_json(const Ratios& ratios) {
    return {{"update", number_or_null(ratios.update)},
            {"primary", number_or_null(ratios.primary)},
            {"diffuse", number_or_null(ratios.diffuse)},
            {"shadow", number_or_null(ratios.shadow)},
            {"frame", number_or_null(ratios.frame)}};
}

Json peer_json(const PeerRun& peer, const std::vector<FrameRecord>& frames) {
    Json tried = Json::array();
    for (const PeerRun::Tried& t : peer.tried) {
        tried.push_back({{"configuration", t.configuration}, {"frame_ms", t.frame_ms}});
    }
    return {{"name", peer.name},
            {"configuration", peer.configuration},
            {"tried", tried},
            {"ratios", ratios_json(ratios_to_peer(frames))},
            {"disagreements",
             {{"ours_right", peer.ours_right},
              {"peer_right", peer.peer_right},
              {"either_right", peer.either_right},
              {"neither_right", peer.neither_right},
              {"not_judged", peer.not_judged}}}};
}

/// Field by field, over frames of the same shape.
Json percentile_json(const std::vector<Json>& frames, double share) {
    Json result = Json::object();
    if (frames.empty()) return result;
    for (const auto& [key, first] : frames.front().items()) {
        if (first.is_object()) {
            std::vector<Json> inner;
            for (const Json& frame : frames) inner.push_back(frame[key]);
            result[key] = percentile_json(inner, share);  // three levels, of this file's own making
        } else {
            std::vector<double> values;
            for (const Json& frame : frames) values.push_back(frame[key].get<double>());
            result[key] = percentile(std::move(values), share);
        }
    }
    return result;
}

Json run_json(const RunStats& run) {
    Json nodes = Json::object();
    for (int i = 0; i < kMotionCount; ++i) nodes[name(static_cast<Motion>(i))] = run.node_count[i];
    std::vector<Json> numbers;
    Json frames = Json::array();
    for (const FrameRecord& record : run.frames) {
        numbers.push_back(numbers_json(record));
        frames.push_back(frame_json(record));
    }
    Json json = {{"scene", run.scene},
                 {"threads", run.threads},
                 {"simd", simd_target()},
                 {"triangles", run.triangle_count},
                 {"nodes", nodes}};
    if (!run.size.empty()) {
        json["size"] = run.size;
        json["repeats"] = run.repeats;
    }
    if (run.warm_up) json["warm_up"] = frame_json(*run.warm_up);
    json["frames"] = frames;
    json["median"] = percentile_json(numbers, 0.5);
    json["p99"] = percentile_json(numbers, 0.99);
    if (run.peer) json["peer"] = peer_json(*run.peer, run.frames);
    return json;
}

// A scene's name may be any bytes that a file's name may be.
std::string text(const Json& json) {
    return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace

RunStats describe_run(const std::string& name, const Scene& scene, const Tlas& tlas) {
    RunStats run{.scene = name,
                 .threads = thread_count(),
                 .triangle_count = 0,
                 .node_count = {},
                 .warm_up = {},
                 .frames = {},
                 .peer = {}};
    for (const Instance& instance : tlas.instances) run.triangle_count += instance.mesh->corners.size();
    for (uint32_t i = 0; i < scene.nodes.size(); ++i) {
        const Node& node = scene.nodes[i];
        const bool shows_mesh = node.is_shown && (node.mesh != kNone<MeshId> || node.sequence);
        if (shows_mesh) ++run.node_count[static_cast<size_t>(motion(scene, NodeId{i}))];
    }
    return run;
}

double percentile(std::vector<double> values, double share) {
    if (values.empty()) return 0.0;
    std::sort(values.begin(), values.end());
    const size_t count = values.size();
    if (share == 0.5 && count % 2 == 0) return 0.5 * (values[count / 2 - 1] + values[count / 2]);
    const double rank = std::ceil(share * static_cast<double>(count));
    return values[static_cast<size_t>(std::clamp(rank, 1.0, static_cast<double>(count))) - 1];
}

Ratios ratios_to_peer(const std::vector<FrameRecord>& frames) {
    constexpr double kTooShort_ms = 0.02;
    const auto median_ratio = [&](auto&& ours_ms, auto&& peers_ms) {
        std::vector<double> ratios;
        for (const FrameRecord& frame : frames) {
            if (!frame.peer) continue;
            const double ours = ours_ms(frame.stats), peers = peers_ms(*frame.peer);
            if (std::max(ours, peers) >= kTooShort_ms && ours > 0.0) ratios.push_back(peers / ours);
        }
        return ratios.empty() ? std::numeric_limits<double>::quiet_NaN() : percentile(std::move(ratios), 0.5);
    };
    const auto update_ms = [](const FrameStats& s) { return s.update_blas_ms + s.build_tlas_ms; };
    const auto peer_update_ms = [](const PeerStats& p) { return p.update_ms + p.build_tlas_ms; };
    const auto kind_ratio = [&](FrameStats::Kind FrameStats::*ours, FrameStats::Kind PeerStats::*peers) {
        return median_ratio([&](const FrameStats& s) { return (s.*ours).ms; },
                            [&](const PeerStats& p) { return (p.*peers).ms; });
    };
    return {.update = median_ratio(update_ms, peer_update_ms),
            .primary = kind_ratio(&FrameStats::primary, &PeerStats::primary),
            .diffuse = kind_ratio(&FrameStats::diffuse, &PeerStats::diffuse),
            .shadow = kind_ratio(&FrameStats::shadow, &PeerStats::shadow),
            .frame = median_ratio([&](const FrameStats& s) { return update_ms(s) + s.trace_ms; },
                                  [](const PeerStats& p) { return p.frame_ms(); })};
}

std::string stats_json(const RunStats& run) {
    return text(run_json(run));
}

std::string bench_json(const std::vector<RunStats>& runs, const std::vector<std::pair<std::string, std::string>>& machine) {
    Json about = Json::object(), scenes = Json::array();
    for (const auto& [key, value] : machine) about[key] = value;
    for (const RunStats& run : runs) scenes.push_back(run_json(run));
    return text({{"machine", about}, {"scenes", scenes}});
}

}  // namespace zoe
