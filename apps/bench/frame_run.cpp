#include "apps/bench/frame_run.h"

#include <atomic>

#include "apps/bench/compare.h"
#include "apps/bench/rays.h"
#include "apps/bench/timed_parallel.h"
#include "engine/math/parallel.h"

namespace zoe {

ViewChoice choose_view(Content& content, const BenchScene& scene) {
    ViewChoice view;
    if (const std::vector<NodeId> cameras = camera_nodes(content.scene); !cameras.empty()) {
        view.camera = cameras.front();
        return view;
    }
    const double last_s = scene.frame_count / kBenchFps;
    view.bounds = bounds_over(content, std::array{0.0, 0.5 * last_s, last_s});
    return view;
}

FrameRun::FrameRun(Content& content, const ViewChoice& view, PictureSize size)
    : content_(content), view_(view), size_(size) {}

// Kinds are made in their order: shadow rays from primary hits come with the diffuse rays.
void FrameRun::make_rays(RayKind kind) {
    const Scene& scene = content_.scene;
    Batch &primary = batches_[0], &diffuse = batches_[1], &shadow = batches_[2];
    switch (kind) {
        case RayKind::kPrimary: {
            const View view = view_.view(scene, static_cast<float>(size_.width) / static_cast<float>(size_.height));
            make_primary_rays(view, size_.width, size_.height, &primary.rays);
            break;
        }
        case RayKind::kDiffuse:
            diffuse.rays.clear();
            shadow.rays.clear();
            add_rays_at_hits(scene, *tlas_, primary.rays, primary.hits, RayKind::kPrimary, &diffuse.rays, &shadow.rays);
            break;
        case RayKind::kShadow:
            add_rays_at_hits(scene, *tlas_, diffuse.rays, diffuse.hits, RayKind::kDiffuse, nullptr, &shadow.rays);
            break;
    }
}

double FrameRun::trace_ours(RayKind kind) {
    Batch& batch = batches_[static_cast<size_t>(kind)];
    const std::span<const Ray> rays = batch.rays;
    if (kind == RayKind::kShadow) {
        batch.is_hit.resize(rays.size());
        const std::span<uint8_t> is_hit = batch.is_hit;
        return timed_parallel(rays.size(), kRaysATask, [&](size_t begin, size_t end) {
            any_hits(*tlas_, rays.subspan(begin, end - begin), is_hit.subspan(begin, end - begin));
        });
    }
    batch.hits.resize(rays.size());
    const std::span<Hit> hits = batch.hits;
    return timed_parallel(rays.size(), kRaysATask, [&](size_t begin, size_t end) {
        closest_hits(*tlas_, rays.subspan(begin, end - begin), hits.subspan(begin, end - begin));
    });
}

double FrameRun::trace_peer(RayKind kind, EmbreePeer* peer) {
    Batch& batch = batches_[static_cast<size_t>(kind)];
    if (kind == RayKind::kShadow) {
        batch.is_peer_hit.resize(batch.rays.size());
        return peer->any_hits(batch.rays, kind, batch.is_peer_hit);
    }
    batch.peer_hits.resize(batch.rays.size());
    return peer->closest_hits(batch.rays, kind, batch.peer_hits);
}

void FrameRun::compare(RayKind kind, int frame) {
    const Batch& batch = batches_[static_cast<size_t>(kind)];
    if (kind == RayKind::kShadow) {
        compare_any(frame, kind, batch.rays, batch.is_hit, batch.is_peer_hit, &disagreements_);
    } else {
        compare_closest(frame, kind, batch.rays, batch.hits, batch.peer_hits, &disagreements_);
    }
}

void FrameRun::count_hits(RayKind kind, FrameStats* stats) const {
    const Batch& batch = batches_[static_cast<size_t>(kind)];
    std::atomic<uint64_t> hits{0}, hits_hash{0};  // sums of integers: any order gives the same
    parallel_for(0, batch.rays.size(), kRaysATask, [&](size_t begin, size_t end) {
        uint64_t hits_here = 0, hash_here = 0;
        for (size_t k = begin; k < end; ++k) {
            const uint64_t key = static_cast<uint64_t>(kind) << 48 | k;
            // A shadow ray knows only whether there is a hit.
            const Hit hit = kind != RayKind::kShadow ? batch.hits[k] : batch.is_hit[k] ? Hit{.t = 0.0f} : Hit{};
            hits_here += kind == RayKind::kShadow ? batch.is_hit[k] : bool(hit);
            hash_here += hash(hit, key);
        }
        hits += hits_here;
        hits_hash += hash_here;
    });
    stats->hits += hits;
    stats->hits_hash += hits_hash;
}

FrameRecord FrameRun::run(int frame, EmbreePeer* peer, bool is_peer_first) {
    FrameRecord record{.frame = frame, .stats = {}, .peer = {}};
    PeerStats peers;
    disagreements_.clear();
    // Ours is made first in any case: the peer's vertices are what deform wrote.
    tlas_ = &advance(content_, frame / kBenchFps, &record.stats);
    if (peer) {
        const EmbreePeer::UpdateTimes times = peer->update(content_.scene, *tlas_);
        peers.update_ms = times.update_ms;
        peers.build_tlas_ms = times.build_tlas_ms;
    }
    for (const RayKind kind : kRayKinds) {
        make_rays(kind);
        const uint64_t ray_count = batches_[static_cast<size_t>(kind)].rays.size();
        FrameStats::Kind& ours = kind_of(record.stats, kind);
        ours.rays = ray_count;
        if (peer && is_peer_first) kind_of(peers, kind).ms = trace_peer(kind, peer);
        ours.ms = trace_ours(kind);
        if (peer && !is_peer_first) kind_of(peers, kind).ms = trace_peer(kind, peer);
        record.stats.rays += ray_count;
        record.stats.trace_ms += ours.ms;
        count_hits(kind, &record.stats);
        if (!peer) continue;
        kind_of(peers, kind).rays = ray_count;
        peers.rays += ray_count;
        peers.trace_ms += kind_of(peers, kind).ms;
        compare(kind, frame);
    }
    report_rays(content_.scene, record.stats.rays);
    peers.disagreements = disagreements_.size();
    if (peer) record.peer = peers;
    return record;
}

void FrameRun::try_peers(int frame, size_t turn, std::span<EmbreePeer* const> peers, std::span<PeerTrial> trials) {
    const bool is_warm_up = turn == 0;
    tlas_ = &advance(content_, frame / kBenchFps, nullptr);
    for (size_t i = 0; i < peers.size(); ++i) {
        const size_t k = (turn + i) % peers.size();
        const EmbreePeer::UpdateTimes times = peers[k]->update(content_.scene, *tlas_);
        trials[k].update_ms.push_back(times.update_ms + times.build_tlas_ms);
    }
    for (const RayKind kind : kRayKinds) {
        make_rays(kind);
        const std::span<const EmbreeRays> forms = forms_of(kind).first(is_warm_up ? 1 : forms_of(kind).size());
        for (size_t i = 0; i < forms.size() * peers.size(); ++i, ++turn) {
            const size_t k = turn % peers.size();
            const EmbreeRays form = forms[(turn / peers.size()) % forms.size()];
            peers[k]->set_rays(kind, form);
            trials[k].trace_ms[static_cast<size_t>(kind)][static_cast<size_t>(form)].push_back(trace_peer(kind, peers[k]));
        }
        Batch& batch = batches_[static_cast<size_t>(kind)];
        batch.hits = batch.peer_hits;  // for the next rays
    }
}

}  // namespace zoe
