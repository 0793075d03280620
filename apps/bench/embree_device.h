#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>

#include <embree3/rtcore.h>

namespace zoe {

struct ReleaseEmbree {
    void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
    void operator()(RTCGeometry geometry) const { rtcReleaseGeometry(geometry); }
};
using EmbreeScene = std::unique_ptr<RTCSceneTy, ReleaseEmbree>;
using EmbreeGeometry = std::unique_ptr<RTCGeometryTy, ReleaseEmbree>;

/// Embree's device, and the first thing that it complained about.
class EmbreeDevice {
public:
    /// threads    that Embree's builds may use, at least 1.
    /// Throws     std::runtime_error where Embree makes no device.
    explicit EmbreeDevice(int threads);
    ~EmbreeDevice();
    EmbreeDevice(const EmbreeDevice&) = delete;
    EmbreeDevice& operator=(const EmbreeDevice&) = delete;

    RTCDevice handle() const { return device_; }
    EmbreeScene new_scene(RTCBuildQuality quality, int flags) const;

    /// What Embree holds at the moment, the buffers that it shares with us aside.
    uint64_t byte_count() const { return static_cast<uint64_t>(byte_count_.load()); }

    /// Throws     std::runtime_error with the first error of any call since the last check. Embree's calls return none.
    void check();

private:
    static void report(void* device, RTCError code, const char* text);
    static bool count_bytes(void* device, ssize_t change, bool is_done);

    RTCDevice device_ = nullptr;
    std::mutex mutex_;
    std::string error_;  ///< Errors come from the threads that build, and so do changes of memory.
    std::atomic<int64_t> byte_count_{0};
};

}  // namespace zoe
