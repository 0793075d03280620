#include "tests/stability/scenes.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/ext/matrix_double3x3.hpp>
#include <glm/ext/vector_double3.hpp>
#include <glm/geometric.hpp>

namespace zoe::test {

Mesh ball(int slices) {
    Mesh mesh;
    mesh.name = "ball";
    const int rings = slices / 2;
    mesh.positions.push_back({0, 1, 0});
    for (int ring = 1; ring < rings; ++ring) {
        const float latitude = 3.14159265f * float(ring) / float(rings);
        for (int k = 0; k < slices; ++k) {
            const float longitude = 6.28318531f * float(k) / float(slices);
            mesh.positions.push_back(
                {std::sin(latitude) * std::cos(longitude), std::cos(latitude), std::sin(latitude) * std::sin(longitude)});
        }
    }
    mesh.positions.push_back({0, -1, 0});
    const auto at = [&](int ring, int k) { return uint32_t(1 + (ring - 1) * slices + k % slices); };
    const auto last = uint32_t(mesh.positions.size() - 1);
    for (int k = 0; k < slices; ++k) {
        mesh.corners.push_back({0, at(1, k + 1), at(1, k)});
        for (int ring = 1; ring + 1 < rings; ++ring) {
            mesh.corners.push_back({at(ring, k), at(ring, k + 1), at(ring + 1, k + 1)});
            mesh.corners.push_back({at(ring, k), at(ring + 1, k + 1), at(ring + 1, k)});
        }
        mesh.corners.push_back({last, at(rings - 1, k), at(rings - 1, k + 1)});
    }
    mesh.materials = {{0, uint32_t(mesh.corners.size()), kNone<MaterialId>}};
    return mesh;
}

Mesh facing_triangle() {
    Mesh mesh;
    mesh.name = "triangle";
    mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}};
    mesh.corners = {{0, 1, 2}};
    mesh.materials = {{0, 1, kNone<MaterialId>}};
    return mesh;
}

NodeId add_node(Scene& scene, MeshId mesh, const Affine& local, NodeId parent) {
    Node node;
    node.name = "node " + std::to_string(scene.nodes.size());
    node.parent = parent;
    node.matrix = local;
    node.mesh = mesh;
    return scene.add(node);
}

Affine placed(const glm::vec3& translation, const glm::vec3& scale) {
    Affine a;
    for (int k = 0; k < 3; ++k) a.linear[k] *= scale[k];
    a.translation = translation;
    return a;
}

std::string warning_with(const Scene& scene, const std::string& text) {
    for (const auto& [warning, count] : scene.warnings()) {
        if (warning.find(text) != std::string::npos) return warning;
    }
    return "";
}

uint64_t warning_count(const Scene& scene, const std::string& text) {
    const std::string warning = warning_with(scene, text);
    return warning.empty() ? 0 : scene.warnings().at(warning);
}

bool is_sane(const Hit& hit, const Ray& ray) {
    if (!hit) return hit == Hit{};
    return std::isfinite(hit.t) && hit.t >= ray.t_min && hit.t <= ray.t_max && hit.u >= 0.0f && hit.v >= 0.0f &&
           hit.u + hit.v <= 1.000001f && hit.primitive != 0xffffffffu;
}

ExactHit exact_hit(const Tlas& tlas, const Ray& ray) {
    ExactHit best;
    best.t = best.second_t = std::numeric_limits<double>::infinity();
    const glm::dvec3 o(ray.origin), d(ray.direction);
    for (const Instance& instance : tlas.instances) {
        const glm::dmat3 linear(instance.world_from_local.linear);
        const glm::dvec3 translation(instance.world_from_local.translation);
        const auto corner = [&](uint32_t k) { return linear * glm::dvec3(instance.positions[k]) + translation - o; };
        for (const glm::uvec3& corners : instance.mesh->corners) {
            const glm::dvec3 a = corner(corners.x), b = corner(corners.y), c = corner(corners.z);
            const glm::dvec3 normal = glm::cross(b - a, c - a);
            const double facing = glm::dot(normal, d);
            const double u = glm::dot(d, glm::cross(c, a)) / facing, v = glm::dot(d, glm::cross(a, b)) / facing;
            const double t = glm::dot(normal, a) / facing, edge = std::min({u, v, 1.0 - u - v});
            if (!(edge >= 0.0 && t >= ray.t_min && t <= ray.t_max)) continue;
            if (t < best.t) {
                best.second_t = best.t;
                best.t = t;
                best.node = index(instance.node);
                best.edge = edge;
                best.cosine = std::abs(facing) / (glm::length(normal) * glm::length(d));
            } else {
                best.second_t = std::min(best.second_t, t);
            }
        }
    }
    return best;
}

}  // namespace zoe::test
