#pragma once

#include <cstdint>

#include <glm/vec3.hpp>

namespace zoe::test {

/// A triangle where a frame has it.
struct WorldTriangle {
    glm::dvec3 a, b, c;
    uint32_t node;       ///< Node that shows it: of the file, or of the scene where triangles come from an engine's frame.
    uint32_t primitive;  ///< Counts triangles across the primitives of the node's mesh.
    /// How large the numbers are that a corner is computed from: the lengths of all the offsets on the way from the root
    /// to it, added up. Rounding errors are relative to this, not to the coordinates that come out.
    double magnitude = 0.0;
};

}  // namespace zoe::test
