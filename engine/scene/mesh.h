#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "engine/deform/morph.h"
#include "engine/deform/skin.h"
#include "engine/deform/subdivide.h"
#include "engine/scene/ids.h"

namespace zoe {

/// Triangles [begin, end) of a mesh show this material: one range a glTF primitive, in order, without gaps.
struct MaterialRange {
    uint32_t begin = 0, end = 0;
    MaterialId material = kNone<MaterialId>;  ///< None: glTF's default material.
};

/// Makes a mesh the cage of a subdivision surface. The mesh's own arrays are the cage's: its skin, its morph targets and
/// `Scene::write_cage` move the cage, and what is shown follows. What is shown is the frame's: `tlas[node].mesh`.
struct SubdivisionSurface {
    Cage cage;  ///< Over the mesh's positions.
    SubdivisionOptions options;
    /// Above 0: each node that shows the mesh has the coarsest level whose triangles are at most so many pixels from the
    /// limit surface as the scene's viewpoint sees them; `options.level` where the scene has none.
    float pixels = 0.0f;
    int max_level = 5;  ///< The finest that `pixels` may choose; a warning where it would need a finer one.

    uint64_t version = 0;                   ///< Counts what `Scene::write_cage` did.
    std::vector<glm::vec3> rest_positions;  ///< The cage's before the first write; empty until then.
};

/// An indexed triangle mesh in its bind pose, local space, metres. All of a glTF mesh's primitives, one after another.
struct Mesh {
    std::string name;
    std::vector<glm::vec3> positions;  ///< [vertex_count]
    std::vector<glm::vec3> normals;    ///< [vertex_count] or empty; a zero normal asks for the geometric one.
    std::vector<glm::vec4> tangents;   ///< [vertex_count] or empty; see tangents.h. A zero one asks for its triangle's.
    std::vector<glm::uvec3> tangent_corners;  ///< [triangle_count] indices into tangents, then of any number; or empty.
    std::array<std::vector<glm::vec2>, kMaxUvSets> uvs;  ///< TEXCOORD_0, ...: each [vertex_count] or empty.
    std::vector<glm::vec4> colors;                       ///< COLOR_0, linear: [vertex_count] or empty.
    std::vector<glm::uvec3> corners;                     ///< [triangle_count] indices into positions.
    std::vector<MaterialRange> materials;
    std::vector<MorphTarget> targets;
    std::vector<float> default_weights;  ///< [target_count]
    SkinBinding binding;
    uint64_t version = 0;  ///< Counts what `Scene::write_mesh` did; above 0: written by the user.
    /// None: what is shown is the mesh itself. Else it has no normals, uvs or colours of its own, and its triangles are
    /// `split_faces(surface->cage)`.
    std::optional<SubdivisionSurface> surface;
};

/// Where the tangents of a triangle's corners stand.
inline const glm::uvec3& tangents_of(const Mesh& mesh, uint32_t triangle) {
    return mesh.tangent_corners.empty() ? mesh.corners[triangle] : mesh.tangent_corners[triangle];
}

inline bool has_uvs(const Mesh& mesh) {
    return std::any_of(mesh.uvs.begin(), mesh.uvs.end(), [](const auto& set) { return !set.empty(); });
}

/// A mesh that shows a subdivision surface.
/// positions  [vertex_count] of the cage.
Mesh make_surface(std::vector<glm::vec3> positions, SubdivisionSurface surface);

}  // namespace zoe
