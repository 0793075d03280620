#pragma once

#include <cstdint>
#include <vector>

#include "engine/scene/mesh.h"

namespace zoe {

/// Vertices that are the same in everything that moves them, to the last bit: position, morph offsets, joints, weights.
struct Welding {
    std::vector<uint32_t> vertex_of;  ///< [vertex_count of the mesh] the welded vertex that each is.
    std::vector<uint32_t> first;      ///< [welded vertices] the first vertex of the mesh that is it; ascending.
};

Welding weld(const Mesh& mesh);

/// Keeps one vertex of each that are the same, with its position, morph offsets, joints and weights; drops normals,
/// tangents, texture coordinates and colours. Triangles stay as they are: they name the vertices that were.
void keep_welded(const Welding& welding, Mesh* mesh);

/// What texture coordinates become when vertices do not hold them any more: those of the same welded vertex and the same
/// value are one.
/// corners    vertices of the mesh, one a corner.
CageUvs weld_uvs(const Welding& welding, const std::vector<glm::vec2>& uvs, const std::vector<uint32_t>& corners);

}  // namespace zoe
