#pragma once

#include <cstddef>

#include <glm/vec3.hpp>

#include "engine/deform/stencils.h"

namespace zoe {

/// Four floats, of which the last one means nothing: vectors read whole points, and none across two cache lines.
struct alignas(16) PaddedPoint {
    float x, y, z, unused;
};

/// What `evaluate` is asked for, in plain pointers.
struct StencilWork {
    const StencilTable* stencils = nullptr;
    const PaddedPoint* cage = nullptr;
    glm::vec3* positions = nullptr;
    glm::vec3* normals = nullptr;  ///< Null: none are wanted.
};

/// Vertices [begin, end), with the best instruction set that the processor has.
/// Source     see `evaluate`.
void sum_stencils(const StencilWork& work, size_t begin, size_t end);

}  // namespace zoe
