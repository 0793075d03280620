#include <cmath>

#include <glm/geometric.hpp>

#include "content/make_default_parts.h"
#include "engine/math/rng.h"

namespace zoe {
namespace {

constexpr float kHalfWidth = 2.3f, kBack = -1.9f, kFront = 3.2f, kHeight = 2.9f, kThick = 0.16f;

// A slab between two heights, over an outline of which each side may slope: corners counter-clockwise seen from +Z.
Mesh make_slab(const glm::vec2 (&outline)[4], float z0, float z1) {
    Mesh mesh = make_box({0, 0, 0}, {1, 1, 1});
    for (glm::vec3& p : mesh.positions) {
        const int corner = p.y < 0.5f ? (p.x < 0.5f ? 0 : 1) : (p.x < 0.5f ? 3 : 2);
        p = {outline[corner], p.z < 0.5f ? z0 : z1};
    }
    for (const glm::uvec3& c : mesh.corners) {
        const glm::vec3 a = mesh.positions[c.x], b = mesh.positions[c.y], d = mesh.positions[c.z];
        const glm::vec3 n = glm::cross(b - a, d - a);
        if (glm::dot(n, n) == 0.0f) continue;  // A side that shrank to a line.
        for (int k = 0; k < 3; ++k) mesh.normals[c[k]] = glm::normalize(n);
    }
    return mesh;
}

Mesh make_floor() {
    const glm::vec3 tones[] = {srgb(0xa97c50), srgb(0xb58658), srgb(0x9d7148), srgb(0xae8154), srgb(0xa2764c)};
    Mesh floor;
    Rng rng(11);
    const float width = 0.164f;
    for (int row = 0; row < 28; ++row) {
        const float x = -kHalfWidth + width * static_cast<float>(row);
        float z = kBack - rng.uniform(0.0f, 1.0f);
        while (z < kFront) {
            const float length = rng.uniform(1.1f, 1.7f), begin = std::max(z, kBack), end = std::min(z + length, kFront);
            z += length;
            if (end - begin < 0.01f) continue;
            Mesh board = make_box({x + 0.0015f, -0.02f, begin + 0.0015f}, {x + width - 0.0015f, 0.0f, end - 0.0015f});
            paint(board, rng.uniform(0.86f, 1.08f) * tones[rng.below(5)]);
            append(floor, board);
        }
    }
    Mesh ground = make_box({-kHalfWidth - kThick, -0.12f, kBack - kThick}, {kHalfWidth + kThick, -0.021f, kFront});
    paint(ground, srgb(0x2e2018));
    append(floor, ground);
    return floor;
}

// A wall in the XY plane with an opening that has an arch, from z0 to z1.
struct Opening {
    float left, right, bottom, spring;  // `spring`: where the arch begins.
};

constexpr int kArchStrips = 20;

glm::vec2 arch_point(const Opening& o, int strip) {
    const float radius = 0.5f * (o.right - o.left), angle = 3.14159265f * static_cast<float>(strip) / kArchStrips;
    return {0.5f * (o.left + o.right) - radius * std::cos(angle), o.spring + 0.72f * radius * std::sin(angle)};
}

Mesh make_wall(float left, float right, float top, const Opening& o, float z0, float z1) {
    Mesh wall;
    append(wall, make_box({left, 0, z0}, {o.left, top, z1}));
    append(wall, make_box({o.right, 0, z0}, {right, top, z1}));
    append(wall, make_box({o.left, 0, z0}, {o.right, o.bottom, z1}));
    for (int s = 0; s < kArchStrips; ++s) {
        const glm::vec2 a = arch_point(o, s), b = arch_point(o, s + 1);
        append(wall, make_slab({a, b, {b.x, top}, {a.x, top}}, z0, z1));
    }
    return wall;
}

// Frame, bars and sill of an arched window; the room is on the +Z side.
Mesh make_window(const Opening& o, float z0, float z1) {
    Mesh window;
    const float z = 0.5f * (z0 + z1), bar = 0.022f, centre = 0.5f * (o.left + o.right);
    const float crown = arch_point(o, kArchStrips / 2).y;
    for (int s = 0; s < kArchStrips; ++s) {
        const glm::vec2 a = arch_point(o, s), b = arch_point(o, s + 1);
        const glm::vec2 hub(centre, o.spring - 0.1f);
        append(window, make_slab({glm::mix(a, hub, 0.08f), glm::mix(b, hub, 0.08f), b, a}, z - 0.035f, z1 + 0.012f));
        append(window, make_slab({a, b, b + 0.11f * (b - hub), a + 0.11f * (a - hub)}, z1, z1 + 0.03f));
    }
    append(window, make_box({o.left, o.bottom, z - 0.035f}, {o.left + 0.045f, o.spring, z1 + 0.012f}));
    append(window, make_box({o.right - 0.045f, o.bottom, z - 0.035f}, {o.right, o.spring, z1 + 0.012f}));
    append(window, make_box({o.left - 0.06f, o.bottom, z1}, {o.left, o.spring, z1 + 0.03f}));
    append(window, make_box({o.right, o.bottom, z1}, {o.right + 0.06f, o.spring, z1 + 0.03f}));
    append(window, make_box({centre - bar, o.bottom, z - bar}, {centre + bar, crown, z + bar}));
    for (const float y : {o.bottom + 0.36f * (o.spring - o.bottom), o.bottom + 0.72f * (o.spring - o.bottom)}) {
        append(window, make_box({o.left, y - bar, z - bar}, {o.right, y + bar, z + bar}));
    }
    append(window, make_box({o.left - 0.1f, o.bottom - 0.05f, z - 0.05f}, {o.right + 0.1f, o.bottom, z1 + 0.11f}));
    return window;
}

// Panels and rails along a wall in the XY plane, the room on the +Z side.
Mesh make_wainscot(float left, float right, float z) {
    Mesh wood;
    append(wood, make_box({left, 0, z}, {right, 0.86f, z + 0.012f}));
    append(wood, make_box({left, 0, z}, {right, 0.13f, z + 0.035f}));
    append(wood, make_box({left, 0.84f, z}, {right, 0.9f, z + 0.045f}));
    const int count = static_cast<int>(std::round((right - left) / 0.46f));
    const float pitch = (right - left) / static_cast<float>(count);
    for (int i = 0; i <= count; ++i) {
        const float x = left + pitch * static_cast<float>(i);
        append(wood, make_box({std::max(left, x - 0.045f), 0.13f, z}, {std::min(right, x + 0.045f), 0.84f, z + 0.026f}));
    }
    append(wood, make_box({left, 0.75f, z}, {right, 0.84f, z + 0.026f}));
    append(wood, make_box({left, 0.13f, z}, {right, 0.22f, z + 0.026f}));
    return wood;
}

// What the windows show: a meadow, hills, a few trees.
Mesh make_outside() {
    Mesh outside;
    const auto add = [&](const Mesh& shape, const glm::vec3& place, const glm::vec3& size, uint32_t color) {
        Mesh part = shape;
        paint(part, srgb(color));
        append(outside, part, at(place, 0.0f, {0, 1, 0}, size));
    };
    const Mesh dome = make_sphere(1.0f, 24, 10), crown = make_sphere(1.0f, 12, 8);
    const Mesh trunk = make_cylinder(1.0f, 0.0f, 1.0f, 8);
    add(make_cylinder(15.0f, -0.2f, -0.125f, 64), {0, 0, -4.0f}, glm::vec3(1.0f), 0x8aa05c);
    add(dome, {-8.0f, -0.9f, -14.0f}, {7.0f, 2.6f, 4.0f}, 0x7d9a62);
    add(dome, {1.5f, -0.8f, -16.0f}, {8.0f, 3.0f, 3.5f}, 0x6d8c66);
    add(dome, {11.0f, -0.8f, -11.0f}, {7.0f, 2.8f, 5.0f}, 0x7d9a62);
    add(dome, {15.0f, -0.9f, 0.0f}, {4.0f, 2.7f, 9.0f}, 0x6d8c66);
    const glm::vec3 trees[] = {
        {-4.1f, 1.0f, -8.2f}, {-2.9f, 0.8f, -9.5f}, {-1.6f, 0.7f, -7.6f}, {6.2f, 1.0f, -3.2f}, {7.4f, 0.8f, -1.2f}};
    for (const glm::vec3& tree : trees) {
        const float size = tree.y;
        add(trunk, {tree.x, -0.2f, tree.z}, {0.07f * size, 1.1f * size, 0.07f * size}, 0x5d4632);
        add(crown, {tree.x, 1.3f * size, tree.z}, {0.62f * size, 0.8f * size, 0.62f * size}, 0x5f8150);
    }
    return outside;
}

}  // namespace

void add_room(GlbWriter& glb) {
    const MaterialId plaster = glb.material("plaster", srgb(0x9fb0a2));
    const MaterialId trim = glb.material("trim", srgb(0xe6dcc6));
    const MaterialId panel = glb.material("panel", srgb(0x5f7a74));
    const MaterialId beam = glb.material("beam", srgb(0x6a4a33));
    const int room = glb.node("room", -1, glm::vec3(0.0f));

    Mesh floor;
    append(floor, make_floor(), {}, kPaintByVertex);
    glb.node("floor", room, glm::vec3(0.0f), glb.mesh("floor", floor));

    Mesh outside;
    append(outside, make_outside(), {}, kPaintByVertex);
    glb.node("outside", room, glm::vec3(0.0f), glb.mesh("outside", outside));

    // The wall at the back, and two like it turned by a quarter.
    const Opening back_window{-1.72f, -0.62f, 1.02f, 1.92f}, side_window{-1.05f, 0.6f, 0.98f, 1.9f};
    Mesh back, side;
    append(back, make_wall(-kHalfWidth - kThick, kHalfWidth + kThick, kHeight, back_window, kBack - kThick, kBack), {},
           plaster);
    append(back, make_window(back_window, kBack - kThick, kBack), {}, trim);
    append(back, make_wainscot(-kHalfWidth, kHalfWidth, kBack), {}, panel);
    append(back, make_box({-kHalfWidth, 2.32f, kBack}, {kHalfWidth, 2.37f, kBack + 0.03f}), {}, trim);
    glb.node("back wall", room, glm::vec3(0.0f), glb.mesh("back wall", back));

    // In its own space the right wall faces +Z, and x runs to the front.
    append(side, make_wall(kBack, kFront - 1.6f, kHeight, side_window, -kThick, 0.0f), {}, plaster);
    append(side, make_window(side_window, -kThick, 0.0f), {}, trim);
    append(side, make_wainscot(kBack, kFront - 1.6f, 0.0f), {}, panel);
    append(side, make_box({kBack, 2.32f, 0}, {kFront - 1.6f, 2.37f, 0.03f}), {}, trim);
    const Trs right{{kHalfWidth, 0, 0}, glm::angleAxis(glm::radians(-90.0f), glm::vec3(0, 1, 0)), glm::vec3(1)};
    glb.node("right wall", room, right, glb.mesh("right wall", side));

    Mesh left;
    append(left, make_box({kBack - kThick, 0, -kThick}, {kFront - 1.6f, kHeight, 0}), {}, plaster);
    append(left, make_wainscot(kBack, kFront - 1.6f, 0.0f), {}, panel);
    append(left, make_box({kBack, 2.32f, 0}, {kFront - 1.6f, 2.37f, 0.03f}), {}, trim);
    // x runs to the front: turned about +Y by 90 degrees it would run to the back, so the wall is mirrored as well.
    Mesh left_wall;
    const glm::mat3 turn(glm::vec3(0, 0, 1), glm::vec3(0, 1, 0), glm::vec3(1, 0, 0));
    for (const MaterialRange& range : left.materials) {
        Mesh part = left;
        part.corners.assign(left.corners.begin() + range.begin, left.corners.begin() + range.end);
        append(left_wall, part, {turn, {-kHalfWidth, 0, 0}}, range.material);
    }
    glb.node("left wall", room, glm::vec3(0.0f), glb.mesh("left wall", left_wall));

    Mesh roof;
    for (int i = 0; i < 4; ++i) {
        const float x = -1.8f + 1.2f * static_cast<float>(i);
        append(roof, make_box({x - 0.05f, kHeight - 0.15f, kBack}, {x + 0.05f, kHeight, 1.6f}), {}, beam);
    }
    for (const float z : {kBack + 0.05f, -0.6f, 0.9f}) {
        append(roof, make_box({-kHalfWidth, kHeight, z - 0.05f}, {kHalfWidth, kHeight + 0.1f, z + 0.05f}), {}, beam);
    }
    glb.node("rafters", room, glm::vec3(0.0f), glb.mesh("rafters", roof));
}

}  // namespace zoe
