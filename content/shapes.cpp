#include "content/shapes.h"

#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

namespace zoe {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;
constexpr float kCreaseCosine = 0.75f;

glm::vec3 around(float angle, float radius, float y) {
    return {radius * std::cos(angle), y, radius * std::sin(angle)};
}

uint32_t add_vertex(Mesh& mesh, const glm::vec3& position, const glm::vec3& normal) {
    mesh.positions.push_back(position);
    mesh.normals.push_back(normal);
    return static_cast<uint32_t>(mesh.positions.size() - 1);
}

// Corners run counter-clockwise seen from outside.
void add_quad(Mesh& mesh, uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
    mesh.corners.push_back({a, b, c});
    mesh.corners.push_back({a, c, d});
}

void add_flat_quad(Mesh& mesh, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, const glm::vec3& d) {
    const glm::vec3 n = glm::normalize(glm::cross(b - a, c - a));
    const uint32_t first = add_vertex(mesh, a, n);
    add_vertex(mesh, b, n);
    add_vertex(mesh, c, n);
    add_vertex(mesh, d, n);
    add_quad(mesh, first, first + 1, first + 2, first + 3);
}

// A row of a surface of revolution: `segments` vertices, or one on the axis.
struct Row {
    uint32_t first = 0;
    bool is_pole = false;
};

Row add_row(Mesh& mesh, const glm::vec2& at, const glm::vec2& normal, int segments) {
    Row row;
    row.is_pole = at.x < 1e-6f;
    if (row.is_pole) {
        row.first = add_vertex(mesh, {0.0f, at.y, 0.0f}, {0.0f, normal.y < 0.0f ? -1.0f : 1.0f, 0.0f});
        return row;
    }
    row.first = static_cast<uint32_t>(mesh.positions.size());
    for (int s = 0; s < segments; ++s) {
        const float angle = 2.0f * kPi * static_cast<float>(s) / static_cast<float>(segments);
        add_vertex(mesh, around(angle, at.x, at.y), glm::normalize(around(angle, normal.x, normal.y)));
    }
    return row;
}

void join_rows(Mesh& mesh, const Row& lower, const Row& upper, int segments) {
    for (int s = 0; s < segments; ++s) {
        const auto here = static_cast<uint32_t>(s), next = static_cast<uint32_t>((s + 1) % segments);
        if (lower.is_pole && upper.is_pole) continue;
        if (lower.is_pole) {
            mesh.corners.push_back({lower.first, upper.first + here, upper.first + next});
        } else if (upper.is_pole) {
            mesh.corners.push_back({lower.first + here, upper.first, lower.first + next});
        } else {
            add_quad(mesh, lower.first + here, upper.first + here, upper.first + next, lower.first + next);
        }
    }
}

// Upright walls over a closed outline; `is_inside` turns them towards the hole.
void add_walls(Mesh& mesh, std::span<const glm::vec2> outline, float y0, float y1, bool is_inside) {
    const size_t count = outline.size();
    const auto side_normal = [&](size_t i) {
        const glm::vec2 e = outline[(i + 1) % count] - outline[i];
        return glm::normalize(glm::vec3(e.y, 0.0f, -e.x));
    };
    const float sign = is_inside ? -1.0f : 1.0f;
    for (size_t i = 0; i < count; ++i) {
        const size_t next = (i + 1) % count;
        const glm::vec3 own = side_normal(i), before = side_normal((i + count - 1) % count), after = side_normal(next);
        const glm::vec3 n0 = glm::dot(own, before) > kCreaseCosine ? glm::normalize(own + before) : own;
        const glm::vec3 n1 = glm::dot(own, after) > kCreaseCosine ? glm::normalize(own + after) : own;
        const uint32_t a = add_vertex(mesh, {outline[i].x, y0, outline[i].y}, sign * n0);
        const uint32_t b = add_vertex(mesh, {outline[i].x, y1, outline[i].y}, sign * n0);
        const uint32_t c = add_vertex(mesh, {outline[next].x, y1, outline[next].y}, sign * n1);
        const uint32_t d = add_vertex(mesh, {outline[next].x, y0, outline[next].y}, sign * n1);
        if (is_inside) {
            add_quad(mesh, a, d, c, b);
        } else {
            add_quad(mesh, a, b, c, d);
        }
    }
}

}  // namespace

