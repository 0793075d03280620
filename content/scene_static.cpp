#include <algorithm>
#include <cmath>

#include "content/scenes.h"
#include "content/shapes.h"
#include "engine/math/rng.h"

namespace zoe {
namespace {

Node shown(const char* name, MeshId mesh) {
    Node node;
    node.name = name;
    node.mesh = mesh;
    return node;
}

constexpr float kHalf = 4.0f, kHeight = 4.0f;  // Of the room, metres.

// Boards side by side across a surface of the room: from wall to wall along its Z, spread over its X, standing out along Y.
struct Panelling {
    float span, length;
    float cover;  // Share of the surface that boards cover.
    Affine placed;
};

void add_boards(Mesh& boards, const Panelling& panelling, int count, MaterialId material) {
    const float pitch = panelling.span / static_cast<float>(count);
    const glm::vec3 half(0.5f * panelling.cover * pitch, 0.0f, 0.5f * panelling.length);
    // A little off the surface: what lies in a plane with it could be hit by either.
    const glm::vec3 off(0, 0.1f * pitch, 0);
    const Mesh board = make_box(off - half, off + half + glm::vec3(0, 0.25f * pitch, 0));
    for (int i = 0; i < count; ++i) {
        const float x = pitch * (static_cast<float>(i) + 0.5f) - 0.5f * panelling.span;
        append(boards, board, panelling.placed * at({x, 0, 0}), material);
    }
}

}  // namespace

// One triangle in ten is of a pole that leans at any angle or of a board along floor, walls and ceiling, long and thin,
// which split planes cannot part; the rest are balls, most of them near the floor. The more there are, the smaller and the
// rounder: one can look through the room at any size.
void add_room(Scene& scene, int triangle_count) {
    Rng rng(2024);
    const MaterialId wood = add_color(scene, "boards", 0xa47c52), iron = add_color(scene, "poles", 0x4c5a66);
    const MaterialId glazed = add_color(scene, "balls", 0xc46a4a), lime = add_color(scene, "walls", 0xd8d0c0);
    Mesh walls, boards, poles, balls;
    append(walls, make_box({-kHalf, -0.1f, -kHalf}, {kHalf, 0, kHalf}), {}, lime);
    append(walls, make_box({-kHalf, 0, -kHalf - 0.1f}, {kHalf, kHeight, -kHalf}), {}, lime);
    append(walls, make_box({-kHalf - 0.1f, 0, -kHalf}, {-kHalf, kHeight, kHalf}), {}, lime);
    append(walls, make_box({kHalf, 0, -kHalf}, {kHalf + 0.1f, kHeight, kHalf}), {}, lime);

    const Panelling panellings[] = {
        {2 * kHalf, 2 * kHalf, 0.9f, {}},                                             // Floor.
        {2 * kHalf, kHeight, 0.6f, at({0, 0.5f * kHeight, -kHalf}, 90, {1, 0, 0})},   // Back wall.
        {kHeight, 2 * kHalf, 0.6f, at({-kHalf, 0.5f * kHeight, 0}, -90, {0, 0, 1})},  // Left wall.
        {kHeight, 2 * kHalf, 0.6f, at({kHalf, 0.5f * kHeight, 0}, 90, {0, 0, 1})},    // Right wall.
        {2 * kHalf, 2 * kHalf, 0.25f, at({0, kHeight, 0}, 90, {0, 1, 0})},            // Ceiling.
    };
    constexpr int kPanellings = static_cast<int>(std::size(panellings));
    const int board_count = triangle_count / 240 + 1, pole_count = board_count;
    for (int k = 0; k < kPanellings; ++k) {
        const int count = (board_count + kPanellings - 1 - k) / kPanellings;
        if (count > 0) add_boards(boards, panellings[k], count, wood);
    }
    const float scale = std::min(1.0f, std::cbrt(40.0f / static_cast<float>(pole_count)));
    for (int i = 0; i < pole_count; ++i) {
        const float length = scale * rng.uniform(1.0f, 3.5f), thick = scale * rng.uniform(0.004f, 0.02f);
        glm::vec3 middle(0.0f);
        while (std::abs(middle.x) < 2.2f && middle.z > -2.2f)  // Along the walls; the middle stays free.
            middle = {rng.uniform(-3.5f, 3.5f), rng.uniform(0.8f, 3), rng.uniform(-3.5f, 3.0f)};
        const glm::vec3 axis(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1) + 1e-3f);
        append(poles, make_box({-thick, -0.5f * length, -thick}, {thick, 0.5f * length, thick}),
               at(middle, rng.uniform(0, 360), axis), iron);
    }
    const int rings = std::max(3, static_cast<int>(std::lround(0.12f * std::cbrt(static_cast<float>(triangle_count)))));
    const Mesh ball = make_sphere(1.0f, 2 * rings, rings + 1);
    const int left_count = triangle_count - 12 * (board_count + pole_count);
    const int ball_count = std::max(0, left_count) / static_cast<int>(ball.corners.size()) + 1;
    for (int i = 0; i < ball_count; ++i) {
        const float rise = rng.uniform();  // Most lie near the floor.
        const glm::vec3 middle(rng.uniform(-3.7f, 3.7f), 0.05f + 2.5f * std::pow(rise, 8.0f), rng.uniform(-3.7f, 3.7f));
        append(balls, ball, at(middle, 0.0f, {0, 1, 0}, glm::vec3(scale * rng.uniform(0.03f, 0.12f))), glazed);
    }
    scene.add(shown("walls", scene.add(std::move(walls))));
    scene.add(shown("boards", scene.add(std::move(boards))));
    scene.add(shown("poles", scene.add(std::move(poles))));
    scene.add(shown("balls", scene.add(std::move(balls))));
}

Content make_static_scene(int size) {
    Content content;
    add_room(content.scene, size);
    add_view(content.scene, {1.4f, 1.9f, 3.9f}, {-0.6f, 1.5f, -2.0f}, 60.0f);
    return content;
}

}  // namespace zoe
