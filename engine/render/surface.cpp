#include "engine/render/surface.h"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include "engine/frame/frame.h"
#include "engine/render/direction.h"
#include "engine/render/tangent_frame.h"
#include "engine/render/texture.h"

namespace zoe {

namespace {

constexpr float kUnitRoundoff = 0x1p-24f;  // relative error of one float operation
constexpr float kLeastCurved = 0.75f;      // cosine between the normals of a triangle and its corners, on a curve
constexpr float kLeastSlant = 0.05f;       // a cone that grazes a surface counts as no longer than this

glm::mat3 abs_of(const glm::mat3& m) {
    return {glm::abs(m[0]), glm::abs(m[1]), glm::abs(m[2])};
}

/// A hit triangle in both spaces, and what interpolation needs.
struct Corners {
    uint32_t triangle;
    glm::uvec3 vertex;
    glm::vec3 a, b, c;       // local
    glm::vec3 weights;       // barycentric
    glm::vec3 error{0.0f};   // world, see Surface
    glm::vec3 normal{0.0f};  // world, unit, by winding; zero where the area vanishes in rounding
    float area = 0.0f;       // world, twice the triangle's

    glm::vec3 point() const { return weights.x * a + weights.y * b + weights.z * c; }  // local
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
    corners.triangle = hit.primitive;
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
    corners.area = area * size * size;
    const float aspect = std::min(1.0f / std::max(area, 1e-30f), 64.0f);
    corners.error = bound_error(instance, corners, std::max(aspect, 1.0f));

