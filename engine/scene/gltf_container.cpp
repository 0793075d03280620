#include "engine/scene/gltf_container.h"

#include <cctype>
#include <cstring>
#include <filesystem>
#include <optional>

#include <fmt/format.h>

namespace zoe {
namespace {

constexpr uint32_t kMagic = 0x46546C67, kJsonChunk = 0x4E4F534A, kBinChunk = 0x004E4942;
constexpr int kMaxNesting = 256;

uint32_t read_u32(std::span<const std::byte> bytes, size_t offset) {
    uint32_t value = 0;
    for (size_t i = 0; i < 4; ++i) value |= std::to_integer<uint32_t>(bytes[offset + i]) << (8 * i);
    return value;
}

GltfContainer split_glb(std::span<const std::byte> bytes, const std::string& file, Scene& scene) {
    if (bytes.size() < 12) throw SceneError(file, "", "truncated: the GLB header has 12 bytes");
    const uint32_t version = read_u32(bytes, 4), length = read_u32(bytes, 8);
    if (version != 2) throw SceneError(file, "", fmt::format("GLB version {}; only version 2 is read", version));
    if (length > bytes.size()) {
        throw SceneError(file, "", fmt::format("truncated: {} bytes of the {} that its header names", bytes.size(), length));
    }
    if (length < bytes.size()) scene.warn("bytes after the end of the GLB: ignored");
    bytes = bytes.first(length);

    GltfContainer container;
    bool has_binary = false;
    size_t offset = 12;
    for (int chunk = 0; offset < bytes.size(); ++chunk) {
        if (bytes.size() - offset < 8) throw SceneError(file, "", fmt::format("the header of chunk {} is truncated", chunk));
        const size_t size = read_u32(bytes, offset);
        const uint32_t type = read_u32(bytes, offset + 4);
        offset += 8;
        if (size > bytes.size() - offset) {
            const size_t left = bytes.size() - offset;
            throw SceneError(file, "", fmt::format("chunk {} has {} bytes, but only {} are left", chunk, size, left));
        }
        const std::span<const std::byte> data = bytes.subspan(offset, size);
        offset += size;
        if (size % 4 != 0) scene.warn("a GLB chunk's length is not a multiple of 4");
        if ((chunk == 0) != (type == kJsonChunk)) {
            throw SceneError(file, "", "a GLB must hold one JSON chunk, and that first");
        }
        if (type == kJsonChunk) {
            container.json = {reinterpret_cast<const char*>(data.data()), data.size()};
        } else if (type == kBinChunk && chunk == 1) {
            container.binary = data;
            has_binary = true;
        } else if (type == kBinChunk) {
            throw SceneError(file, "", has_binary ? "a GLB with two BIN chunks" : "a GLB's BIN chunk must be its second");
        } else {
            scene.warn("a GLB chunk of an unknown type: ignored");
        }
    }
    if (container.json.empty()) throw SceneError(file, "", "a GLB without JSON");
    return container;
}

}  // namespace

GltfContainer split_gltf(std::span<const std::byte> bytes, const std::string& file, Scene& scene) {
    if (bytes.empty()) throw SceneError(file, "", "the file is empty");
    if (bytes.size() >= 4 && read_u32(bytes, 0) == kMagic) return split_glb(bytes, file, scene);
    if (std::filesystem::path(file).extension() == ".glb") {
        throw SceneError(file, "", "not a GLB file: it does not begin with 'glTF'");
    }
    return {{reinterpret_cast<const char*>(bytes.data()), bytes.size()}, {}};
}

void check_nesting(std::string_view json, const std::string& file) {
    int depth = 0;
    bool in_string = false;
    for (size_t i = 0; i < json.size(); ++i) {
        const char c = json[i];
        if (in_string) {
            if (c == '\\') ++i;
            if (c == '"') in_string = false;
        } else if (c == '"') {
            in_string = true;
        } else if (c == '[' || c == '{') {
            if (++depth > kMaxNesting) {
                throw SceneError(file, "", fmt::format("its JSON is nested deeper than {} levels", kMaxNesting));
            }
        } else if (c == ']' || c == '}') {
            --depth;
        }
    }
}

}  // namespace zoe
