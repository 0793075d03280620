#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace zoe::test {

/// The folder with the shared real models: $ZOETROPE_ASSETS, else ../shared/assets as seen from the sources.
/// source_folder   the project's top folder (ZOETROPE_SOURCE_DIR).
/// Returns    nothing where there is none: such tests are skipped.
std::optional<std::filesystem::path> assets_folder(const std::filesystem::path& source_folder);

/// Every .gltf and .glb file below a folder, as paths relative to it, sorted.
std::vector<std::string> gltf_files(const std::filesystem::path& folder);

/// What a skipped test says.
inline constexpr const char* kNoAssets = "no ../shared/assets here; set ZOETROPE_ASSETS to run this test";

}  // namespace zoe::test
