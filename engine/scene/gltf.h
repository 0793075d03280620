#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "engine/scene/scene.h"

namespace zoe {

struct GltfOptions {
    std::optional<int> scene = std::nullopt;  ///< Which of the file's scenes; else the file's default, else the first.
    bool load_images = true;                  ///< False: Scene::images keeps names only.
    /// Of all images together, 4 bytes each, and a third more for their coarser levels; a pixel of an EXR or HDR picture, of
    /// 8 bytes, counts twice. Where they have more, the largest are halved, again and again, with a warning.
    /// That holds while they are read, too, beside what decoding one takes (decode_image.h), and its file.
    uint64_t max_pixels = uint64_t{1} << 28;
    /// Of all nodes' subdivision surfaces at their levels; a file with more is refused. About 2 GB.
    uint64_t max_triangles = uint64_t{1} << 22;
    /// Numbers that a file's accessors may yield beyond 16 for each of its bytes: zeros that no bytes back, and what many
    /// primitives share. A file with more is refused: a small one must not fill the memory.
    uint64_t max_free_numbers = uint64_t{1} << 22;
};

/// Reads a .gltf or .glb file: nodes, meshes, skins, morph targets, clips, cameras, lights, materials.
/// file       its references are followed only inside its own folder.
/// Throws     SceneError `file: JSON pointer: reason` for what is broken, hostile, or required and not supported.
///            What exporters commonly get slightly wrong loads with a warning in Scene::warnings.
Scene load_gltf(const std::filesystem::path& file, const GltfOptions& options = {});

}  // namespace zoe
