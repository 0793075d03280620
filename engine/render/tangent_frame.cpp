#include "engine/render/tangent_frame.h"

#include <cmath>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include "engine/render/direction.h"
#include "engine/scene/tangents.h"

namespace zoe {

namespace {

/// Two edges of a triangle and its normal, times the root of its doubled area: as long as the edges are. A deformation
/// carries along what is written in them.
glm::dmat3 edges_of(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
    const glm::dvec3 cross = glm::cross(b - a, c - a);
    const double area = glm::length(cross);
    return {b - a, c - a, area > 0.0 ? cross / std::sqrt(area) : glm::dvec3(0.0)};
}

glm::vec3 across(const glm::vec3& v, const glm::vec3& normal) {
    return unit_or(v - glm::dot(v, normal) * normal, glm::vec3(0.0f));
}

}  // namespace

TangentFrame tangent_frame(const Instance& instance, uint32_t triangle, const glm::vec3& weights, size_t uv_set,
                           const glm::vec3& normal) {
    const Mesh& mesh = *instance.mesh;
    const glm::uvec3& vertex = mesh.corners[triangle];
    const size_t vertex_count = instance.positions.size();
    glm::vec3 x(0.0f), y(0.0f);  // in the instance's space
    if ((mesh.tangents.size() == vertex_count || !mesh.tangent_corners.empty()) && mesh.normals.size() == vertex_count &&
        mesh.positions.size() == vertex_count) {
        const glm::uvec3& at = tangents_of(mesh, triangle);
        const glm::vec4 &t0 = mesh.tangents[at.x], &t1 = mesh.tangents[at.y], &t2 = mesh.tangents[at.z];
        if (t0 != glm::vec4(0.0f) && t1 != glm::vec4(0.0f) && t2 != glm::vec4(0.0f) && t0.w == t1.w && t1.w == t2.w) {
            const glm::vec3 tangent = weights.x * glm::vec3(t0) + weights.y * glm::vec3(t1) + weights.z * glm::vec3(t2);
            const glm::vec3 rest_normal =
                weights.x * mesh.normals[vertex.x] + weights.y * mesh.normals[vertex.y] + weights.z * mesh.normals[vertex.z];
            const glm::dmat3 rest = edges_of(mesh.positions[vertex.x], mesh.positions[vertex.y], mesh.positions[vertex.z]);
            const glm::dmat3 now =
                edges_of(instance.positions[vertex.x], instance.positions[vertex.y], instance.positions[vertex.z]);
            if (glm::determinant(rest) > 0.0) {
                const glm::dmat3 now_from_rest = now * glm::inverse(rest);
                x = glm::vec3(now_from_rest * glm::dvec3(tangent));
                y = glm::vec3(now_from_rest * glm::dvec3(t0.w * glm::cross(rest_normal, tangent)));
            }
        }
    }
    if (x == glm::vec3(0.0f) && mesh.uvs[uv_set].size() == vertex_count) {
        const std::vector<glm::vec2>& uvs = mesh.uvs[uv_set];
        const glm::vec3 p[3] = {instance.positions[vertex.x], instance.positions[vertex.y], instance.positions[vertex.z]};
        const glm::vec4 own = triangle_tangent(p, {uvs[vertex.x], uvs[vertex.y], uvs[vertex.z]});
        x = glm::vec3(own);
        y = own.w * glm::cross(unit_or(glm::cross(p[1] - p[0], p[2] - p[0]), glm::vec3(0.0f)), x);
    }
    TangentFrame frame;
    frame.x = across(instance.world_from_local.vector(x), normal);
    frame.y = across(instance.world_from_local.vector(y), normal);
    return frame;
}

}  // namespace zoe
