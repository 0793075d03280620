#pragma once

#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "apps/bench/embree_device.h"

namespace zoe {

/// Triangles of Embree's, and the buffers that they are read from.
class EmbreeMesh {
public:
    /// quality    what the tree is built with where the scene is LOW; REFIT: refitted unless corners change.
    EmbreeMesh(RTCDevice device, RTCBuildQuality quality);

    RTCGeometry geometry() const { return geometry_.get(); }

    /// Replaces corners and the number of vertices, whose values are then to be written.
    /// corners    [triangle_count] each below vertex_count.
    void resize(std::span<const glm::uvec3> corners, size_t vertex_count);
    /// To write. Seen by Embree after `commit`.
    std::span<glm::vec3> vertices() { return {vertices_.data(), vertex_count_}; }

    /// Tells Embree that vertices were written, and corners where `resize` was called. The scene's commit is the caller's.
    void commit();

private:
    EmbreeGeometry geometry_;
    std::vector<glm::vec3> vertices_;  ///< And one more: Embree reads 16 bytes at the last vertex.
    std::vector<glm::uvec3> corners_;
    size_t vertex_count_ = 0;
    bool is_resized_ = false;
};

/// Qualities that Embree is asked for.
inline RTCBuildQuality static_quality(bool is_high) {
    return is_high ? RTC_BUILD_QUALITY_HIGH : RTC_BUILD_QUALITY_MEDIUM;
}
inline RTCBuildQuality arbitrary_quality(bool is_medium) {
    return is_medium ? RTC_BUILD_QUALITY_MEDIUM : RTC_BUILD_QUALITY_LOW;
}

}  // namespace zoe
