#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>

#include "engine/scene/scene.h"

namespace zoe {

struct ObjOptions {
    /// The polygons are the cage of a Catmull-Clark surface at this level; none: they are shown as they are, split from
    /// their first corners.
    std::optional<int> subdivision_level = std::nullopt;
    uint64_t max_corners = uint64_t{1} << 27;    ///< Of all polygons together; a file with more is refused.
    uint64_t max_triangles = uint64_t{1} << 22;  ///< Of the surface; a level that makes more is refused. About 2 GB.
    size_t max_line_bytes = size_t{1} << 26;     ///< Of a line with all that it goes on in; a longer one is refused.
};

/// Reads a Wavefront .obj file: v, vt, vn and f with indices from 1, or from the end where they are negative. One mesh, one
/// node. Materials, groups and smoothing are not read; curves, lines and points are not shown: a warning each, with its
/// count.
/// Throws     SceneError `file: line N: reason` for what is broken.
Scene load_obj(const std::filesystem::path& file, const ObjOptions& options = {});

}  // namespace zoe
