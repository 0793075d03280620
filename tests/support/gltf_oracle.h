#pragma once

#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

#include "tests/support/gltf_animation.h"
#include "tests/support/gltf_document.h"

namespace zoe::test {

/// A triangle where a frame has it.
struct WorldTriangle {
    glm::dvec3 a, b, c;
    uint32_t node;       ///< glTF node; instances are numbered after all nodes of the file, in order of node and instance.
    uint32_t primitive;  ///< Counts triangles across the primitives of the node's mesh.
    /// How large the numbers are that a corner is computed from: the lengths of all the offsets on the way from the root
    /// to it, added up. Rounding errors are relative to this, not to the coordinates that come out.
    double magnitude = 0.0;
};

/// Every triangle of the document's default scene at a time, in double precision.
/// time_s     each clip loops by its own duration unless told otherwise.
std::vector<WorldTriangle> world_triangles(const Document& document, double time_s, const OraclePlayback& playback = {});

}  // namespace zoe::test
