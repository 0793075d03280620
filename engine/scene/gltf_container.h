#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "engine/scene/scene.h"

namespace zoe {

/// The parts of a .gltf or .glb file, inside its bytes.
struct GltfContainer {
    std::string_view json;
    std::span<const std::byte> binary;  ///< The BIN chunk; empty where there is none.
};

/// Tells a GLB by its first bytes, checks its chunks and finds its parts.
/// Throws     SceneError for a file that is neither GLB nor could be JSON, or whose lengths lie.
GltfContainer split_gltf(std::span<const std::byte> bytes, const std::string& file, Scene& scene);

/// Checks that the JSON's brackets are nested no deeper than its readers' stacks allow.
/// Throws     SceneError.
void check_nesting(std::string_view json, const std::string& file);

}  // namespace zoe
