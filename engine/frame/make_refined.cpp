#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <numeric>

#include "engine/frame/refine.h"

namespace zoe {

namespace {

// The order of vertices by their positions: whatever a file numbers them, and whatever else it holds.
std::vector<uint32_t> rank_by_position(std::span<const glm::vec3> positions) {
    const auto key = [&](uint32_t k) {
        const glm::vec3 p = positions[k] + 0.0f;  // 0 and -0 are the same place.
        return std::array{std::bit_cast<uint32_t>(p.x), std::bit_cast<uint32_t>(p.y), std::bit_cast<uint32_t>(p.z), k};
    };
    std::vector<uint32_t> order(positions.size()), rank(positions.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return key(a) < key(b); });
    for (uint32_t k = 0; k < order.size(); ++k) rank[order[k]] = k;
    return rank;
}

// A face of the cage has the material of its first triangle.
// cage_faces   [triangle_count] of the refined triangles, ascending.
std::vector<MaterialRange> refine_materials(const Mesh& mesh, std::span<const uint32_t> cage_faces) {
    assert(std::is_sorted(cage_faces.begin(), cage_faces.end()));
    std::vector<uint32_t> first_triangles{0};
    for (const uint32_t size : mesh.surface->cage.face_sizes) first_triangles.push_back(first_triangles.back() + size - 2);
    std::vector<MaterialRange> ranges;
    uint32_t begin = 0;
    for (const MaterialRange& range : mesh.materials) {
        const auto face = std::lower_bound(first_triangles.begin(), first_triangles.end(), range.end);
        const auto end = std::lower_bound(cage_faces.begin(), cage_faces.end(), face - first_triangles.begin());
        ranges.push_back({begin, static_cast<uint32_t>(end - cage_faces.begin()), range.material});
        begin = ranges.back().end;
    }
    return ranges;
}

}  // namespace

Refined make_refined(const Mesh& mesh, int level) {
    const SubdivisionSurface& surface = *mesh.surface;
    const std::vector<glm::vec3>& rest = surface.rest_positions.empty() ? mesh.positions : surface.rest_positions;
    SubdivisionOptions options = surface.options;
    options.level = level;
    Subdivision made = make_subdivision(surface.cage, rest.size(), options);
    sort_entries(&made.stencils, rank_by_position(rest));

    Refined refined;
    refined.mesh.name = mesh.name;
    refined.mesh.corners = std::move(made.corners);
    refined.mesh.materials = refine_materials(mesh, made.cage_faces);
    refined.mesh.uvs = std::move(made.uvs);
    refined.mesh.positions.resize(made.stencils.vertex_count());
    if (options.normals) refined.mesh.normals.resize(made.stencils.vertex_count());
    evaluate(made.stencils, rest, refined.mesh.positions, refined.mesh.normals);
    refined.stencils = std::move(made.stencils);
    return refined;
}

}  // namespace zoe
