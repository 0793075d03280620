#pragma once

#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "engine/deform/sample.h"
#include "engine/math/affine.h"
#include "engine/scene/mesh.h"
#include "engine/scene/scene.h"

namespace zoe {

/// Writes a glTF 2.0 binary file: nodes, meshes, one clip. Deterministic: the same calls give the same bytes.
/// Every method returns the index of what it added. Materials of meshes are the indices that `material` returned.
class GlbWriter {
public:
    GlbWriter();

    /// color      linear. more: merged into the material's JSON.
    MaterialId material(const std::string& name, const glm::vec3& color, const nlohmann::json& more = {});
    /// png        an encoded picture; it repeats.
    int texture(const std::string& name, std::span<const uint8_t> png);

    /// Normals in 8 bits, colours in 16, joints in 8, weights in 16, positions and morph targets in 32-bit floats.
    /// cube       null, or the cube (corner and edge length) over which positions are kept in 16 bits instead: a node that
    ///            shows the mesh must be placed by it.
    int mesh(const std::string& name, const Mesh& mesh, const Trs* cube = nullptr);

    int node(const std::string& name, int parent, const Trs& local = {}, int mesh = -1, const nlohmann::json& more = {});
    int node(const std::string& name, int parent, const glm::vec3& translation, int mesh = -1);
    int skin(const std::string& name, std::span<const int> joints, std::span<const Affine> joint_from_mesh);

    /// One channel of the clip. values: as in Sampler; path: "translation", "rotation", "scale" or "weights".
    void animate(int node, const std::string& path, const Sampler& sampler);
    /// Turns a node about an axis: `turns` whole turns over the clip, which starts at `degrees`.
    void spin(int node, const glm::vec3& axis, int turns, float degrees = 0.0f);

    nlohmann::json& document() { return json_; }
    /// Throws     std::runtime_error where the file cannot be written.
    void write(const std::filesystem::path& file);

    static constexpr float kDuration_s = 4.0f;

private:
    int view(std::span<const uint8_t> bytes, int stride, int target);
    int accessor(int view, size_t count, int component_type, const char* type, bool is_normalized);
    int floats(std::span<const float> values, const char* type, bool has_bounds, int target);
    template <typename T>
    int packed(std::span<const T> values, size_t width, int component_type, const char* type, bool is_normalized);

    nlohmann::json json_;
    std::vector<uint8_t> bin_;
    std::map<std::vector<float>, int> times_;
};

}  // namespace zoe
