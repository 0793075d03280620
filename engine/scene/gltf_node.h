#pragma once

#include "engine/scene/gltf.h"
#include "engine/scene/gltf_file.h"

namespace zoe {

/// Reads the nodes, and which of them the chosen scene shows.
/// scene      its meshes and skins must have been read.
/// Throws     SceneError, also for cycles and for nodes with two parents.
void read_nodes(const GltfFile& file, const GltfOptions& options, Scene& scene);

/// Gives animated nodes that have a matrix a translation, a rotation and a scale instead.
void decompose_animated(Scene& scene);

/// EXT_mesh_gpu_instancing: adds a child node for each instance, which shows the mesh in place of its parent.
/// scene      its nodes and clips must have been read.
void add_instances(GltfFile& file, Scene& scene);

/// Counts the vertices that the nodes show of meshes whose positions no bufferView holds: they are not the file's bytes.
/// scene      its instances must have been added.
/// Throws     SceneError where there are too many.
void check_zeros_shown(GltfFile& file, const Scene& scene);

}  // namespace zoe
