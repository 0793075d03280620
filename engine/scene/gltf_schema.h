#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "engine/scene/scene.h"

namespace zoe {

/// Checks the JSON of a glTF file against the part of the schema that is read: types, required members, lengths, ranges of
/// numbers, and that every index names something. Members that are not read are removed, and whole numbers written as
/// 2.0 become integers, because tinygltf drops what it does not expect without a word.
/// scene      gets a warning for each extension that is not supported.
/// Throws     SceneError with the JSON pointer of the first thing that is wrong.
void check_schema(nlohmann::json& root, const std::string& file, Scene& scene);

/// Tells whether a scene comes out right with this extension.
bool is_supported_extension(const std::string& name);

}  // namespace zoe
