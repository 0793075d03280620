#include "apps/bench/play.h"

#include <algorithm>
#include <array>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>

#include "apps/bench/frame_run.h"
#include "apps/common/interrupt.h"
#include "apps/common/open_scene.h"
#include "engine/math/parallel.h"

namespace zoe {
namespace {

/// Frames by which the peer's configurations are told apart, after one that warms up.
constexpr int kTrialFrames = 3;
/// Rays of a scene that are judged: brute force takes a few ms each.
constexpr size_t kMaxJudged = 20'000;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

template <typename Stats>
void take_least(const Stats& from, std::initializer_list<double Stats::*> times, Stats* to) {
    for (const auto time : times) to->*time = std::min(to->*time, from.*time);
    for (const RayKind kind : kRayKinds) kind_of(*to, kind).ms = std::min(kind_of(*to, kind).ms, kind_of(from, kind).ms);
    to->trace_ms = to->primary.ms + to->diffuse.ms + to->shadow.ms;
}

/// Keeps the lesser of each time. The frame is the same: anything else that differs is a fault.
void take_least(const FrameRecord& again, FrameRecord* record) {
    const FrameStats &a = again.stats, &b = record->stats;
    if (a.kept != b.kept || a.refitted != b.refitted || a.rebuilt != b.rebuilt) {
        throw std::runtime_error(
            fmt::format("frame {}: another number of kept, refitted and rebuilt trees when repeated", record->frame));
    }
    if (a.hits_hash != b.hits_hash) {
        throw std::runtime_error(fmt::format("frame {}: hits {:016x} and {:016x} in two repeats of the same frame",
                                             record->frame, b.hits_hash, a.hits_hash));
    }
    take_least(again.stats,
               {&FrameStats::animate_ms, &FrameStats::deform_ms, &FrameStats::update_blas_ms, &FrameStats::build_tlas_ms},
               &record->stats);
    if (again.peer) take_least(*again.peer, {&PeerStats::update_ms, &PeerStats::build_tlas_ms}, &*record->peer);
}

void take_least(const FrameRun::PeerTrial& from, FrameRun::PeerTrial* to) {
    to->update_ms = std::min(to->update_ms, from.update_ms);
    for (size_t kind = 0; kind < kRayKindCount; ++kind) {
        for (size_t form = 0; form < 2; ++form)
            to->trace_ms[kind][form] = std::min(to->trace_ms[kind][form], from.trace_ms[kind][form]);
    }
}

class Player {
public:
    Player(const BenchScene& scene, const PlayConfig& config, const Report& report)
        : scene_(scene),
          config_(config),
          report_(report),
          content_(open_scene(scene.scene, kBenchFps)),
          frame_run_(content_, choose_view(), scene.size) {}

    Played play() {
        step_count_ = config_.repeats * (scene_.frame_count + 1);
        if (config_.has_peer) choose_peer_config();
        for (int repeat = 0; repeat < config_.repeats; ++repeat) play_once(repeat);
        return std::move(played_);
    }

private:
    /// The first camera, or what holds the scene whole at the ends and in the middle.
    ViewChoice choose_view() {
        ViewChoice view;
        if (const std::vector<NodeId> cameras = camera_nodes(content_.scene); !cameras.empty()) {
            view.camera = cameras.front();
            return view;
        }
        const double last_s = scene_.frame_count / kBenchFps;
        view.bounds = bounds_over(content_, std::array{0.0, 0.5 * last_s, last_s});
        return view;
    }

    void report_step(const std::string& detail) {
        if (is_interrupted()) throw Interrupted("interrupted");
        report_(static_cast<double>(steps_done_++) / step_count_, detail);
    }

