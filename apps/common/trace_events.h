#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

#include "engine/frame/frame.h"

namespace zoe {

/// Collects what happened when, and writes it as Chrome trace events (about:tracing, Perfetto).
class TraceEvents {
public:
    using Clock = std::chrono::steady_clock;

    TraceEvents() : origin_(Clock::now()) {}

    /// A span on the timeline.
    void add(const std::string& name, Clock::time_point begin, double duration_ms, int frame);
    /// The first four stages of a frame, one after another from where `advance` began, and its counts of nodes.
    void add_stages(Clock::time_point begin, const FrameStats& stats, int frame);

    /// Throws     std::runtime_error where the file cannot be written.
    void write(const std::filesystem::path& file) const;

private:
    struct Event {
        std::string name;
        double begin_us, duration_us;
        int frame;
    };
    struct Counts {
        double at_us;
        uint32_t kept, refitted, rebuilt;
    };
    double us_since_origin(Clock::time_point time) const;

    Clock::time_point origin_;
    std::vector<Event> events_;
    std::vector<Counts> counts_;
};

}  // namespace zoe