Mesh make_box(const glm::vec3& lo, const glm::vec3& hi) {
    Mesh mesh;
    const auto p = [&](int x, int y, int z) { return glm::vec3(x ? hi.x : lo.x, y ? hi.y : lo.y, z ? hi.z : lo.z); };
    add_flat_quad(mesh, p(1, 0, 0), p(1, 1, 0), p(1, 1, 1), p(1, 0, 1));
    add_flat_quad(mesh, p(0, 0, 0), p(0, 0, 1), p(0, 1, 1), p(0, 1, 0));
    add_flat_quad(mesh, p(0, 1, 0), p(0, 1, 1), p(1, 1, 1), p(1, 1, 0));
    add_flat_quad(mesh, p(0, 0, 0), p(1, 0, 0), p(1, 0, 1), p(0, 0, 1));
    add_flat_quad(mesh, p(0, 0, 1), p(1, 0, 1), p(1, 1, 1), p(0, 1, 1));
    add_flat_quad(mesh, p(0, 0, 0), p(0, 1, 0), p(1, 1, 0), p(1, 0, 0));
    return mesh;
}

Mesh make_sphere(float radius, int segments, int rings) {
    Mesh mesh;
    Row lower{};
    for (int r = 0; r <= rings; ++r) {
        const float angle = kPi * (static_cast<float>(r) / static_cast<float>(rings) - 0.5f);
        const bool is_pole = r == 0 || r == rings;
        const glm::vec2 n(is_pole ? 0.0f : std::cos(angle), r == 0 ? -1.0f : r == rings ? 1.0f : std::sin(angle));
        const Row upper = add_row(mesh, radius * n, n, segments);
        if (r > 0) join_rows(mesh, lower, upper, segments);
        lower = upper;
    }
    return mesh;
}

Mesh make_torus(float major_radius, float minor_radius, int segments, int sides) {
    Mesh mesh;
    for (int k = 0; k < sides; ++k) {
        const float angle = 2.0f * kPi * static_cast<float>(k) / static_cast<float>(sides);
        const glm::vec2 n(std::cos(angle), std::sin(angle));
        add_row(mesh, glm::vec2(major_radius, 0.0f) + minor_radius * n, n, segments);
    }
    for (int k = 0; k < sides; ++k) {
        const auto row = [&](int i) { return Row{static_cast<uint32_t>((i % sides) * segments), false}; };
        join_rows(mesh, row(k), row(k + 1), segments);
    }
    return mesh;
}

Mesh make_lathe(std::span<const glm::vec2> profile, int segments) {
    Mesh mesh;
    const auto normal = [&](size_t i) {
        const glm::vec2 e = profile[i + 1] - profile[i];
        return glm::normalize(glm::vec2(e.y, -e.x));
    };
    Row last{};
    bool is_last_smooth = false;
    for (size_t i = 0; i + 1 < profile.size(); ++i) {
        const glm::vec2 own = normal(i);
        Row lower = last;
        if (!is_last_smooth) lower = add_row(mesh, profile[i], own, segments);
        const bool has_next = i + 2 < profile.size();
        const bool is_smooth = has_next && glm::dot(own, normal(i + 1)) > kCreaseCosine;
        const glm::vec2 n = is_smooth ? glm::normalize(own + normal(i + 1)) : own;
        const Row upper = add_row(mesh, profile[i + 1], n, segments);
        join_rows(mesh, lower, upper, segments);
        last = upper;
        is_last_smooth = is_smooth;
    }
    return mesh;
}

Mesh make_cylinder(float radius, float y0, float y1, int segments) {
    const glm::vec2 profile[] = {{0.0f, y0}, {radius, y0}, {radius, y1}, {0.0f, y1}};
    return make_lathe(profile, segments);
}

