#pragma once

#include <array>
#include <cstddef>

namespace zoe {

/// Rays of a frame by what they are for: from the camera, one bounce off what those hit, and from both towards a light.
/// The first two ask for the closest hit, shadow rays for any.
enum class RayKind : unsigned char { kPrimary, kDiffuse, kShadow };
inline constexpr std::array kRayKinds = {RayKind::kPrimary, RayKind::kDiffuse, RayKind::kShadow};
inline constexpr size_t kRayKindCount = kRayKinds.size();

/// Rays that a task of a parallel trace takes at once, the engine's and the peer's alike.
inline constexpr size_t kRaysATask = 4096;

constexpr const char* name(RayKind kind) {
    constexpr std::array names = {"primary", "diffuse", "shadow"};
    return names[static_cast<size_t>(kind)];
}

}  // namespace zoe
