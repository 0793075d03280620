#include "apps/bench/peer_embree.h"

#include <cassert>
#include <memory>
#include <stdexcept>

#include "apps/bench/embree_device.h"
#include "apps/bench/embree_layout.h"
#include "apps/bench/embree_trace.h"
#include "engine/frame/frame_state.h"
#include "engine/math/parallel.h"

namespace zoe {

bool is_embree_available() {
    return true;
}

std::string EmbreePeer::version() {
    return "Embree " RTC_VERSION_STRING;
}

/// The device outlives what was made by it.
struct EmbreePeer::State {
    State(const EmbreeConfig& given, int threads) : config(given), device(threads) {}

    EmbreeConfig config;
    EmbreeDevice device;
    std::shared_ptr<const FrameState> frame;  ///< That the layout was made for; held, so that its address stays its own.
    std::unique_ptr<EmbreeLayout> layout;
    EmbreeTracer tracer;

    EmbreeTraceMode mode(RayKind kind) const {
        return {.is_coherent = kind == RayKind::kPrimary, .uses_packets = config.uses_packets[static_cast<size_t>(kind)]};
    }
    const EmbreeLayout& updated_layout() const {
        if (!layout) throw std::logic_error("EmbreePeer: update comes before rays");
        return *layout;
    }
};

EmbreePeer::EmbreePeer(const EmbreeConfig& config, int threads) : state_(std::make_unique<State>(config, threads)) {
    assert(threads == thread_count());
}

EmbreePeer::~EmbreePeer() = default;

EmbreePeer::UpdateTimes EmbreePeer::update(const Scene& scene, const Tlas& tlas) {
    State& state = *state_;
    if (state.frame != scene.frame) {
        state.layout.reset();
        const auto make =
            state.config.layout == EmbreeConfig::Layout::kInstances ? make_embree_instances : make_embree_one_scene;
        state.layout = make(state.device, state.config, scene);
        state.frame = scene.frame;
    }
    const UpdateTimes times = state.layout->update(scene, tlas);
    state.device.check();
    return times;
}

double EmbreePeer::closest_hits(std::span<const Ray> rays, RayKind kind, std::span<Hit> hits) {
    return state_->tracer.closest_hits(state_->updated_layout(), rays, state_->mode(kind), hits);
}

double EmbreePeer::any_hits(std::span<const Ray> rays, RayKind kind, std::span<uint8_t> is_hit) {
    return state_->tracer.any_hits(state_->updated_layout(), rays, state_->mode(kind), is_hit);
}

void EmbreePeer::set_packets(RayKind kind, bool uses_packets) {
    state_->config.uses_packets[static_cast<size_t>(kind)] = uses_packets;
}

}  // namespace zoe
