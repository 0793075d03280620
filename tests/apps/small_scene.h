#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "tests/support/temp_folder.h"

namespace zoe::test {

/// Two triangles, one of them turned by the clip "turn" (one second, half a turn about Y), the other at rest; a camera
/// "front". Its buffer is the file scene.bin. To be changed before it is written.
nlohmann::json small_scene();

/// The bytes of scene.bin.
/// first_x    The x of the first corner: NaN makes a broken vertex.
std::string small_buffer(float first_x = -1.0f);

/// Writes scene.gltf and scene.bin.
void write_small_scene(const TempFolder& folder, const nlohmann::json& json = small_scene());

/// The same as one .glb file.
std::string small_glb();

}  // namespace zoe::test
