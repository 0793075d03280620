#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

#include <glm/vec3.hpp>
#include <nlohmann/json_fwd.hpp>

namespace zoe::test {

/// What an accessor holds, as doubles: elements of `width` numbers.
struct AccessorArray {
    uint32_t width = 0;
    std::vector<double> values;  ///< [count * width]

    size_t count() const { return values.size() / width; }
    glm::dvec3 vec3(size_t i) const { return {values[3 * i], values[3 * i + 1], values[3 * i + 2]}; }
};

/// The accessors of one glTF file: every component type, normalised, strided, sparse, without a bufferView.
class GltfAccessors {
public:
    /// root       outlives this object.
    /// folder     where relative URIs of buffers start.
    /// binary     a .glb file's binary chunk.
    GltfAccessors(const nlohmann::json& root, const std::filesystem::path& folder, std::vector<uint8_t> binary);

    /// Throws     std::runtime_error (or what nlohmann::json throws) where it leaves its buffer or is not understood.
    AccessorArray read(int index) const;

private:
    /// place      anything with a bufferView and perhaps a byteOffset: an accessor, or half of a sparse one.
    void read_elements(const nlohmann::json& place, int type, bool is_normalised, size_t count, uint32_t width,
                       double* out) const;

    const nlohmann::json& root_;
    std::vector<std::vector<uint8_t>> buffers_;
};

}  // namespace zoe::test
