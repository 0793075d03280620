#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace zoe::test {

/// The two parts of a glTF file: its JSON text and, in a .glb, its binary chunk.
struct GltfContainer {
    std::string json;
    std::vector<uint8_t> binary;
};

/// Takes a .gltf or .glb file apart; which of the two is told by its first bytes.
/// Throws     std::runtime_error where the file cannot be read or its chunks do not fit.
GltfContainer read_container(const std::filesystem::path& file);

/// Follows a buffer's URI: base64 data, or a percent-encoded path relative to `folder`.
/// Throws     std::runtime_error where it leads nowhere.
std::vector<uint8_t> read_uri(const std::filesystem::path& folder, const std::string& uri);

}  // namespace zoe::test
