#include <algorithm>
#include <array>
#include <vector>

#include "apps/bench/embree_device.h"
#include "apps/bench/embree_mesh.h"
#include "apps/bench/embree_trace.h"
#include "apps/bench/peer_tree.h"
#include "apps/bench/stopwatch.h"

namespace zoe {
namespace {

constexpr std::array kNodes = {NodeId{0}};

RTCBuildQuality quality_of(PeerTree::Quality quality) {
    switch (quality) {
        case PeerTree::Quality::kLow:
            return RTC_BUILD_QUALITY_LOW;
        case PeerTree::Quality::kMedium:
            return RTC_BUILD_QUALITY_MEDIUM;
        case PeerTree::Quality::kHigh:
            return RTC_BUILD_QUALITY_HIGH;
    }
    return RTC_BUILD_QUALITY_MEDIUM;
}

}  // namespace

struct PeerTree::State {
    State(Quality quality, bool is_robust, int threads)
        : device(threads),
          scene(device.new_scene(quality_of(quality), (is_robust ? RTC_SCENE_FLAG_ROBUST : RTC_SCENE_FLAG_NONE) |
                                                          (quality == Quality::kLow ? RTC_SCENE_FLAG_DYNAMIC : 0))),
          mesh(device.handle(), quality_of(quality)) {}

    EmbreeDevice device;
    EmbreeScene scene;
    EmbreeMesh mesh;
    EmbreeTracer tracer;
    double build_ms = 0.0;
};

PeerTree::PeerTree(Quality quality, bool is_robust, std::span<const glm::vec3> positions,
                   std::span<const glm::uvec3> corners, int threads)
    : state_(std::make_unique<State>(quality, is_robust, threads)) {
    State& state = *state_;
    require_in_embree_range(positions);
    state.mesh.resize(corners, positions.size());
    std::ranges::copy(positions, state.mesh.vertices().begin());
    rtcAttachGeometryByID(state.scene.get(), state.mesh.geometry(), 0);
    rebuild();
}

double PeerTree::rebuild() {
    State& state = *state_;
    Stopwatch watch;
    state.mesh.commit();
    rtcCommitScene(state.scene.get());
    state.build_ms = watch.restart_ms();
    state.device.check();
    return state.build_ms;
}

PeerTree::~PeerTree() = default;
PeerTree::PeerTree(PeerTree&&) noexcept = default;
PeerTree& PeerTree::operator=(PeerTree&&) noexcept = default;

double PeerTree::build_ms() const {
    return state_->build_ms;
}

uint64_t PeerTree::byte_count() const {
    return state_->device.byte_count();
}

double PeerTree::closest_hits(std::span<const Ray> rays, EmbreeRays form, std::span<Hit> hits) {
    return state_->tracer.closest_hits({state_->scene.get(), kNodes}, rays, form, hits);
}

double PeerTree::any_hits(std::span<const Ray> rays, EmbreeRays form, std::span<uint8_t> is_hit) {
    return state_->tracer.any_hits({state_->scene.get(), kNodes}, rays, form, is_hit);
}

}  // namespace zoe
