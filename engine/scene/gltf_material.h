#pragma once

#include "engine/scene/gltf.h"
#include "engine/scene/gltf_file.h"

namespace zoe {

/// Reads materials, textures and what they need of the samplers.
/// Throws     SceneError.
std::vector<Material> read_materials(const GltfFile& file, Scene& scene);

/// Reads the images that the scene's materials show, with their coarser levels; the others keep their names only. One that
/// is missing or broken is a warning, and so is one that was halved to fit. What several images name is decoded once, and
/// copied. Never do images take more memory than the options say, but for the encoded bytes of one and what its decoder
/// holds (decode_image.h). An image that is shown both as a colour and as numbers is averaged as a colour.
std::vector<Image> read_images(const GltfFile& file, const GltfOptions& options, Scene& scene);

}  // namespace zoe
