#include "apps/common/stats_json.h"

#include <algorithm>
#include <cmath>

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
            {"rays", stats.rays},
            {"hits", stats.hits},
            {"kinds",
             {{"primary", kind_json(stats.primary)},
              {"diffuse", kind_json(stats.diffuse)},
              {"shadow", kind_json(stats.shadow)}}}};
}

Json frame_json(const FrameRecord& record) {
    Json frame = {{"frame", record.frame}};
    frame.update(numbers_json(record.stats));
    frame["hits_hash"] = fmt::format("{:016x}", record.stats.hits_hash);
    return frame;
}

/// Field by field, over frames of the same shape.
Json percentile_json(const std::vector<Json>& frames, double share) {
    Json result = Json::object();
    if (frames.empty()) return result;
    for (const auto& [key, first] : frames.front().items()) {
        if (first.is_object()) {
            std::vector<Json> inner;
            for (const Json& frame : frames) inner.push_back(frame[key]);
            result[key] = percentile_json(inner, share);  // two levels, of this file's own making
        } else {
            std::vector<double> values;
            for (const Json& frame : frames) values.push_back(frame[key].get<double>());
            result[key] = percentile(std::move(values), share);
        }
    }
    return result;
}

}  // namespace

RunStats describe_run(const std::string& name, const Scene& scene, const Tlas& tlas) {
    RunStats run{.scene = name, .threads = thread_count(), .triangle_count = 0, .node_count = {}, .frames = {}};
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

std::string stats_json(const RunStats& run) {
    Json nodes = Json::object();
    for (int i = 0; i < kMotionCount; ++i) nodes[name(static_cast<Motion>(i))] = run.node_count[i];
    std::vector<Json> numbers;
    Json frames = Json::array();
    for (const FrameRecord& record : run.frames) {
        numbers.push_back(numbers_json(record.stats));
        frames.push_back(frame_json(record));
    }
    const Json json = {{"scene", run.scene},
                       {"threads", run.threads},
                       {"simd", "scalar"},
                       {"triangles", run.triangle_count},
                       {"nodes", nodes},
                       {"frames", frames},
                       {"median", percentile_json(numbers, 0.5)},
                       {"p99", percentile_json(numbers, 0.99)}};
    // A scene's name may be any bytes that a file's name may be.
    return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace zoe