Mesh make_ring(std::span<const glm::vec2> outer, std::span<const glm::vec2> inner, float y0, float y1) {
    Mesh mesh;
    add_walls(mesh, outer, y0, y1, false);
    add_walls(mesh, inner, y0, y1, true);
    const auto add_cap = [&](float y, bool is_top) {
        const auto first = static_cast<uint32_t>(mesh.positions.size());
        const auto count = static_cast<uint32_t>(outer.size());
        for (const glm::vec2& p : outer) add_vertex(mesh, {p.x, y, p.y}, {0.0f, is_top ? 1.0f : -1.0f, 0.0f});
        for (const glm::vec2& p : inner) add_vertex(mesh, {p.x, y, p.y}, {0.0f, is_top ? 1.0f : -1.0f, 0.0f});
        for (uint32_t i = 0; i < count; ++i) {
            const uint32_t a = first + i, b = first + (i + 1) % count, c = b + count, d = a + count;
            if (is_top) {
                add_quad(mesh, a, d, c, b);
            } else {
                add_quad(mesh, a, b, c, d);
            }
        }
    };
    add_cap(y1, true);
    add_cap(y0, false);
    return mesh;
}

Mesh make_arc(float inner_radius, float outer_radius, float angle0, float angle1, float y0, float y1, int segments) {
    std::vector<glm::vec2> outline;
    const auto add_side = [&](float radius, float from, float to) {
        for (int s = 0; s <= segments; ++s) {
            const float angle = from + (to - from) * static_cast<float>(s) / static_cast<float>(segments);
            outline.push_back({radius * std::cos(angle), radius * std::sin(angle)});
        }
    };
    add_side(outer_radius, angle0, angle1);
    add_side(inner_radius, angle1, angle0);
    Mesh mesh;
    add_walls(mesh, outline, y0, y1, false);
    const size_t count = outline.size();
    for (size_t s = 0; s + 1 < count / 2; ++s) {
        const glm::vec2 o0 = outline[s], o1 = outline[s + 1], i0 = outline[count - 1 - s], i1 = outline[count - 2 - s];
        add_flat_quad(mesh, {o0.x, y1, o0.y}, {i0.x, y1, i0.y}, {i1.x, y1, i1.y}, {o1.x, y1, o1.y});
        add_flat_quad(mesh, {o0.x, y0, o0.y}, {o1.x, y0, o1.y}, {i1.x, y0, i1.y}, {i0.x, y0, i0.y});
    }
    return mesh;
}

Mesh make_tube(std::span<const glm::vec3> path, std::span<const float> radii, int sides) {
    Mesh mesh;
    const size_t count = path.size();
    glm::vec3 along = glm::normalize(path[1] - path[0]);
    glm::vec3 side = glm::normalize(glm::cross(along, std::abs(along.y) < 0.9f ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0)));
    std::vector<Row> rows;
    rows.push_back({add_vertex(mesh, path[0] - 0.5f * radii[0] * along, -along), true});
    for (size_t i = 0; i < count; ++i) {
        const glm::vec3 next = glm::normalize(path[std::min(i + 1, count - 1)] - path[i > 0 ? i - 1 : 0]);
        side = glm::normalize(side - glm::dot(side, next) * next);  // Carried along, so that the tube does not twist.
        const glm::vec3 other = glm::cross(side, next);
        rows.push_back({static_cast<uint32_t>(mesh.positions.size()), false});
        for (int s = 0; s < sides; ++s) {
            const float angle = 2.0f * kPi * static_cast<float>(s) / static_cast<float>(sides);
            const glm::vec3 n = std::cos(angle) * side + std::sin(angle) * other;
            add_vertex(mesh, path[i] + radii[i] * n, n);
        }
        along = next;
    }
    rows.push_back({add_vertex(mesh, path[count - 1] + 0.5f * radii[count - 1] * along, along), true});
    for (size_t r = 0; r + 1 < rows.size(); ++r) join_rows(mesh, rows[r], rows[r + 1], sides);
    return mesh;
}

Mesh make_grid(int columns, int rows, float size_x, float size_z) {
    Mesh mesh;
    for (int r = 0; r <= rows; ++r) {
        for (int c = 0; c <= columns; ++c) {
            const float u = static_cast<float>(c) / static_cast<float>(columns);
            const float v = static_cast<float>(r) / static_cast<float>(rows);
            add_vertex(mesh, {size_x * (u - 0.5f), 0.0f, size_z * (v - 0.5f)}, {0, 1, 0});
        }
    }
    const auto stride = static_cast<uint32_t>(columns + 1);
    for (int r = 0; r < rows; ++r) {
        for (int c = 0; c < columns; ++c) {
            const uint32_t a = static_cast<uint32_t>(r) * stride + static_cast<uint32_t>(c);
            add_quad(mesh, a, a + stride, a + stride + 1, a + 1);
        }
    }
    return mesh;
}

