#include "apps/bench/embree_device.h"

#include <stdexcept>
#include <utility>

#include <fmt/format.h>

namespace zoe {

EmbreeDevice::EmbreeDevice(int threads) : device_(rtcNewDevice(fmt::format("threads={},start_threads=1", threads).c_str())) {
    if (!device_) {
        throw std::runtime_error(fmt::format("Embree: no device (error {})", static_cast<int>(rtcGetDeviceError(nullptr))));
    }
    rtcSetDeviceErrorFunction(device_, report, this);
    rtcSetDeviceMemoryMonitorFunction(device_, count_bytes, this);
}

EmbreeDevice::~EmbreeDevice() {
    rtcReleaseDevice(device_);
}

EmbreeScene EmbreeDevice::new_scene(RTCBuildQuality quality, int flags) const {
    EmbreeScene scene(rtcNewScene(device_));
    if (!scene) throw std::runtime_error("Embree: no scene");
    rtcSetSceneBuildQuality(scene.get(), quality);
    rtcSetSceneFlags(scene.get(), static_cast<RTCSceneFlags>(flags));
    return scene;
}

void EmbreeDevice::report(void* device, RTCError code, const char* text) {
    EmbreeDevice& self = *static_cast<EmbreeDevice*>(device);
    const std::lock_guard lock(self.mutex_);
    if (self.error_.empty()) self.error_ = fmt::format("Embree: {} (error {})", text ? text : "", static_cast<int>(code));
}

bool EmbreeDevice::count_bytes(void* device, ssize_t change, bool) {
    static_cast<EmbreeDevice*>(device)->byte_count_ += change;
    return true;
}

void EmbreeDevice::check() {
    const std::lock_guard lock(mutex_);
    if (!error_.empty()) throw std::runtime_error(std::exchange(error_, {}));
}

}  // namespace zoe
