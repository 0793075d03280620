#pragma once

#include "engine/scene/gltf_file.h"

namespace zoe {

/// Reads the cameras.
/// Throws     SceneError.
std::vector<Camera> read_cameras(const GltfFile& file, Scene& scene);

/// Reads the lights of KHR_lights_punctual.
/// Throws     SceneError.
std::vector<Light> read_lights(const GltfFile& file, Scene& scene);

}  // namespace zoe
