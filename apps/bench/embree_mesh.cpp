#include "apps/bench/embree_mesh.h"

#include <stdexcept>

namespace zoe {

EmbreeMesh::EmbreeMesh(RTCDevice device, RTCBuildQuality quality)
    : geometry_(rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE)) {
    if (!geometry_) throw std::runtime_error("Embree: no geometry");
    rtcSetGeometryBuildQuality(geometry_.get(), quality);
}

void EmbreeMesh::resize(std::span<const glm::uvec3> corners, size_t vertex_count) {
    corners_.assign(corners.begin(), corners.end());
    vertices_.resize(vertex_count + 1);
    vertex_count_ = vertex_count;
    // The arrays may have moved. A count of 0 is refused without an address.
    if (corners_.capacity() == 0) corners_.reserve(1);
    rtcSetSharedGeometryBuffer(geometry_.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, corners_.data(), 0,
                               sizeof(glm::uvec3), corners_.size());
    rtcSetSharedGeometryBuffer(geometry_.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, vertices_.data(), 0,
                               sizeof(glm::vec3), vertex_count_);
    is_resized_ = true;
}

void EmbreeMesh::commit() {
    if (is_resized_) rtcUpdateGeometryBuffer(geometry_.get(), RTC_BUFFER_TYPE_INDEX, 0);
    is_resized_ = false;
    rtcUpdateGeometryBuffer(geometry_.get(), RTC_BUFFER_TYPE_VERTEX, 0);
    rtcCommitGeometry(geometry_.get());
}

}  // namespace zoe
