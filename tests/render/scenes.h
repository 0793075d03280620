#pragma once

#include <initializer_list>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>

#include "engine/frame/frame.h"
#include "engine/render/path.h"
#include "engine/scene/scene.h"

namespace zoe::test {

/// Two triangles a, b, c and a, c, d; texture coordinates (0, 0), (1, 0), (1, 1), (0, 1).
inline Mesh make_quad(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, const glm::vec3& d, MaterialId material) {
    Mesh mesh;
    mesh.positions = {a, b, c, d};
    mesh.uvs[0] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    mesh.corners = {{0, 1, 2}, {0, 2, 3}};
    mesh.materials = {{0, 2, material}};
    return mesh;
}

/// A horizontal square around the origin at a height. Its front is above, its texture's top left at (-size, -size).
inline Mesh make_floor(float size, float y, MaterialId material) {
    Mesh mesh = make_quad({-size, y, -size}, {size, y, -size}, {size, y, size}, {-size, y, size}, material);
    mesh.corners = {{0, 2, 1}, {0, 3, 2}};
    return mesh;
}

/// The cube [-1, 1]^3 of 12 triangles with 8 shared vertices; without its top where that is open.
inline Mesh make_box(MaterialId material, bool is_open = false) {
    Mesh mesh;
    for (int i = 0; i < 8; ++i) mesh.positions.push_back({i & 1 ? 1.0f : -1.0f, i & 2 ? 1.0f : -1.0f, i & 4 ? 1.0f : -1.0f});
    mesh.corners = {{0, 1, 5}, {0, 5, 4}, {0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6},
                    {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}, {2, 6, 7}, {2, 7, 3}};
    if (is_open) mesh.corners.resize(10);
    mesh.materials = {{0, static_cast<uint32_t>(mesh.corners.size()), material}};
    return mesh;
}

/// A closed convex sphere of radius 1: an octahedron whose triangles were split into four `levels` times.
inline Mesh make_sphere(int levels, MaterialId material, bool has_normals) {
    Mesh mesh;
    mesh.positions = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    mesh.corners = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
    for (int level = 0; level < levels; ++level) {
        std::vector<glm::uvec3> finer;
        const auto middle = [&mesh](uint32_t i, uint32_t j) {
            const glm::vec3 point = glm::normalize(mesh.positions[i] + mesh.positions[j]);
            for (uint32_t k = 0; k < mesh.positions.size(); ++k) {
                if (mesh.positions[k] == point) return k;
            }
            mesh.positions.push_back(point);
            return static_cast<uint32_t>(mesh.positions.size() - 1);
        };
        for (const glm::uvec3& t : mesh.corners) {
            const uint32_t ab = middle(t.x, t.y), bc = middle(t.y, t.z), ca = middle(t.z, t.x);
            for (const glm::uvec3& part :
                 {glm::uvec3(t.x, ab, ca), glm::uvec3(ab, t.y, bc), glm::uvec3(ca, bc, t.z), glm::uvec3(ab, bc, ca)}) {
                finer.push_back(part);
            }
        }
        mesh.corners = finer;
    }
    if (has_normals) mesh.normals = mesh.positions;
    mesh.materials = {{0, static_cast<uint32_t>(mesh.corners.size()), material}};
    return mesh;
}

/// Turns every triangle's front to the other side.
inline Mesh turned_inside_out(Mesh mesh) {
    for (glm::uvec3& corners : mesh.corners) std::swap(corners.y, corners.z);
    for (glm::vec3& normal : mesh.normals) normal = -normal;
    return mesh;
}

/// Scatters diffusely and reflects nothing else.
inline Material make_diffuse() {
    Material material;
    material.metallic = material.specular = 0.0f;
    return material;
}

inline MaterialId add_diffuse(Scene& scene, const glm::vec3& albedo, bool is_double_sided = false) {
    Material material = make_diffuse();
    material.base_color = glm::vec4(albedo, 1.0f);
    material.is_double_sided = is_double_sided;
    return scene.add(material);
}

inline NodeId add_node(Scene& scene, Mesh mesh, const Trs& local = {}) {
    Node node;
    node.mesh = scene.add(std::move(mesh));
    node.local = local;
    return scene.add(std::move(node));
}

inline NodeId add_light(Scene& scene, const Light& light, const Trs& local) {
    scene.lights.push_back(light);
    Node node;
    node.light = LightId{static_cast<uint32_t>(scene.lights.size() - 1)};
    node.local = local;
    return scene.add(std::move(node));
}

/// No sky, no sun, rays through pixel centres: only what the scene itself holds gives light.
inline RenderConfig dark() {
    RenderConfig config;
    config.sky_strength = config.sun_strength = 0.0f;
    config.is_jittered = false;
    return config;
}

/// A sky of radiance 1 everywhere.
inline RenderConfig furnace(int max_bounces) {
    RenderConfig config;
    config.uniform_sky = glm::vec3(1.0f);
    config.max_bounces = max_bounces;
    return config;
}

inline Film picture(Scene& scene, const View& view, const RenderConfig& config, int width, int height, int sample_count = 1,
                    FrameStats* stats = nullptr) {
    const Tlas& tlas = advance(scene, 0.0);
    Film film(width, height);
    render(scene, tlas, view, config, sample_count, &film, stats);
    return film;
}

/// Mean radiance over a whole film.
inline glm::vec3 mean_radiance(const Film& film) {
    glm::dvec4 sum(0.0);
    for (const glm::vec4& pixel : film.sum) sum += glm::dvec4(pixel);
    return glm::vec3(sum / (static_cast<double>(film.sum.size()) * film.sample_count));
}

}  // namespace zoe::test