std::vector<glm::vec2> circle(float radius, int count) {
    std::vector<glm::vec2> outline;
    for (int i = 0; i < count; ++i) {
        const float angle = 2.0f * kPi * static_cast<float>(i) / static_cast<float>(count);
        outline.push_back({radius * std::cos(angle), radius * std::sin(angle)});
    }
    return outline;
}

void append(Mesh& mesh, const Mesh& part, const Affine& placed, MaterialId material) {
    const auto first = static_cast<uint32_t>(mesh.positions.size());
    const auto triangle_begin = static_cast<uint32_t>(mesh.corners.size());
    const glm::mat3 cofactors(glm::cross(placed.linear[1], placed.linear[2]), glm::cross(placed.linear[2], placed.linear[0]),
                              glm::cross(placed.linear[0], placed.linear[1]));
    const bool is_mirror = glm::dot(placed.linear[0], cofactors[0]) < 0.0f;
    for (const glm::vec3& p : part.positions) mesh.positions.push_back(placed.point(p));
    for (const glm::vec3& n : part.normals)
        mesh.normals.push_back(glm::normalize((is_mirror ? -1.0f : 1.0f) * (cofactors * n)));
    if (!part.colors.empty() || !mesh.colors.empty()) {
        mesh.colors.resize(first, glm::vec4(1.0f));
        mesh.colors.insert(mesh.colors.end(), part.colors.begin(), part.colors.end());
        mesh.colors.resize(mesh.positions.size(), glm::vec4(1.0f));
    }
    if (!part.uvs[0].empty() || !mesh.uvs[0].empty()) {
        mesh.uvs[0].resize(first, glm::vec2(0.0f));
        mesh.uvs[0].insert(mesh.uvs[0].end(), part.uvs[0].begin(), part.uvs[0].end());
        mesh.uvs[0].resize(mesh.positions.size(), glm::vec2(0.0f));
    }
    for (const glm::uvec3& c : part.corners) {
        mesh.corners.push_back(is_mirror ? glm::uvec3(first + c.x, first + c.z, first + c.y) : first + c);
    }
    const auto triangle_end = static_cast<uint32_t>(mesh.corners.size());
    if (!mesh.materials.empty() && mesh.materials.back().material == material) {
        mesh.materials.back().end = triangle_end;
    } else {
        mesh.materials.push_back({triangle_begin, triangle_end, material});
    }
}

void smooth_normals(Mesh& mesh) {
    mesh.normals.assign(mesh.positions.size(), glm::vec3(0.0f));
    for (const glm::uvec3& c : mesh.corners) {
        const glm::vec3 a = mesh.positions[c.x];
        const glm::vec3 n = glm::cross(mesh.positions[c.y] - a, mesh.positions[c.z] - a);
        for (int k = 0; k < 3; ++k) mesh.normals[c[k]] += n;
    }
    for (glm::vec3& n : mesh.normals) {
        const float length = glm::length(n);
        n = length > 0.0f ? n / length : glm::vec3(0.0f);
    }
}

void paint(Mesh& mesh, const glm::vec3& color) {
    mesh.colors.assign(mesh.positions.size(), glm::vec4(color, 1.0f));
}

glm::vec3 srgb(uint32_t hex) {
    const auto linear = [](uint32_t byte) {
        const float s = static_cast<float>(byte & 0xffu) / 255.0f;
        return s <= 0.04045f ? s / 12.92f : std::pow((s + 0.055f) / 1.055f, 2.4f);
    };
    return {linear(hex >> 16), linear(hex >> 8), linear(hex)};
}

Affine at(const glm::vec3& translation) {
    return {glm::mat3(1.0f), translation};
}

Affine at(const glm::vec3& translation, float degrees, const glm::vec3& axis, const glm::vec3& scale) {
    return to_affine(Trs{translation, glm::angleAxis(glm::radians(degrees), glm::normalize(axis)), scale});
}

}  // namespace zoe
