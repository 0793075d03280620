#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "engine/deform/morph.h"
#include "engine/deform/skin.h"
#include "engine/scene/ids.h"

namespace zoe {

/// Triangles [begin, end) of a mesh show this material: one range a glTF primitive, in order, without gaps.
struct MaterialRange {
    uint32_t begin = 0, end = 0;
    MaterialId material = kNone<MaterialId>;  ///< None: glTF's default material.
};

/// An indexed triangle mesh in its bind pose, local space, metres. All of a glTF mesh's primitives, one after another.
struct Mesh {
    std::string name;
    std::vector<glm::vec3> positions;  ///< [vertex_count]
    std::vector<glm::vec3> normals;    ///< [vertex_count] or empty; a zero normal asks for the geometric one.
    std::vector<glm::vec2> uvs[2];     ///< TEXCOORD_0, TEXCOORD_1: [vertex_count] or empty.
    std::vector<glm::vec4> colors;     ///< COLOR_0, linear: [vertex_count] or empty.
    std::vector<glm::uvec3> corners;   ///< [triangle_count] indices into positions.
    std::vector<MaterialRange> materials;
    std::vector<MorphTarget> targets;
    std::vector<float> default_weights;  ///< [target_count]
    SkinBinding binding;
    uint64_t version = 0;  ///< Counts what `Scene::write_mesh` did; above 0: written by the user.
};

}  // namespace zoe
