#pragma once

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "engine/scene/gltf.h"
#include "tests/support/temp_folder.h"

namespace zoe::test {

void write_file(const std::filesystem::path& file, const std::string& bytes);

/// A glTF file under construction: its JSON, open to every change, and one buffer.
struct GlbBuilder {
    nlohmann::json json = {{"asset", {{"version", "2.0"}}}};
    std::string binary;

    /// Appends bytes as a bufferView (aligned to 4) and returns its index.
    int view(const void* data, size_t size, int stride = 0);
    /// Appends a tightly packed accessor.
    template <typename T>
    int accessor(const std::vector<T>& values, int component_type, const char* type, size_t count,
                 bool is_normalized = false) {
        return accessor_of(view(values.data(), values.size() * sizeof(T)), component_type, type, count, is_normalized);
    }
    int accessor_of(int view, int component_type, const char* type, size_t count, bool is_normalized = false);
    int floats(const std::vector<float>& values, const char* type);

    /// Appends to an array of the root and returns the position.
    int push(const char* array, nlohmann::json value);
    /// A mesh of one primitive.
    int mesh(nlohmann::json primitive) { return push("meshes", {{"primitives", {std::move(primitive)}}}); }
    /// A triangle (0,0,0) (1,0,0) (0,1,0) without indices, and a node that shows it.
    int triangle();

    std::string glb() const;
    /// Writes a .glb into a folder of its own and loads it.
    Scene load(const GltfOptions& options = {}) const;
    /// The message of the SceneError that loading throws; empty where it loads.
    std::string error() const;
};

inline constexpr int kByte = 5120, kUbyte = 5121, kShort = 5122, kUshort = 5123, kUint = 5125, kFloat = 5126;

/// A small file with everything in it: skin, morph targets, sparse values, clips, material, image, camera, light.
GlbBuilder make_rich_glb();

/// The message with which loading fails; empty where it loads.
std::string load_error(const std::filesystem::path& file);

}  // namespace zoe::test
