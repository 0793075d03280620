#include "engine/render/surface.h"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include "engine/frame/frame.h"
#include "engine/render/direction.h"
#include "engine/render/texture.h"

namespace zoe {

namespace {

constexpr float kUnitRoundoff = 0x1p-24f;  // relative error of one float operation

glm::mat3 abs_of(const glm::mat3& m) {
    return {glm::abs(m[0]), glm::abs(m[1]), glm::abs(m[2])};
}

/// A hit triangle in both spaces, and what interpolation needs.
struct Corners {
    glm::uvec3 vertex;
    glm::vec3 a, b, c;       // local
    glm::vec3 weights;       // barycentric
    glm::vec3 error{0.0f};   // world, see Surface
    glm::vec3 normal{0.0f};  // world, unit, by winding; zero where the area vanishes in rounding
};

template <typename T>
T interpolate(const std::vector<T>& values, const Corners& corners) {
    return corners.weights.x * values[corners.vertex.x] + corners.weights.y * values[corners.vertex.y] +
           corners.weights.z * values[corners.vertex.z];
}

/// Bounds how far a computed point of the triangle may be from where a ray, transformed into local space by the inverse
/// and tested there, sees the triangle. Counted in roundings of the largest magnitudes of each step.
glm::vec3 bound_error(const Instance& instance, const Corners& corners, float aspect) {
    const glm::vec3 local = glm::max(glm::max(glm::abs(corners.a), glm::abs(corners.b)), glm::abs(corners.c));
    const float edge = std::max(largest(corners.b - corners.a), largest(corners.c - corners.a));
    // The triangle test works on corners relative to the origin; its heights are off by more on thin triangles.
    const glm::vec3 test(16.0f * aspect * edge);
    if (instance.is_identity) return kUnitRoundoff * (16.0f * local + test);
    const Affine& world_from_local = instance.world_from_local;
    const Affine& local_from_world = instance.local_from_world;
    const glm::mat3 stretch = abs_of(world_from_local.linear);
    const glm::vec3 world = stretch * local + glm::abs(world_from_local.translation);
    const glm::vec3 back = abs_of(local_from_world.linear) * world + glm::abs(local_from_world.translation);
    return kUnitRoundoff * (16.0f * world + stretch * (8.0f * back + test));
}

Corners corners_of(const Instance& instance, const Hit& hit) {
    Corners corners;
    corners.vertex = instance.mesh->corners[hit.primitive];
    corners.a = instance.positions[corners.vertex.x];
    corners.b = instance.positions[corners.vertex.y];
    corners.c = instance.positions[corners.vertex.z];

    // Edges in units of the longest, so that no product of them under- or overflows.
    glm::vec3 ab = instance.world_from_local.vector(corners.b - corners.a);
    glm::vec3 ac = instance.world_from_local.vector(corners.c - corners.a);
    const float size = std::max(largest(ab), largest(ac));
    ab /= size;
    ac /= size;
    const glm::vec3 cross = glm::cross(ab, ac);
    const float area = glm::length(cross);
    if (area > 0.0f) corners.normal = cross / area;
    const float aspect = std::min(1.0f / std::max(area, 1e-30f), 64.0f);
    corners.error = bound_error(instance, corners, std::max(aspect, 1.0f));

    // A point within rounding of an edge could come out beyond a wall that meets this one there: keep that far inside.
    const float inset = std::min(4.0f * largest(corners.error) / (size * std::max(area, 1e-30f)), 1.0f / 64.0f);
    const glm::vec3 weights = glm::max(glm::vec3(1.0f - hit.u - hit.v, hit.u, hit.v), inset);
    corners.weights = weights / (weights.x + weights.y + weights.z);
    return corners;
}

/// The material of a triangle. Ranges are in order and without gaps.
const Material* material_of(const Scene& scene, const Mesh& mesh, uint32_t primitive) {
    const auto after = std::upper_bound(mesh.materials.begin(), mesh.materials.end(), primitive,
                                        [](uint32_t p, const MaterialRange& range) { return p < range.end; });
    if (after == mesh.materials.end() || after->material == kNone<MaterialId>) return nullptr;
    return &scene.materials[index(after->material)];
}

glm::vec2 uv_of(const Mesh& mesh, const TextureRef& texture, const Corners& corners, size_t vertex_count) {
    const std::vector<glm::vec2>& uvs = mesh.uvs[texture.uv_set & 1];
    return uvs.size() == vertex_count ? interpolate(uvs, corners) : glm::vec2(0.0f);
}

/// Tells whether a ray sees the front. A mirror in the node's matrix turned the winding, in `corners` too, which are in the
/// world. That matrix counts even where the vertices were moved to another space when loaded, or follow a skin.
/// A triangle whose area vanishes in rounding has only a front.
bool is_front(const Scene& scene, NodeId node, const Corners& corners, const glm::vec3& direction) {
    // In double precision no product of three floats vanishes.
    const bool is_mirrored = glm::determinant(glm::dmat3(world_from_node(scene, node).linear)) < 0.0;
    const float along = glm::dot(corners.normal, direction);
    return is_mirrored ? along >= 0.0f : along <= 0.0f;
}

void set_normals(const Instance& instance, const Corners& corners, const glm::vec3& toward_viewer, Surface* surface) {
    surface->ng = corners.normal == glm::vec3(0.0f) ? unit_or(toward_viewer, glm::vec3(0, 0, 1)) : corners.normal;
    if (glm::dot(surface->ng, toward_viewer) < 0.0f) surface->ng = -surface->ng;
    surface->ns = surface->ng;
    if (instance.normals.size() != instance.positions.size()) return;
    const glm::vec3 local = corners.weights.x * instance.normals[corners.vertex.x] +
                            corners.weights.y * instance.normals[corners.vertex.y] +
                            corners.weights.z * instance.normals[corners.vertex.z];
    // Normals go by the inverse transpose, which keeps them perpendicular under shear and on their side under a mirror.
    const glm::vec3 world = glm::transpose(instance.local_from_world.linear) * local;
    surface->ns = unit_or(world, surface->ng);
    if (glm::dot(surface->ns, surface->ng) < 0.0f) surface->ns = -surface->ns;
}

}  // namespace

Surface surface_at(const Scene& scene, const Tlas& tlas, const Ray& ray, const Hit& hit) {
    const Instance& instance = tlas[hit.node];
    const Mesh& mesh = *instance.mesh;
    const Corners corners = corners_of(instance, hit);
    Surface surface;
    const glm::vec3 local = corners.weights.x * corners.a + corners.weights.y * corners.b + corners.weights.z * corners.c;
    surface.position = instance.is_identity ? local : instance.world_from_local.point(local);
    surface.error = corners.error;
    set_normals(instance, corners, -ray.direction, &surface);

    const size_t vertex_count = instance.positions.size();
    glm::vec4 color(1.0f);
    if (mesh.colors.size() == vertex_count) color = interpolate(mesh.colors, corners);
    const Material* const material = material_of(scene, mesh, hit.primitive);
    if (material != nullptr) {
        const TextureRef& texture = material->base_color_texture;
        color *= material->base_color * sample_texture(scene.images, texture, uv_of(mesh, texture, corners, vertex_count));
        surface.is_unlit = material->is_unlit;
        if (material->alpha_mode == AlphaMode::kMask) surface.opacity = color.a >= material->alpha_cutoff ? 1.0f : 0.0f;
        if (material->alpha_mode == AlphaMode::kBlend) surface.opacity = glm::clamp(color.a, 0.0f, 1.0f);
        if (material->emission != glm::vec3(0.0f)) {
            const TextureRef& glow = material->emission_texture;
            surface.emission =
                material->emission * glm::vec3(sample_texture(scene.images, glow, uv_of(mesh, glow, corners, vertex_count)));
        }
    }
    surface.light_opacity = surface.opacity;
    if (material == nullptr || !material->is_double_sided) {
        (is_front(scene, hit.node, corners, ray.direction) ? surface.light_opacity : surface.opacity) = 0.0f;
    }
    // More than 1 would make energy out of nothing at every bounce.
    surface.base_color = glm::clamp(glm::vec3(color), 0.0f, 1.0f);
    return surface;
}

glm::vec3 leave(const Surface& surface, const glm::vec3& direction) {
    const glm::vec3 outward = glm::dot(surface.ng, direction) < 0.0f ? -surface.ng : surface.ng;
    return surface.position + glm::dot(glm::abs(outward), surface.error) * outward;
}

}  // namespace zoe
