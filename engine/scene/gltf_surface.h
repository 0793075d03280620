#pragma once

#include "engine/scene/gltf_file.h"

namespace zoe {

/// extras.subdivision of a glTF mesh: makes the mesh the cage of a subdivision surface. Does nothing where there is none.
/// Vertices that the file splits for the sake of normals and texture coordinates are one: those with the same position,
/// morph offsets, joints and weights, to the last bit. Faces are polygons where primitives use FB_ngon_encoding, else
/// triangles.
/// mesh       as `read_mesh` made it; loses normals and colours.
/// scene      gets the warnings.
/// Throws     SceneError where the cage is one that cannot be subdivided.
void read_surface(GltfFile& file, size_t mesh_index, Mesh& mesh, Scene& scene);

}  // namespace zoe
