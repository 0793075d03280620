#pragma once

#include "engine/scene/gltf_file.h"

namespace zoe {

/// Reads a glTF mesh: its primitives one after another, strips and fans as triangles. Primitives that share all their
/// vertex data share vertices; vertices before the first and after the last that a triangle uses are left out.
/// scene      gets the warnings.
/// Throws     SceneError.
Mesh read_mesh(GltfFile& file, size_t mesh_index, Scene& scene);

}  // namespace zoe
