#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/scene/gltf_file.h"

namespace zoe {

/// Elements [begin, end) of an accessor.
struct GltfRange {
    uint64_t begin = 0, end = 0;
};

inline GltfRange whole(const GltfFile& file, int accessor) {
    return {0, file.model.accessors[static_cast<size_t>(accessor)].count};
}

/// How many numbers an element has (a matrix: all of its columns).
uint32_t component_count(const GltfFile& file, int accessor);

/// Tells whether the components are floats.
bool is_float(const GltfFile& file, int accessor);

/// Refuses an accessor whose elements have another shape.
/// types      tinygltf's TINYGLTF_TYPE_*, any of them.
/// place      who uses it: begins the message.
void require_type(const GltfFile& file, int accessor, std::initializer_list<int> types, const std::string& place);

/// Reads elements as floats, whatever their component type; normalised integers as glTF maps them. Follows strides and
/// sparse values; without a bufferView the base is zeros.
/// normalize  integers count as normalised even where the file does not say so.
/// Returns    [(end - begin) * component_count]
/// Throws     SceneError where bytes are out of range, types are unknown, or more is asked for than the file can back.
std::vector<float> read_floats(GltfFile& file, int accessor, GltfRange range, bool normalize = false);

/// Reads elements as unsigned integers.
/// Throws     as above; also where the components are not unsigned integers.
std::vector<uint32_t> read_uints(GltfFile& file, int accessor, GltfRange range);

}  // namespace zoe
