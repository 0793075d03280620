#pragma once

#include "engine/bvh/blas.h"

namespace zoe {

/// Takes memory for later builds by kBinned over a mesh as large, in whatever pose: builds one of the mesh and a quarter of
/// it once more. Where a pose asks for more after all, it gets it.
/// Cost       a quarter more than a build.
void reserve_builds(std::span<const glm::vec3> positions, std::span<const glm::uvec3> corners, BlasScratch* scratch);

/// The same for the trees that such builds put in the place of one that is there.
void reserve_builds(Blas* blas);

}  // namespace zoe
