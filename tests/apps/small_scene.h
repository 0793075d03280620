#pragma once

#include <set>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "engine/scene/image.h"
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

/// The demo's arguments for small pictures of scene.gltf.
/// more       follows them, and wins.
std::vector<std::string> small_pictures(const std::vector<std::string>& more);

/// The values of a channel; none where there is no such channel.
std::set<float> channel_values(const FloatImage& image, const std::string& name);

}  // namespace zoe::test
