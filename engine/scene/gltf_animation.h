#pragma once

#include "engine/scene/gltf_file.h"

namespace zoe {

/// Reads the animations.
/// scene      its nodes and meshes must have been read; gets the warnings.
/// Throws     SceneError.
std::vector<Clip> read_clips(GltfFile& file, Scene& scene);

}  // namespace zoe
