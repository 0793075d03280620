#include "apps/bench/report.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

namespace zoe {
namespace {

std::string ms_text(double ms) {
    return ms >= 100.0 ? fmt::format("{:.1f}", ms) : ms >= 10.0 ? fmt::format("{:.2f}", ms) : fmt::format("{:.3f}", ms);
}

std::string ratio_text(double ratio) {
    return std::isnan(ratio) ? "-" : fmt::format("{:.2f}x", ratio);
}

/// 1234567 -> "1,234,567".
std::string count_text(uint64_t count) {
    const std::string digits = std::to_string(count);
    std::string text;
    for (size_t k = 0; k < digits.size(); ++k) {
        if (k > 0 && (digits.size() - k) % 3 == 0) text += ',';
        text += digits[k];
    }
    return text;
}

/// In quotes, and its own doubled, where it holds what separates fields: names are those of files.
std::string csv_field(const std::string& text) {
    if (text.find_first_of(",\"\n") == std::string::npos) return text;
    std::string field;
    for (const char c : text) {
        if (c == '"') field += '"';
        field += c;
    }
    return fmt::format("\"{}\"", field);
}

/// Millions of rays a second, median over the frames.
template <typename Kind>
double mrays_per_s(const RunStats& run, Kind&& kind) {
    std::vector<double> rates;
    for (const FrameRecord& frame : run.frames) {
        const FrameStats::Kind& k = kind(frame);
        rates.push_back(k.ms > 0.0 ? static_cast<double>(k.rays) / k.ms / 1000.0 : 0.0);
    }
    return percentile(std::move(rates), 0.5);
}

std::string verdicts_text(const RunStats& run) {
    uint64_t count = 0;
    for (const FrameRecord& frame : run.frames) count += frame.peer ? frame.peer->disagreements : 0;
    if (run.warm_up && run.warm_up->peer) count += run.warm_up->peer->disagreements;
    if (count == 0) return "0";
    std::string text = fmt::format("{}:", count);
    const std::pair<uint64_t, const char*> verdicts[] = {{run.peer->ours_right, "ours right"},
                                                         {run.peer->peer_right, "peer right"},
                                                         {run.peer->either_right, "either"},
                                                         {run.peer->neither_right, "neither"},
                                                         {run.peer->not_judged, "not judged"}};
    for (const auto& [number, what] : verdicts) {
        if (number > 0) text += fmt::format(" {} {},", number, what);
    }
    text.pop_back();
    return text;
}

}  // namespace

std::string machine_text(const std::vector<std::pair<std::string, std::string>>& machine) {
    std::string text;
    for (const auto& [key, value] : machine) text += fmt::format("{:<10} {}\n", key, value);
    return text;
}

std::string stages_heading(bool has_peer) {
    return fmt::format("{:<17}{:>11}{:>9}{:>9}{:>12}{:>11}{:>10}{:>10}{:>10}{:>10}{}  {}\n", "median ms", "triangles",
                       "animate", "deform", "update_blas", "build_tlas", "trace", "frame", "p99", "warm-up",
                       has_peer ? fmt::format("{:>9}", "vs peer") : "", "frame times");
}

std::string stages_line(const RunStats& run) {
    const auto of = [&](auto field) { return ms_text(median(run.frames, [&](const FrameStats& s) { return s.*field; })); };
    const auto frame_ms = [](const FrameStats& s) { return s.frame_ms(); };
    std::vector<double> times;
    for (const FrameRecord& frame : run.frames) times.push_back(frame.stats.frame_ms());
    const std::string ratio = run.peer ? fmt::format("{:>9}", ratio_text(ratios_to_peer(run.frames).frame)) : "";
    return fmt::format("{:<17}{:>11}{:>9}{:>9}{:>12}{:>11}{:>10}{:>10}{:>10}{:>10}{}  {}\n", run.scene,
                       count_text(run.triangle_count), of(&FrameStats::animate_ms), of(&FrameStats::deform_ms),
                       of(&FrameStats::update_blas_ms), of(&FrameStats::build_tlas_ms), of(&FrameStats::trace_ms),
                       ms_text(median(run.frames, frame_ms)), ms_text(percentile(run.frames, 0.99, frame_ms)),
                       run.warm_up ? ms_text(run.warm_up->stats.frame_ms()) : "-", ratio, sparkline(times, 20));
}

std::string rays_table(const std::vector<RunStats>& runs) {
    const bool has_peer = std::ranges::any_of(runs, [](const RunStats& run) { return run.peer.has_value(); });
    std::string text;
    if (has_peer) {
        text = fmt::format("{:<17}{:^24}{:^24}{:^24}{:>9}  {}\n{:<17}", "", "primary", "diffuse", "shadow", "update",
                           "rays that disagree, and who is right by double precision", "Mrays/s");
        for (int kind = 0; kind < 3; ++kind) text += fmt::format("{:>8}{:>8}{:>8}", "ours", "peer", "ratio");
        text += fmt::format("{:>9}\n", "ratio");
    } else {
        text = fmt::format("{:<17}{:>10}{:>10}{:>10}\n", "Mrays/s", "primary", "diffuse", "shadow");
    }
    for (const RunStats& run : runs) {
        text += fmt::format("{:<17}", run.scene);
        const Ratios ratios = ratios_to_peer(run.frames);
        const auto add = [&](FrameStats::Kind FrameStats::*ours, FrameStats::Kind PeerStats::*peers, double ratio) {
            const double rate =
                mrays_per_s(run, [&](const FrameRecord& frame) -> const FrameStats::Kind& { return frame.stats.*ours; });
            if (!run.peer) {
                text += fmt::format("{:>10.2f}", rate);
                return;
            }
            const double peer_rate =
                mrays_per_s(run, [&](const FrameRecord& frame) -> const FrameStats::Kind& { return (*frame.peer).*peers; });
            text += fmt::format("{:>8.2f}{:>8.2f}{:>8}", rate, peer_rate, ratio_text(ratio));
        };
        add(&FrameStats::primary, &PeerStats::primary, ratios.primary);
        add(&FrameStats::diffuse, &PeerStats::diffuse, ratios.diffuse);
        add(&FrameStats::shadow, &PeerStats::shadow, ratios.shadow);
        if (run.peer) text += fmt::format("{:>9}  {}", ratio_text(ratios.update), verdicts_text(run));
        text += "\n";
    }
    if (!has_peer) return text;
    text +=
        "\nA ratio is the peer's time over ours, median over the frames: above 1, ours is faster. update is update_blas "
        "and\n"
        "build_tlas; animate and deform, which the peer takes from us, are in no ratio. What the peer ran as:\n";
    for (const RunStats& run : runs) {
        if (run.peer) text += fmt::format("  {:<17}{}: {}\n", run.scene, run.peer->name, run.peer->configuration);
    }
    return text;
}

std::string csv(const std::vector<RunStats>& runs) {
    std::string text =
        "scene,frame,animate_ms,deform_ms,update_blas_ms,build_tlas_ms,trace_ms,frame_ms,kept,refitted,rebuilt,"
        "rays,hits,hits_hash,primary_rays,primary_ms,diffuse_rays,diffuse_ms,shadow_rays,shadow_ms,"
        "peer_update_ms,peer_build_tlas_ms,peer_trace_ms,peer_frame_ms,peer_primary_ms,peer_diffuse_ms,"
        "peer_shadow_ms,peer_disagreements\n";
    for (const RunStats& run : runs) {
        const std::string scene = csv_field(run.scene);
        for (const FrameRecord& frame : run.frames) {
            const FrameStats& s = frame.stats;
            text += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{},{:016x},{},{},{},{},{},{}", scene, frame.frame,
                                s.animate_ms, s.deform_ms, s.update_blas_ms, s.build_tlas_ms, s.trace_ms, s.frame_ms(),
                                s.kept, s.refitted, s.rebuilt, s.rays, s.hits, s.hits_hash, s.primary.rays, s.primary.ms,
                                s.diffuse.rays, s.diffuse.ms, s.shadow.rays, s.shadow.ms);
            if (frame.peer) {
                const PeerStats& p = *frame.peer;
                text += fmt::format(",{},{},{},{},{},{},{},{}\n", p.update_ms, p.build_tlas_ms, p.trace_ms, p.frame_ms(),
                                    p.primary.ms, p.diffuse.ms, p.shadow.ms, p.disagreements);
            } else {
                text += ",,,,,,,,\n";
            }
        }
    }
    return text;
}

std::string sparkline(const std::vector<double>& values, size_t max_width) {
    constexpr const char* kBars[] = {"▁", "▂", "▃", "▄", "▅", "▆", "▇", "█"};
    const size_t width = std::min(values.size(), max_width);
    if (width == 0) return "";
    std::vector<double> means(width);
    for (size_t k = 0; k < width; ++k) {
        const size_t begin = k * values.size() / width, end = (k + 1) * values.size() / width;
        means[k] = std::accumulate(values.begin() + static_cast<ptrdiff_t>(begin),
                                   values.begin() + static_cast<ptrdiff_t>(end), 0.0) /
                   static_cast<double>(end - begin);
    }
    const double largest = *std::ranges::max_element(means);
    std::string text;
    for (const double mean : means) {
        const double level = largest > 0.0 ? std::ceil(8.0 * mean / largest) - 1.0 : 0.0;
        text += kBars[static_cast<size_t>(std::clamp(level, 0.0, 7.0))];
    }
    return text;
}

}  // namespace zoe
