#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "tests/support/affine_double.h"

namespace zoe::test {

/// One glTF primitive, every accessor read to double.
struct DocumentPrimitive {
    std::vector<glm::dvec3> positions;             ///< [vertex_count]
    std::vector<std::vector<glm::dvec3>> targets;  ///< [target_count][vertex_count], or an empty inner array.
    std::vector<std::array<uint32_t, 3>> corners;  ///< Triangles; none for points and lines.
    uint32_t influence_count = 0;                  ///< 0, 4, 8, ...: JOINTS_n and WEIGHTS_n side by side.
    std::vector<uint32_t> joints;                  ///< [vertex_count * influence_count]
    std::vector<double> weights;                   ///< [vertex_count * influence_count] as in the file.
};

struct DocumentMesh {
    std::vector<DocumentPrimitive> primitives;
    std::vector<double> weights;
};

struct DocumentNode {
    int parent = -1, mesh = -1, skin = -1;
    std::optional<AffineDouble> matrix;
    glm::dvec3 translation{0.0}, scale{1.0};
    Quaternion rotation;
    std::vector<double> weights;
    std::vector<AffineDouble> instances;  ///< EXT_mesh_gpu_instancing.
    bool has_instances = false;
    bool is_shown = false;  ///< Part of the default scene.
};

struct DocumentSkin {
    std::vector<int> joints;
    std::vector<AffineDouble> inverse_bind;  ///< [joint_count]
};

/// A channel with its sampler: `values` holds `width` numbers a key, three times that for "CUBICSPLINE".
struct DocumentChannel {
    int node = -1;
    std::string path, interpolation;
    uint32_t width = 0;
    std::vector<double> times_s, values;
};

struct DocumentClip {
    std::string name;
    std::vector<DocumentChannel> channels;
    double duration_s = 0.0;  ///< The last key time over all channels.
};

/// A glTF file as plain arrays.
struct Document {
    std::vector<DocumentNode> nodes;
    std::vector<DocumentMesh> meshes;
    std::vector<DocumentSkin> skins;
    std::vector<DocumentClip> clips;
};

/// Reads a valid .gltf or .glb file, with no code of the engine's or of tinygltf.
/// Throws     std::runtime_error (or what nlohmann::json throws) for what it does not understand.
Document read_document(const std::filesystem::path& file);

}  // namespace zoe::test
