#pragma once

#include <string>

#include "engine/scene/gltf.h"

namespace zoe {

/// Tells whether a name is a pattern: it holds one printf integer field such as %d or %04d.
bool is_sequence_pattern(const std::string& pattern);

/// Reads a mesh a frame: all files that match `wave_%04d.glb`, in the order of their numbers, without gaps.
/// Each file's shown meshes become one mesh in world space (its own animations do not play). One node shows them in turn.
/// options    of each file; limits, too.
/// Throws     SceneError where no file matches, a number is missing, or a file cannot be read.
Scene load_sequence(const std::string& pattern, double fps = 24.0, const GltfOptions& options = {});

}  // namespace zoe
