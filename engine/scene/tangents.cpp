#include "engine/scene/tangents.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <tuple>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>

namespace zoe {

namespace {

// A corner of a range of triangles is 3 * triangle + i, counted from the range's first; so is the edge from it to the next.

constexpr uint32_t kNothing = 0xffffffffu;

uint32_t next_of(uint32_t corner) {
    return corner % 3 == 2 ? corner - 2 : corner + 1;
}

uint32_t previous_of(uint32_t corner) {
    return corner % 3 == 0 ? corner + 2 : corner - 1;
}

using Key = std::array<uint32_t, 8>;

Key key_of(const Mesh& mesh, uint32_t vertex, int uv_set) {
    const glm::vec3 &p = mesh.positions[vertex], &n = mesh.normals[vertex];
    const glm::vec2& uv = mesh.uvs[uv_set][vertex];
    // By their bits, which have an order even where they are no numbers; 0 and -0 are one.
    const auto bits = [](float x) { return std::bit_cast<uint32_t>(x == 0.0f ? 0.0f : x); };
    return {bits(p.x), bits(p.y), bits(p.z), bits(n.x), bits(n.y), bits(n.z), bits(uv.x), bits(uv.y)};
}

/// By corner, the first of the range's vertices, in ascending order, that equals the corner's. Returned are places in that
/// order, of which there are `vertex_count`.
std::vector<uint32_t> weld_corners(const Mesh& mesh, const MaterialRange& range, int uv_set, size_t* vertex_count) {
    std::vector<uint32_t> corners;
    corners.reserve(size_t{3} * (range.end - range.begin));
    for (uint32_t t = range.begin; t < range.end; ++t) {
        for (int i = 0; i < 3; ++i) corners.push_back(mesh.corners[t][i]);
    }
    std::vector<uint32_t> used = corners;
    std::sort(used.begin(), used.end());
    used.erase(std::unique(used.begin(), used.end()), used.end());

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
    for (uint32_t& corner : corners) {
        corner = first_of[static_cast<size_t>(std::lower_bound(used.begin(), used.end(), corner) - used.begin())];
    }
    *vertex_count = used.size();
    return corners;
}

glm::dvec3 unit(const glm::dvec3& v) {
    const double length = glm::length(v);
    return length > 0.0 && std::isfinite(length) ? v / length : glm::dvec3(0.0);
}

glm::dvec3 unit_across(const glm::dvec3& v, const glm::dvec3& normal) {
    return unit(v - glm::dot(v, normal) * normal);
}

/// The angle between two edges, seen along a normal.
double angle_between(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& normal) {
    return std::acos(std::clamp(glm::dot(unit_across(a, normal), unit_across(b, normal)), -1.0, 1.0));
}

/// A triangle's tangent, and which way round the texture is on it.
struct Side {
    glm::vec4 tangent{0.0f};
    float w = 0.0f;         ///< 0: it has no area in the texture, and may become either.
    bool is_point = false;  ///< Two of its corners are in one place.
};

std::vector<Side> sides_of(const Mesh& mesh, const MaterialRange& range, int uv_set) {
    std::vector<Side> sides;
    sides.reserve(range.end - range.begin);
    for (uint32_t t = range.begin; t < range.end; ++t) {
        glm::vec3 p[3];
        glm::vec2 uv[3];
        for (int i = 0; i < 3; ++i) {
            p[i] = mesh.positions[mesh.corners[t][i]];
            uv[i] = mesh.uvs[uv_set][mesh.corners[t][i]];
        }
        const glm::vec4 tangent = triangle_tangent(p, uv);
        sides.push_back({tangent, tangent.w, p[0] == p[1] || p[1] == p[2] || p[2] == p[0]});
    }
    return sides;
}

/// By edge, the edge of another triangle that runs the other way between the same vertices, or `kNothing`. Where there are
/// several, each in turn gets the first that has none.
std::vector<uint32_t> pair_edges(const std::vector<uint32_t>& vertex_of, const std::vector<Side>& sides) {
    using Edge = std::array<uint32_t, 3>;  // Its lower vertex, its higher, its corner.
    std::vector<Edge> edges;
    edges.reserve(vertex_of.size());
    for (uint32_t e = 0; e < vertex_of.size(); ++e) {
        if (sides[e / 3].is_point) continue;
        const auto [low, high] = std::minmax(vertex_of[e], vertex_of[next_of(e)]);
        edges.push_back({low, high, e});
    }
    std::sort(edges.begin(), edges.end());
    std::vector<uint32_t> partner(vertex_of.size(), kNothing), waiting;
    for (size_t begin = 0, end = 0; begin < edges.size(); begin = end) {
        const uint32_t low = edges[begin][0], high = edges[begin][1];
        // Those that wait all run the same way: another one takes the first.
        waiting.clear();
        size_t first = 0;
        for (end = begin; end < edges.size() && edges[end][0] == low && edges[end][1] == high; ++end) {
            const uint32_t e = edges[end][2];
            if (first < waiting.size() && vertex_of[waiting[first]] != vertex_of[e]) {
                partner[e] = waiting[first];
                partner[waiting[first++]] = e;
            } else {
                waiting.push_back(e);
            }
        }
    }
    return partner;
}

/// By corner, the group of corners whose tangent it shares, or `kNothing`: at one vertex, with the texture the same way
/// round, and connected by edges.
/// sides      those without area in the texture become what the first group that reaches them is.
std::vector<uint32_t> group_corners(const std::vector<uint32_t>& partner, std::vector<Side>* sides, uint32_t* group_count) {
    std::vector<uint32_t> group_of(partner.size(), kNothing), open;
    for (uint32_t start = 0; start < group_of.size(); ++start) {
        const Side& side = (*sides)[start / 3];
        if (group_of[start] != kNothing || side.is_point || side.tangent == glm::vec4(0.0f)) continue;
        const float w = side.w;
        group_of[start] = *group_count;
        open.assign(1, start);
        while (!open.empty()) {
            const uint32_t corner = open.back();
            open.pop_back();
            const uint32_t after = partner[corner], before = partner[previous_of(corner)];
            for (const uint32_t other : {after == kNothing ? kNothing : next_of(after), before}) {
                if (other == kNothing || group_of[other] != kNothing) continue;
                Side& reached = (*sides)[other / 3];
                if (reached.w == 0.0f) reached.w = w;
                if (reached.w != w) continue;
                group_of[other] = *group_count;
                open.push_back(other);
            }
        }
        ++*group_count;
    }
    return group_of;
}

/// Adds up each group's tangents, each weighted by its triangle's angle there.
/// Returns    [group_count] unit length, or zero.
std::vector<glm::vec4> add_up(const Mesh& mesh, const MaterialRange& range, const std::vector<Side>& sides,
                              const std::vector<uint32_t>& group_of, uint32_t group_count) {
    std::vector<glm::dvec3> sums(group_count, glm::dvec3(0.0));
    std::vector<glm::vec4> tangents(group_count, glm::vec4(0.0f));
    for (uint32_t corner = 0; corner < group_of.size(); ++corner) {
        const Side& side = sides[corner / 3];
        if (group_of[corner] == kNothing || side.tangent == glm::vec4(0.0f)) continue;
        const auto vertex = [&](uint32_t c) { return mesh.corners[range.begin + c / 3][static_cast<int>(c % 3)]; };
        const auto position = [&](uint32_t c) { return glm::dvec3(mesh.positions[vertex(c)]); };
        const glm::dvec3 normal = unit(mesh.normals[vertex(corner)]);
        const double angle = angle_between(position(next_of(corner)) - position(corner),
                                           position(previous_of(corner)) - position(corner), normal);
        sums[group_of[corner]] += angle * unit_across(glm::dvec3(glm::vec3(side.tangent)), normal);
        tangents[group_of[corner]].w = side.w;
    }
    for (uint32_t group = 0; group < group_count; ++group) {
        const glm::vec3 tangent(unit(sums[group]));
        tangents[group] = tangent == glm::vec3(0.0f) ? glm::vec4(0.0f) : glm::vec4(tangent, tangents[group].w);
    }
    return tangents;
}

bool has_tangents(const Mesh& mesh, const MaterialRange& range) {
    for (uint32_t t = range.begin; t < range.end; ++t) {
        for (int i = 0; i < 3; ++i) {
            if (mesh.tangents.empty() || mesh.tangents[tangents_of(mesh, t)[i]] == glm::vec4(0.0f)) return false;
        }
    }
    return true;
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
    if (mesh->normals.size() != vertex_count || mesh->uvs[uv_set].size() != vertex_count) return;
    if (has_tangents(*mesh, range)) return;
    size_t welded_count = 0;
    const std::vector<uint32_t> vertex_of = weld_corners(*mesh, range, uv_set, &welded_count);
    std::vector<Side> sides = sides_of(*mesh, range, uv_set);
    uint32_t group_count = 0;
    const std::vector<uint32_t> group_of = group_corners(pair_edges(vertex_of, sides), &sides, &group_count);
    const std::vector<glm::vec4> made = add_up(*mesh, range, sides, group_of, group_count);

    if (mesh->tangent_corners.empty()) {
        if (mesh->tangents.empty()) {
            mesh->tangents.emplace_back(0.0f);
            mesh->tangent_corners.resize(mesh->corners.size(), glm::uvec3(0u));
        } else {
            mesh->tangent_corners = mesh->corners;
        }
    }
    const uint32_t first = static_cast<uint32_t>(mesh->tangents.size());
    mesh->tangents.insert(mesh->tangents.end(), made.begin(), made.end());
    const auto set = [&](uint32_t corner, uint32_t group) {
        uint32_t& tangent = mesh->tangent_corners[range.begin + corner / 3][static_cast<int>(corner % 3)];
        if (mesh->tangents[tangent] == glm::vec4(0.0f)) tangent = first + group;
    };
    const auto has_tangent = [&](uint32_t group) { return group != kNothing && made[group] != glm::vec4(0.0f); };
    std::vector<uint32_t> first_group(welded_count, kNothing);
    for (uint32_t corner = 0; corner < group_of.size(); ++corner) {
        if (!has_tangent(group_of[corner])) continue;
        set(corner, group_of[corner]);
        uint32_t& at_vertex = first_group[vertex_of[corner]];
        if (at_vertex == kNothing) at_vertex = group_of[corner];
    }
    for (uint32_t corner = 0; corner < group_of.size(); ++corner) {
        const uint32_t group = first_group[vertex_of[corner]];
        if (!has_tangent(group_of[corner]) && group != kNothing) set(corner, group);
    }
}

}  // namespace zoe
