#include "apps/bench/peer_embree.h"

#include <algorithm>
#include <cassert>
#include <memory>
#include <stdexcept>

#include <fmt/format.h>

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
    const EmbreeDevice device(1);
    const auto property = [&](RTCDeviceProperty name) { return rtcGetDeviceProperty(device.handle(), name); };
    std::string widths;
    for (const auto& [name, width] :
         {std::pair(RTC_DEVICE_PROPERTY_NATIVE_RAY4_SUPPORTED, 4), std::pair(RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED, 8),
          std::pair(RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED, 16)}) {
        if (property(name)) widths += fmt::format("{}{}", widths.empty() ? "" : ", ", width);
    }
    return fmt::format("Embree {}.{}.{}, native packets of {}", property(RTC_DEVICE_PROPERTY_VERSION_MAJOR),
                       property(RTC_DEVICE_PROPERTY_VERSION_MINOR), property(RTC_DEVICE_PROPERTY_VERSION_PATCH), widths);
}

/// The device outlives what was made by it.
struct EmbreePeer::State {
    State(const EmbreeConfig& given, int threads) : config(given), device(threads) {}

    EmbreeConfig config;
    EmbreeDevice device;
    std::shared_ptr<const FrameState> frame;  ///< That the layout was made for; held, so that its address stays its own.
    std::unique_ptr<EmbreeLayout> layout;
    EmbreeTracer tracer;

    EmbreeRays rays(RayKind kind) const { return config.rays[static_cast<size_t>(kind)]; }
    EmbreeTarget target() const {
        if (!layout) throw std::logic_error("EmbreePeer: update comes before rays");
        return layout->target();
    }
};

EmbreePeer::EmbreePeer(const EmbreeConfig& config, int threads) : state_(std::make_unique<State>(config, threads)) {
    assert(threads == thread_count());
}

EmbreePeer::~EmbreePeer() = default;

EmbreePeer::UpdateTimes EmbreePeer::update(const Scene& scene, const Tlas& tlas) {
    State& state = *state_;
    require_in_embree_range(tlas);
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
    return state_->tracer.closest_hits(state_->target(), rays, state_->rays(kind), hits);
}

double EmbreePeer::any_hits(std::span<const Ray> rays, RayKind kind, std::span<uint8_t> is_hit) {
    return state_->tracer.any_hits(state_->target(), rays, state_->rays(kind), is_hit);
}

void EmbreePeer::set_rays(RayKind kind, EmbreeRays rays) {
    assert(std::ranges::count(forms_of(kind), rays) == 1);
    state_->config.rays[static_cast<size_t>(kind)] = rays;
}

}  // namespace zoe
