#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "apps/bench/bench_scenes.h"
#include "apps/bench/judge.h"
#include "apps/bench/peer_embree.h"
#include "apps/common/choose_view.h"
#include "apps/common/parse.h"
#include "apps/common/stats_json.h"

namespace zoe {

/// The first camera, or what holds the scene whole at the ends and in the middle of its frames.
ViewChoice choose_view(Content& content, const BenchScene& scene);

/// Makes and traces single frames of a scene. Keeps its memory from frame to frame.
class FrameRun {
public:
    FrameRun(Content& content, const ViewChoice& view, PictureSize size);

    /// Advances to the frame, and makes the peer (may be null) do the same; traces the rays of each kind with both.
    /// is_peer_first  who traces first. The frame is made by ours first in any case: the peer takes its vertices.
    FrameRecord run(int frame, EmbreePeer* peer, bool is_peer_first);

    /// What the peer alone takes for frames.
    struct PeerTrial {
        std::vector<double> update_ms;  ///< [frames]
        std::array<std::array<std::vector<double>, kEmbreeRays.size()>, kRayKindCount>
            trace_ms;  ///< [kind][how handed over]
    };
    /// Plays a frame with each peer alone, in turn, so that a drifting machine hits all of them.
    /// turn       who comes first: counted up from trial to trial; 0 warms up, each kind of rays in one form only.
    /// trials     [peer_count] what the frame took is added.
    void try_peers(int frame, size_t turn, std::span<EmbreePeer* const> peers, std::span<PeerTrial> trials);

    const Tlas& tlas() const { return *tlas_; }
    /// Of the last frame.
    std::span<const Ray> rays(RayKind kind) const { return batches_[static_cast<size_t>(kind)].rays; }
    /// Of the last frame.
    const std::vector<Disagreement>& disagreements() const { return disagreements_; }

private:
    struct Batch {
        std::vector<Ray> rays;
        std::vector<Hit> hits, peer_hits;
        std::vector<uint8_t> is_hit, is_peer_hit;
    };
    void make_rays(RayKind kind);
    double trace_ours(RayKind kind);
    double trace_peer(RayKind kind, EmbreePeer* peer);
    void compare(RayKind kind, int frame);
    void count_hits(RayKind kind, FrameStats* stats) const;

    Content& content_;
    ViewChoice view_;
    PictureSize size_;
    const Tlas* tlas_ = nullptr;
    std::array<Batch, kRayKindCount> batches_;
    std::vector<Disagreement> disagreements_;
};

/// Statistics of one kind, of ours or the peer's.
template <typename Stats>
auto& kind_of(Stats& stats, RayKind kind) {
    return kind == RayKind::kPrimary ? stats.primary : kind == RayKind::kDiffuse ? stats.diffuse : stats.shadow;
}

}  // namespace zoe