    void choose_peer_config() {
        PeerRun peer;
        peer.name = EmbreePeer::version();
        const Tlas& tlas = advance(content_, 0.0, nullptr);
        const std::vector<EmbreeConfig> configs =
            embree_configs(content_.scene, tlas, config_.is_peer_high, config_.is_peer_robust);
        step_count_ += kTrialFrames + 1;
        std::vector<std::unique_ptr<EmbreePeer>> peers;
        for (const EmbreeConfig& config : configs) peers.push_back(std::make_unique<EmbreePeer>(config, thread_count()));
        std::vector<FrameRun::PeerTrial> least;
        for (int frame = 0; frame <= kTrialFrames; ++frame) {
            report_step("trying Embree's configurations");
            const std::vector<FrameRun::PeerTrial> trials = frame_run_.try_peers(frame, peers);
            if (frame <= 1) least = trials;  // the first warms up
            for (size_t k = 0; k < trials.size(); ++k) take_least(trials[k], &least[k]);
        }
        double least_ms = kInfinity;
        for (size_t k = 0; k < configs.size(); ++k) {
            EmbreeConfig config = configs[k];
            double frame_ms = least[k].update_ms;
            for (size_t kind = 0; kind < kRayKindCount; ++kind) {
                const auto& [single_ms, packets_ms] = least[k].trace_ms[kind];
                config.uses_packets[kind] = packets_ms < single_ms;
                frame_ms += std::min(single_ms, packets_ms);
            }
            peer.tried.push_back({config.describe(), frame_ms});
            if (frame_ms >= least_ms) continue;
            least_ms = frame_ms;
            peer_config_ = config;
        }
        peer.configuration = peer_config_.describe();
        played_.run.peer = std::move(peer);
    }

    void play_once(int repeat) {
        content_.scene.touch();
        std::unique_ptr<EmbreePeer> peer;
        if (config_.has_peer) peer = std::make_unique<EmbreePeer>(peer_config_, thread_count());
        for (int frame = 0; frame <= scene_.frame_count; ++frame) {
            report_step(fmt::format("repeat {}/{}, frame {}", repeat + 1, config_.repeats, frame));
            FrameRecord record = frame_run_.run(frame, peer.get(), (frame + repeat) % 2 != 0);
            std::vector<FrameRecord>& frames = played_.run.frames;
            if (repeat > 0) {
                take_least(record, frame == 0 ? &*played_.run.warm_up : &frames[static_cast<size_t>(frame) - 1]);
                continue;
            }
            judge_frame();
            if (frame == 0) {
                describe();
                played_.run.warm_up = std::move(record);
            } else {
                frames.push_back(std::move(record));
            }
        }
    }

    void describe() {
        std::optional<PeerRun> peer = std::move(played_.run.peer);
        played_.run = describe_run(scene_.name, content_.scene, frame_run_.tlas());
        played_.run.size = fmt::format("{}x{}", scene_.size.width, scene_.size.height);
        played_.run.repeats = config_.repeats;
        played_.run.peer = std::move(peer);
    }

    void judge_frame() {
        std::span<const Disagreement> found = frame_run_.disagreements();
        const size_t room = kMaxJudged - played_.disagreements.size();
        if (found.size() > room) played_.run.peer->not_judged += found.size() - room;
        found = found.first(std::min(found.size(), room));
        if (found.empty()) return;
        const std::vector<Verdict> verdicts = judge(frame_run_.tlas(), found);
        for (size_t k = 0; k < found.size(); ++k) {
            played_.disagreements.push_back(found[k]);
            played_.verdicts.push_back(verdicts[k]);
            PeerRun& peer = *played_.run.peer;
            switch (verdicts[k]) {
                case Verdict::kOurs:
                    ++peer.ours_right;
                    break;
                case Verdict::kPeers:
                    ++peer.peer_right;
                    break;
                case Verdict::kEither:
                    ++peer.either_right;
                    break;
                case Verdict::kNeither:
                    ++peer.neither_right;
                    break;
            }
        }
    }

    const BenchScene& scene_;
    const PlayConfig& config_;
    const Report& report_;
    Content content_;
    FrameRun frame_run_;
    EmbreeConfig peer_config_;
    Played played_;
    int steps_done_ = 0, step_count_ = 1;
};

}  // namespace

Played play(const BenchScene& scene, const PlayConfig& config, const Report& report) {
    return Player(scene, config, report).play();
}

}  // namespace zoe
