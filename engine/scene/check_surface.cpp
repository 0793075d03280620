#include "engine/scene/check_surface.h"

#include <cmath>

#include <fmt/format.h>

namespace zoe {

std::string check_surface(const Mesh& mesh) {
    const SubdivisionSurface& surface = *mesh.surface;
    if (!mesh.normals.empty() || has_uvs(mesh) || !mesh.colors.empty()) {
        return "it is the cage of a subdivision surface, and has normals, uvs or colours of its own";
    }
    if (!(surface.pixels >= 0.0f) || !std::isfinite(surface.pixels)) return "its surface's pixels are not a number from 0";
    if (surface.pixels > 0.0f && !surface.options.limit_positions) {
        return "its surface's level is to follow its distance from the limit, but limit_positions is off";
    }
    if (surface.max_level < 1 || surface.max_level > kMaxSubdivisionLevel) {
        return fmt::format("its surface's max_level is not 1 to {}", kMaxSubdivisionLevel);
    }
    if (!surface.rest_positions.empty() && surface.rest_positions.size() != mesh.positions.size()) {
        return "its surface's rest_positions are not as many as its vertices";
    }
    if (std::string broken = check(surface.cage, mesh.positions.size(), surface.options.level); !broken.empty()) {
        return broken;
    }
    if (mesh.corners != split_faces(surface.cage)) return "its triangles are not the faces of its surface's cage";
    return {};
}

std::string check_surface_size(const Scene& scene, uint64_t most) {
    uint64_t count = 0;
    for (const Node& node : scene.nodes) {
        if (!node.is_shown || node.mesh == kNone<MeshId> || !scene[node.mesh].surface) continue;
        const SubdivisionSurface& surface = *scene[node.mesh].surface;
        count += count_triangles(surface.cage, surface.options.level);  // Stencils bound it: no sum has more than 64 bits.
    }
    if (count <= most) return {};
    return fmt::format("the subdivision surfaces would have {} triangles at their levels; {} are allowed", count, most);
}

}  // namespace zoe