    // A point within rounding of an edge could come out beyond a wall that meets this one there: keep that far inside.
    const float inset = std::min(4.0f * largest(corners.error) / (size * std::max(area, 1e-30f)), 1.0f / 64.0f);
    const glm::vec3 weights = glm::max(glm::vec3(1.0f - hit.u - hit.v, hit.u, hit.v), inset);
    corners.weights = weights / (weights.x + weights.y + weights.z);
    return corners;
}

/// The material of a triangle. Ranges are in order and without gaps.
MaterialId material_of(const Mesh& mesh, uint32_t primitive) {
    const auto after = std::upper_bound(mesh.materials.begin(), mesh.materials.end(), primitive,
                                        [](uint32_t p, const MaterialRange& range) { return p < range.end; });
    return after == mesh.materials.end() ? kNone<MaterialId> : after->material;
}

/// Tells whether a node's world matrix mirrors, which turns the winding, in `Corners` too, which are in the world. That
/// matrix counts even where the vertices were moved to another space when loaded, or follow a skin.
bool has_mirror(const Scene& scene, NodeId node) {
    // In double precision no product of three floats vanishes.
    return glm::determinant(glm::dmat3(world_from_node(scene, node).linear)) < 0.0;
}

/// Tells whether a ray sees the front. A triangle whose area vanishes in rounding has only a front.
bool is_front(bool is_mirrored, const Corners& corners, const glm::vec3& direction) {
    const float along = glm::dot(corners.normal, direction);
    return is_mirrored ? along >= 0.0f : along <= 0.0f;
}

/// Twice the area that an edge and another span.
float area_of(const glm::vec2& a, const glm::vec2& b) {
    return std::abs(a.x * b.y - b.x * a.y);
}

/// Looks textures up where a triangle was hit. Most materials have few: what a lookup needs is worked out by it.
class Lookup {
public:
    /// width      of the ray's cone on the surface, metres.
    Lookup(const Scene& scene, const Instance& instance, const Corners& corners, float width)
        : scene_(scene), instance_(instance), corners_(corners), width_(width) {}
    glm::vec4 color(const TextureRef& ref, bool is_sharp = false) const { return at(ref, Texels::kColors, is_sharp); }
    glm::vec4 light(const TextureRef& ref) const { return at(ref, Texels::kLight, false); }
    glm::vec4 numbers(const TextureRef& ref) const { return at(ref, Texels::kNumbers, false); }
    bool has(const TextureRef& ref) const { return has_pixels(scene_.images, ref); }

private:
    glm::vec4 at(const TextureRef& ref, Texels texels, bool is_sharp) const {
        if (ref.image == kNone<ImageId>) return glm::vec4(1.0f);
        const std::vector<glm::vec2>& uvs = instance_.mesh->uvs[ref.uv_set % kMaxUvSets];
        if (uvs.size() != instance_.positions.size())
            return sample_texture(scene_.images, ref, glm::vec2(0.0f), 0.0f, texels);
        float uv_width = 0.0f;
        if (!is_sharp && width_ > 0.0f && corners_.area > 0.0f) {
            const glm::uvec3& v = corners_.vertex;
            uv_width = width_ * std::sqrt(area_of(uvs[v.y] - uvs[v.x], uvs[v.z] - uvs[v.x]) / corners_.area);
        }
        return sample_texture(scene_.images, ref, interpolate(uvs, corners_), uv_width, texels);
    }
    const Scene& scene_;
    const Instance& instance_;
    const Corners& corners_;
    float width_;
};

/// A normal texture's normal in the world; on the side of the geometric normal `front`, at most as far over as the plane.
glm::vec3 bend(const Instance& instance, const Corners& corners, const Lookup& lookup, const TextureRef& ref, float scale,
               const glm::vec3& normal, const glm::vec3& front) {
    if (!lookup.has(ref)) return normal;
    const TangentFrame frame = tangent_frame(instance, corners.triangle, corners.weights, ref.uv_set % kMaxUvSets, normal);
    const glm::vec3 texel = 2.0f * glm::vec3(lookup.numbers(ref)) - 1.0f;
    const glm::vec3 bent = unit_or(scale * texel.x * frame.x + scale * texel.y * frame.y + texel.z * normal, normal);
    const float under = glm::dot(bent, front);
    return under < 0.0f ? unit_or(bent - under * front, normal) : bent;
}

/// The interpolated normal, on the front of the triangle as it is wound in the world.
glm::vec3 smooth_normal(const Instance& instance, const Corners& corners, const glm::vec3& front) {
    if (instance.normals.size() != instance.positions.size()) return front;
    const glm::vec3 local = corners.weights.x * instance.normals[corners.vertex.x] +
                            corners.weights.y * instance.normals[corners.vertex.y] +
                            corners.weights.z * instance.normals[corners.vertex.z];
    // Normals go by the inverse transpose, which keeps them perpendicular under shear and on their side under a mirror.
    const glm::vec3 normal = unit_or(glm::transpose(instance.local_from_world.linear) * local, front);
    return glm::dot(normal, front) < 0.0f ? -normal : normal;
}

/// The mesh's front, on which its normals and tangents are meant.
/// side       of the world's winding.
glm::vec3 front_of(const Corners& corners, const glm::vec3& toward_viewer, float side) {
    const bool has_area = corners.normal != glm::vec3(0.0f);
    return has_area ? side * corners.normal : unit_or(toward_viewer, glm::vec3(0, 0, 1));
}

/// From a point of the triangle to the curved surface that its corners' normals stand for: the mean of its projections onto
/// the planes that they stand on, without those that lie under it. 0 where that is not above the triangle.
glm::vec3 lift_of(const Instance& instance, const Corners& corners, const Surface& surface) {
    const glm::vec3 place[3] = {corners.a, corners.b, corners.c};
    const glm::vec3 above = glm::transpose(instance.world_from_local.linear) * surface.smooth;
    glm::vec3 normal[3];
    for (int i = 0; i < 3; ++i) {
        normal[i] = unit_or(instance.normals[corners.vertex[i]], glm::vec3(0.0f));
        if (glm::dot(normal[i], above) < 0.0f) normal[i] = -normal[i];
    }
    const glm::vec3 facet = unit_or(glm::transpose(instance.world_from_local.linear) * surface.ng, glm::vec3(0.0f));
    const float lean = glm::distance(facet, (normal[0] + normal[1] + normal[2]) / 3.0f);
    float spread = 0.0f;
    float steepest = 1.0f;
    for (int i = 0; i < 3; ++i) {
        spread = std::max(spread, glm::distance(normal[i], normal[(i + 1) % 3]));
        steepest = std::min(steepest, glm::dot(normal[i], facet));
    }
    if (!(lean <= spread) || !(steepest > kLeastCurved)) return glm::vec3(0.0f);

    const glm::vec3 local = corners.point();
    glm::vec3 lift(0.0f);
    for (int i = 0; i < 3; ++i)
        lift += corners.weights[i] * std::max(0.0f, glm::dot(place[i] - local, normal[i])) * normal[i];
    lift = instance.world_from_local.vector(lift);
    return glm::dot(lift, surface.ng) > 0.0f ? lift : glm::vec3(0.0f);
}

/// On the front.
void set_shading_normals(const Instance& instance, const Corners& corners, const Lookup& lookup, const Material& material,
                         const glm::vec3& front, Surface* surface) {
    surface->smooth = smooth_normal(instance, corners, front);
    surface->ns = bend(instance, corners, lookup, material.normal_texture, material.normal_scale, surface->smooth, front);
    surface->coat_ns = surface->coat > 0.0f ? bend(instance, corners, lookup, material.coat_normal_texture,
                                                   material.coat_normal_scale, surface->smooth, front)
                                            : surface->ns;
}

float unit(float x) {
    return glm::clamp(x, 0.0f, 1.0f);
}

/// All that a material says of light, but for its emission, base colour and normals.
void set_scattering(const Material& material, const Lookup& lookup, Surface* surface) {
    const glm::vec4 rough_metal = lookup.numbers(material.metallic_roughness_texture);
    surface->metallic = unit(material.metallic * rough_metal.b);
    surface->roughness = unit(material.roughness * rough_metal.g);
    surface->ior = std::max(material.ior, material.ior > 0.0f ? 1.0f : 1e6f);  // 0: infinite
    const float ratio = (surface->ior - 1.0f) / (surface->ior + 1.0f);
    surface->f0 = ratio * ratio;
    surface->specular = unit(material.specular * lookup.numbers(material.specular_texture).a);
    surface->specular_color = material.specular_color * glm::vec3(lookup.color(material.specular_color_texture));
    if (material.transmission > 0.0f) {
        surface->transmission = unit(material.transmission * lookup.numbers(material.transmission_texture).r);
        surface->has_volume = material.thickness > 0.0f;
        const glm::vec3 left = glm::clamp(material.attenuation_color, 1e-6f, 1.0f);
        surface->absorption = -glm::log(left) / material.attenuation_distance;
    }
    if (material.coat > 0.0f) {
        surface->coat = unit(material.coat * lookup.numbers(material.coat_texture).r);
        surface->coat_roughness = unit(material.coat_roughness * lookup.numbers(material.coat_roughness_texture).g);
    }
    if (material.sheen_color != glm::vec3(0.0f)) {
        const glm::vec3 color(lookup.color(material.sheen_color_texture));
        surface->sheen_color = glm::clamp(material.sheen_color * color, 0.0f, 1.0f);
        surface->sheen_roughness = unit(material.sheen_roughness * lookup.numbers(material.sheen_roughness_texture).a);
    }
}

const Material kDefaultMaterial;

}  // namespace

Surface surface_at(const Scene& scene, const Tlas& tlas, const Ray& ray, const Hit& hit, const RayCone& cone,
                   Detail detail) {
    const Instance& instance = tlas[hit.node];
    const Mesh& mesh = *instance.mesh;
    const Corners corners = corners_of(instance, hit);
    Surface surface;
    const glm::vec3 local = corners.point();
    surface.position = instance.is_identity ? local : instance.world_from_local.point(local);
    surface.error = corners.error;
    surface.material = material_of(mesh, hit.primitive);
    const Material& material =
        surface.material == kNone<MaterialId> ? kDefaultMaterial : scene.materials[index(surface.material)];

    float width = 0.0f;
    if (cone.width > 0.0f || cone.spread > 0.0f) {
        const float length = glm::length(ray.direction);
        const float slant = std::abs(glm::dot(corners.normal, ray.direction)) / length;
        width = (cone.width + cone.spread * hit.t * length) / std::sqrt(std::max(slant, kLeastSlant));
    }
    const Lookup lookup(scene, instance, corners, width);

    const size_t vertex_count = instance.positions.size();
    glm::vec4 color =
        material.base_color * lookup.color(material.base_color_texture, material.alpha_mode == AlphaMode::kMask);
    if (mesh.colors.size() == vertex_count) color *= interpolate(mesh.colors, corners);
    // More than 1 would make energy out of nothing at every bounce.
    surface.base_color = glm::clamp(glm::vec3(color), 0.0f, 1.0f);
    surface.is_unlit = material.is_unlit;
    if (material.alpha_mode == AlphaMode::kMask) surface.opacity = color.a >= material.alpha_cutoff ? 1.0f : 0.0f;
    if (material.alpha_mode == AlphaMode::kBlend) surface.opacity = unit(color.a);
    if (material.emission != glm::vec3(0.0f)) {
        surface.emission = material.emission * glm::vec3(lookup.light(material.emission_texture));
    }
    const bool is_whole = detail == Detail::kAll || material.transmission > 0.0f;
    if (is_whole) set_scattering(material, lookup, &surface);

    const bool is_mirrored = has_mirror(scene, hit.node);
    surface.is_inside = !is_front(is_mirrored, corners, ray.direction);
    surface.light_opacity = surface.opacity;
    if (!material.is_double_sided && !surface.is_body() && !surface.is_frosted()) {
        (surface.is_inside ? surface.opacity : surface.light_opacity) = 0.0f;
    }
    const glm::vec3 front = front_of(corners, -ray.direction, is_mirrored ? -1.0f : 1.0f);
    surface.ng = front;
    if (is_whole) set_shading_normals(instance, corners, lookup, material, front, &surface);
    if (glm::dot(front, ray.direction) > 0.0f) {
        surface.ng = -surface.ng;
        surface.smooth = -surface.smooth;
        surface.ns = -surface.ns;
        surface.coat_ns = -surface.coat_ns;
    }
    return surface;
}

glm::vec3 leave(const Surface& surface, const glm::vec3& direction) {
    const glm::vec3 outward = glm::dot(surface.ng, direction) < 0.0f ? -surface.ng : surface.ng;
    return surface.position + glm::dot(glm::abs(outward), surface.error) * outward;
}

bool is_turned_away(const Surface& surface, const glm::vec3& to_light) {
    return glm::dot(surface.ng, to_light) <= 0.0f && glm::dot(surface.smooth, to_light) > 0.0f;
}

std::optional<glm::vec3> leave_smoothly(const Tlas& tlas, const Hit& hit, const Surface& surface,
                                        const glm::vec3& to_light) {
    if (!(glm::dot(surface.smooth, to_light) > 0.0f) && !surface.is_frosted()) return std::nullopt;
    if (!is_turned_away(surface, to_light)) return leave(surface, to_light);
    const Instance& instance = tlas[hit.node];
    const glm::vec3 lift = lift_of(instance, corners_of(instance, hit), surface);
    if (lift == glm::vec3(0.0f)) return std::nullopt;
    Surface lifted = surface;
    lifted.position += lift;
    lifted.error += 2.0f * kUnitRoundoff * (glm::abs(surface.position) + glm::abs(lift));
    const glm::vec3 from = leave(surface, surface.ng), to = leave(lifted, surface.ng);
    if (any_hit(tlas, {.origin = from, .direction = to - from, .t_max = 1.0f})) return std::nullopt;
    return to;
}

}  // namespace zoe
