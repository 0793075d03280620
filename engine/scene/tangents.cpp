#include "engine/scene/tangents.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <tuple>
#include <vector>

#include <glm/geometric.hpp>

namespace zoe {

namespace {

using Key = std::array<uint32_t, 8>;

Key key_of(const Mesh& mesh, uint32_t vertex, int uv_set) {
    const glm::vec3 &p = mesh.positions[vertex], &n = mesh.normals[vertex];
    const glm::vec2& uv = mesh.uvs[uv_set][vertex];
    // By their bits, which have an order even where they are no numbers; 0 and -0 are one.
    const auto bits = [](float x) { return std::bit_cast<uint32_t>(x == 0.0f ? 0.0f : x); };
    return {bits(p.x), bits(p.y), bits(p.z), bits(n.x), bits(n.y), bits(n.z), bits(uv.x), bits(uv.y)};
}

/// For each of the vertices of a range, in ascending order, the first one that equals it.
/// used       sorted, without repetition.
std::vector<uint32_t> weld(const Mesh& mesh, int uv_set, const std::vector<uint32_t>& used) {
    std::vector<uint32_t> order(used.size());
    for (uint32_t i = 0; i < order.size(); ++i) order[i] = i;
    std::vector<Key> keys(used.size());
    for (size_t i = 0; i < used.size(); ++i) keys[i] = key_of(mesh, used[i], uv_set);
    std::sort(order.begin(), order.end(),
              [&](uint32_t a, uint32_t b) { return std::tie(keys[a], a) < std::tie(keys[b], b); });
    std::vector<uint32_t> first_of(used.size());
    for (size_t i = 0; i < order.size(); ++i) {
        const bool is_new = i == 0 || keys[order[i]] != keys[order[i - 1]];
        first_of[order[i]] = is_new ? order[i] : first_of[order[i - 1]];
    }
    return first_of;
}

glm::vec3 unit_across(const glm::vec3& v, const glm::vec3& normal) {
    const glm::vec3 across = v - glm::dot(v, normal) * normal;
    const float length = glm::length(across);
    return length > 0.0f && std::isfinite(length) ? across / length : glm::vec3(0.0f);
}

/// The angle between two edges, seen along a normal.
float angle_between(const glm::vec3& a, const glm::vec3& b, const glm::vec3& normal) {
    return std::acos(std::clamp(glm::dot(unit_across(a, normal), unit_across(b, normal)), -1.0f, 1.0f));
}

}  // namespace

glm::vec4 triangle_tangent(const glm::vec3 (&positions)[3], const glm::vec2 (&uvs)[3]) {
    // In double precision: neither scale nor a small texture makes the area vanish.
    const glm::dvec3 ab = glm::dvec3(positions[1]) - glm::dvec3(positions[0]),
                     ac = glm::dvec3(positions[2]) - glm::dvec3(positions[0]);
    const glm::dvec2 uv_ab = glm::dvec2(uvs[1]) - glm::dvec2(uvs[0]), uv_ac = glm::dvec2(uvs[2]) - glm::dvec2(uvs[0]);
    const double area = uv_ab.x * uv_ac.y - uv_ac.x * uv_ab.y;
    const glm::dvec3 along_u = (ab * uv_ac.y - ac * uv_ab.y) * (area < 0.0 ? -1.0 : 1.0);
    const double length = glm::length(along_u);
    if (!(std::abs(area) > 0.0) || !(length > 0.0) || !std::isfinite(length)) return glm::vec4(0.0f);
    return {glm::vec3(along_u / length), area < 0.0 ? 1.0f : -1.0f};
}

void derive_tangents(Mesh* mesh, const MaterialRange& range, int uv_set) {
    const size_t vertex_count = mesh->positions.size();
    if (mesh->normals.size() != vertex_count || mesh->uvs[uv_set].size() != vertex_count || range.begin == range.end) return;
    mesh->tangents.resize(vertex_count, glm::vec4(0.0f));

    std::vector<uint32_t> used;
    used.reserve(size_t{3} * (range.end - range.begin));
    for (uint32_t t = range.begin; t < range.end; ++t) {
        for (int i = 0; i < 3; ++i) used.push_back(mesh->corners[t][i]);
    }
    std::sort(used.begin(), used.end());
    used.erase(std::unique(used.begin(), used.end()), used.end());
    const std::vector<uint32_t> first_of = weld(*mesh, uv_set, used);

    std::vector<std::array<glm::vec3, 2>> sums(used.size(), {glm::vec3(0.0f), glm::vec3(0.0f)});  // by w: -1, 1
    for (uint32_t t = range.begin; t < range.end; ++t) {
        const glm::uvec3& corner = mesh->corners[t];
        glm::vec3 p[3];
        glm::vec2 uv[3];
        for (int i = 0; i < 3; ++i) {
            p[i] = mesh->positions[corner[i]];
            uv[i] = mesh->uvs[uv_set][corner[i]];
        }
        const glm::vec4 tangent = triangle_tangent(p, uv);
        if (tangent == glm::vec4(0.0f)) continue;
        for (int i = 0; i < 3; ++i) {
            const auto at = std::lower_bound(used.begin(), used.end(), corner[i]) - used.begin();
            const glm::vec3& normal = mesh->normals[corner[i]];
            const float angle = angle_between(p[(i + 1) % 3] - p[i], p[(i + 2) % 3] - p[i], normal);
            sums[first_of[static_cast<size_t>(at)]][tangent.w < 0.0f ? 0 : 1] +=
                angle * unit_across(glm::vec3(tangent), normal);
        }
    }
    for (size_t i = 0; i < used.size(); ++i) {
        glm::vec4& tangent = mesh->tangents[used[i]];
        const auto& [mirrored, plain] = sums[first_of[i]];
        const float mirrored_length = glm::length(mirrored), plain_length = glm::length(plain);
        if (tangent != glm::vec4(0.0f) || (mirrored_length > 0.0f) == (plain_length > 0.0f)) continue;
        tangent = plain_length > 0.0f ? glm::vec4(plain / plain_length, 1.0f) : glm::vec4(mirrored / mirrored_length, -1.0f);
    }
}

}  // namespace zoe
