#include "apps/bench/play.h"

#include <algorithm>
#include <limits>
#include <memory>
#include <set>
#include <stdexcept>
#include <tuple>

#include <fmt/format.h>

#include "apps/bench/frame_run.h"
#include "apps/common/interrupt.h"
#include "engine/math/parallel.h"

namespace zoe {
namespace {

/// Frames by which the peer's configurations are told apart, after one that warms up.
constexpr int kTrialFrames = 5;
/// One that takes this many times the best one's time so far is given up, after so many frames.
constexpr double kFarBehind = 1.2;
constexpr int kFramesBeforeGivingUp = 3;

/// A ray of a frame, and what the peer found.
using DisagreementKey = std::tuple<int, RayKind, size_t, NodeId, uint32_t, float>;

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

double median_of(const std::vector<double>& values) {
    return percentile(values, 0.5);
}

/// A configuration of the peer on trial.
struct Candidate {
    EmbreeConfig config;
    std::unique_ptr<EmbreePeer> peer;  ///< Null once it is too far behind.
    FrameRun::PeerTrial trial;

    /// Hands each kind of rays over in the way that took least.
    void choose_rays() {
        for (const RayKind kind : kRayKinds) {
            const auto forms = trials_of(kind);
            const auto least = std::ranges::min_element(forms, {}, median_of) - forms.begin();
            config.rays[static_cast<size_t>(kind)] = forms_of(kind)[static_cast<size_t>(least)];
        }
    }
    double frame_ms() const {
        double sum_ms = median_of(trial.update_ms);
        for (const RayKind kind : kRayKinds) {
            const auto forms = trials_of(kind);
            sum_ms += median_of(*std::ranges::min_element(forms, {}, median_of));
        }
        return sum_ms;
    }
    /// [forms_of(kind)][frames]
    std::span<const std::vector<double>> trials_of(RayKind kind) const {
        return std::span(trial.trace_ms[static_cast<size_t>(kind)]).first(forms_of(kind).size());
    }
};

class Player {
public:
    Player(const BenchScene& scene, const PlayConfig& config, const Report& report)
        : scene_(scene),
          config_(config),
          report_(report),
          content_(open_bench_scene(scene)),
          frame_run_(content_, choose_view(content_, scene), scene.size) {
        if (config.is_exact) content_.scene.tlas_build.exact_up_to = std::numeric_limits<uint32_t>::max();
    }

    Played play() {
        step_count_ = scene_.repeats * (scene_.frame_count + 1);
        if (config_.has_peer) choose_peer_config();
        for (int repeat = 0; repeat < scene_.repeats; ++repeat) play_once(repeat);
        return std::move(played_);
    }

private:
    void report_within_step(const std::string& detail) const {
        if (is_interrupted()) throw Interrupted("interrupted");
        report_(static_cast<double>(steps_done_) / step_count_, detail);
    }
    void report_step(const std::string& detail) {
        report_within_step(detail);
        ++steps_done_;
    }

    /// Plays frames all over the clip with every configuration, in turn; those far behind are dropped on the way.
    void choose_peer_config() {
        PeerRun peer;
        peer.name = EmbreePeer::version();
        const Tlas& tlas = advance(content_, 0.0, nullptr);
        std::vector<Candidate> candidates;
        for (const EmbreeConfig& config : embree_configs(content_.scene, tlas, config_.peer)) {
            candidates.push_back(
                {.config = config, .peer = std::make_unique<EmbreePeer>(config, thread_count()), .trial = {}});
        }
        const int trial_count = std::min(kTrialFrames, scene_.frame_count);
        step_count_ += trial_count + 1;
        for (int trial = 0; trial <= trial_count; ++trial) {
            report_step("trying Embree's configurations");
            try_candidates(trial == 0 ? 0 : 1 + (trial - 1) * scene_.frame_count / trial_count, trial, &candidates);
        }
        for (Candidate& candidate : candidates) {
            candidate.choose_rays();
            peer.tried.push_back({candidate.config.describe(), candidate.frame_ms()});
        }
        peer_config_ = std::ranges::min_element(candidates, {}, &Candidate::frame_ms)->config;
        peer.configuration = peer_config_.describe();
        played_.run.peer = std::move(peer);
    }

    /// trial_number   counted up; 0 warms up and counts for nothing.
    void try_candidates(int frame, int trial_number, std::vector<Candidate>* candidates) {
        std::vector<EmbreePeer*> peers;
        std::vector<FrameRun::PeerTrial> trials;
        for (const Candidate& candidate : *candidates) {
            if (!candidate.peer) continue;
            peers.push_back(candidate.peer.get());
            trials.push_back(candidate.trial);
        }
        frame_run_.try_peers(frame, static_cast<size_t>(trial_number), peers, trials);
        if (trial_number == 0) return;
        double least_ms = kInfinity;
        auto trial = trials.begin();
        for (Candidate& candidate : *candidates) {
            if (!candidate.peer) continue;
            candidate.trial = std::move(*trial++);
            least_ms = std::min(least_ms, candidate.frame_ms());
        }
        if (trial_number < kFramesBeforeGivingUp) return;
        for (Candidate& candidate : *candidates) {
            if (candidate.frame_ms() > kFarBehind * least_ms) candidate.peer.reset();
        }
    }

    void play_once(int repeat) {
        content_.scene.touch();
        std::unique_ptr<EmbreePeer> peer;
        if (config_.has_peer) peer = std::make_unique<EmbreePeer>(peer_config_, thread_count());
        for (int frame = 0; frame <= scene_.frame_count; ++frame) {
            report_step(fmt::format("repeat {}/{}, frame {}", repeat + 1, scene_.repeats, frame));
            FrameRecord record = frame_run_.run(frame, peer.get(), (frame + repeat) % 2 != 0);
            std::vector<FrameRecord>& frames = played_.run.frames;
            const size_t new_disagreement_count = judge_frame(frame);
            if (repeat > 0) {
                FrameRecord& first = frame == 0 ? *played_.run.warm_up : frames[static_cast<size_t>(frame) - 1];
                take_least(record, &first);
                if (first.peer) first.peer->disagreements += new_disagreement_count;
                continue;
            }
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
        played_.run.repeats = scene_.repeats;
        played_.run.peer = std::move(peer);
    }

    /// Of a repeat, what was not found before: Embree's trees may differ from build to build.
    /// Returns    how many those are.
    size_t judge_frame(int frame) {
        std::vector<Disagreement> found;
        for (const Disagreement& disagreement : frame_run_.disagreements()) {
            const Hit& hit = disagreement.peers;
            const DisagreementKey key{frame, disagreement.kind, disagreement.ray_index, hit.node, hit.primitive, hit.t};
            if (known_.insert(key).second) found.push_back(disagreement);
        }
        const size_t count = std::min(found.size(), kMaxJudged - played_.disagreements.size());
        if (count < found.size()) played_.run.peer->not_judged += found.size() - count;
        for (size_t begin = 0; begin < count; begin += kJudgedAtOnce) {
            report_within_step(fmt::format("frame {}: judging {} of {} rays that disagree", frame, begin, count));
            judge_some(std::span(found).subspan(begin, std::min(kJudgedAtOnce, count - begin)));
        }
        return found.size();
    }

    void judge_some(std::span<const Disagreement> found) {
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
    std::set<DisagreementKey> known_;
    Played played_;
    int steps_done_ = 0, step_count_ = 1;
};

}  // namespace

Played play(const BenchScene& scene, const PlayConfig& config, const Report& report) {
    return Player(scene, config, report).play();
}

}  // namespace zoe
