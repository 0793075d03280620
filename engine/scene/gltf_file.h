#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <tiny_gltf.h>

#include "engine/scene/gltf.h"

namespace zoe {

/// A range of a buffer, inside it: open_gltf has checked that.
struct GltfView {
    uint32_t buffer = 0;
    uint64_t offset = 0, length = 0;
    uint64_t stride = 0;  ///< 0: tightly packed.
};

/// The beginning of a content: buffers that name the same file share its bytes.
struct GltfBuffer {
    size_t content = 0;
    uint64_t length = 0;
};

struct GltfImage {
    std::string name, uri;
    int view = -1;  ///< Else the URI.
};

/// A glTF file in memory: its JSON as tinygltf's structs, every index in them valid; its buffers as bytes.
struct GltfFile {
    std::string name;                              ///< As it was asked for; begins every message.
    std::filesystem::path folder;                  ///< Nothing outside it is read.
    tinygltf::Model model;                         ///< Without buffers, views and images: those are below.
    std::vector<std::vector<std::byte>> contents;  ///< What buffers consist of, each file once.
    std::vector<GltfBuffer> buffers;
    std::vector<GltfView> views;
    std::vector<GltfImage> images;
    uint64_t byte_count = 0;    ///< Of the file and the contents.
    uint64_t numbers_left = 0;  ///< How many more numbers accessors may yield: what the file's bytes can back.

    std::span<const std::byte> buffer(size_t i) const {
        return std::span(contents[buffers[i].content]).first(buffers[i].length);
    }

    /// Counts numbers that are about to be made against what the file's bytes can back.
    /// Throws     SceneError where there are too many: a small file must not fill the memory.
    void spend(uint64_t numbers, const std::string& place) {
        if (numbers > numbers_left) fail(place, "far more data than the file holds bytes");
        numbers_left -= numbers;
    }

    [[noreturn]] void fail(const std::string& place, const std::string& reason) const {
        throw SceneError(name, place, reason);
    }
};

/// Reads the file and its buffers, and checks its JSON.
/// scene      gets the warnings.
/// Throws     SceneError.
GltfFile open_gltf(const std::filesystem::path& path, const GltfOptions& options, Scene& scene);

}  // namespace zoe
