#include "apps/common/trace_events.h"

#include <utility>

#include <nlohmann/json.hpp>

#include "apps/common/write_file.h"

namespace zoe {

double TraceEvents::us_since_origin(Clock::time_point time) const {
    return std::chrono::duration<double, std::micro>(time - origin_).count();
}

void TraceEvents::add(const std::string& name, Clock::time_point begin, double duration_ms, int frame) {
    events_.push_back({name, us_since_origin(begin), 1000.0 * duration_ms, frame});
}

void TraceEvents::add_stages(Clock::time_point begin, const FrameStats& stats, int frame) {
    double at_us = us_since_origin(begin);
    counts_.push_back({at_us, stats.kept, stats.refitted, stats.rebuilt});
    const std::pair<const char*, double> stages[] = {{"animate", stats.animate_ms},
                                                     {"deform", stats.deform_ms},
                                                     {"update_blas", stats.update_blas_ms},
                                                     {"build_tlas", stats.build_tlas_ms}};
    for (const auto& [name, ms] : stages) {
        events_.push_back({name, at_us, 1000.0 * ms, frame});
        at_us += 1000.0 * ms;
    }
}

void TraceEvents::write(const std::filesystem::path& file) const {
    using Json = nlohmann::ordered_json;
    Json list = Json::array();
    for (const Event& event : events_) {
        list.push_back({{"name", event.name},
                        {"ph", "X"},
                        {"ts", event.begin_us},
                        {"dur", event.duration_us},
                        {"pid", 1},
                        {"tid", 1},
                        {"args", {{"frame", event.frame}}}});
    }
    for (const Counts& counts : counts_) {
        list.push_back({{"name", "nodes"},
                        {"ph", "C"},
                        {"ts", counts.at_us},
                        {"pid", 1},
                        {"args", {{"kept", counts.kept}, {"refitted", counts.refitted}, {"rebuilt", counts.rebuilt}}}});
    }
    write_file(file, Json{{"displayTimeUnit", "ms"}, {"traceEvents", list}}.dump(1) + "\n");
}

}  // namespace zoe
