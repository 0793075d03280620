#pragma once

#include <vector>

#include "tests/support/gltf_animation.h"
#include "tests/support/gltf_document.h"
#include "tests/support/world_triangle.h"

namespace zoe::test {

/// Every triangle of the document's default scene at a time, in double precision.
/// Nodes are those of the file; instances are numbered after all of them, in order of node and instance.
/// time_s     each clip loops by its own duration unless told otherwise.
std::vector<WorldTriangle> world_triangles(const Document& document, double time_s, const OraclePlayback& playback = {});

}  // namespace zoe::test
