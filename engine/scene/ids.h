#pragma once

#include <cstdint>

namespace zoe {

enum class NodeId : uint32_t {};
enum class MeshId : uint32_t {};
enum class SkinId : uint32_t {};
enum class MaterialId : uint32_t {};
enum class ImageId : uint32_t {};
enum class CameraId : uint32_t {};
enum class LightId : uint32_t {};
enum class ClipId : uint32_t {};

/// "None", of any id type: `id == kNone<NodeId>`.
template <typename Id>
inline constexpr Id kNone = Id{0xffffffffu};

/// The position of an id in its array.
template <typename Id>
constexpr uint32_t index(Id id) {
    return static_cast<uint32_t>(id);
}

}  // namespace zoe
