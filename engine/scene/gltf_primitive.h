#pragma once

#include <bitset>
#include <map>
#include <string>
#include <vector>

#include "engine/scene/gltf_accessor.h"
#include "engine/scene/gltf_file.h"

namespace zoe {

using UvSets = std::bitset<kMaxUvSets>;

/// Reads a primitive's triangles: its indices, or 0, 1, 2, ... without; strips and fans unrolled.
/// Returns    [triangle_count] indices into its vertices, each below their number; none (and a warning) for points and
/// lines.
std::vector<glm::uvec3> read_corners(GltfFile& file, const tinygltf::Primitive& primitive, uint64_t vertex_count,
                                     const std::string& place, Scene& scene);

/// Appends a primitive's vertices to the mesh: every attribute, joints and weights, and the morph targets' offsets. Arrays
/// that the mesh has and the primitive has not, or the other way round, are filled with what glTF takes for missing ones.
/// range      which vertices.
/// uv_sets    which sets of texture coordinates are kept.
void append_vertices(GltfFile& file, const tinygltf::Primitive& primitive, GltfRange range, const UvSets& uv_sets,
                     const std::string& place, Mesh& mesh, Scene& scene);

}  // namespace zoe
