#pragma once

#include "engine/scene/gltf.h"
#include "engine/scene/gltf_file.h"

namespace zoe {

/// Reads materials, textures and what they need of the samplers.
/// Throws     SceneError.
std::vector<Material> read_materials(const GltfFile& file, Scene& scene);

/// Reads the images that the scene's materials show; the others keep their names only. One that is missing or broken is a
/// warning, and so is one for which no pixels are left. What several images name is decoded once, and copied.
std::vector<Image> read_images(const GltfFile& file, const GltfOptions& options, Scene& scene);

}  // namespace zoe
