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

}  // namespace

// A room 8 m wide: half of its triangles are poles that lean at all angles and boards along the floor and walls, long and
// thin, which split planes cannot part; the rest are small balls among them.
void add_slats(Scene& scene, int triangle_count) {
    Rng rng(2024);
    const MaterialId wood = add_color(scene, "boards", 0xa47c52), iron = add_color(scene, "poles", 0x4c5a66);
    const MaterialId glazed = add_color(scene, "balls", 0xc46a4a), lime = add_color(scene, "walls", 0xd8d0c0);
    Mesh walls, boards, poles, balls;
    append(walls, make_box({-4, -0.1f, -4}, {4, 0, 4}), {}, lime);
    append(walls, make_box({-4, 0, -4.1f}, {4, 4, -4}), {}, lime);
    append(walls, make_box({-4.1f, 0, -4}, {-4, 4, 4}), {}, lime);

    const int board_count = std::max(1, triangle_count / 48);
    const float width = 8.0f / static_cast<float>(board_count);
    for (int i = 0; i < board_count; ++i) {
        const float x = -4.0f + width * static_cast<float>(i);
        append(boards, make_box({x + 0.1f * width, 0, -4}, {x + 0.9f * width, 0.02f, 4}), {}, wood);
    }
    const int pole_count = std::max(1, triangle_count / 48);
    for (int i = 0; i < pole_count; ++i) {
        const float length = rng.uniform(1.0f, 3.5f), thick = rng.uniform(0.004f, 0.02f);
        const glm::vec3 middle(rng.uniform(-3, 3), rng.uniform(0.8f, 3), rng.uniform(-3, 3));
        const glm::vec3 axis(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1) + 1e-3f);
        append(poles, make_box({-thick, -0.5f * length, -thick}, {thick, 0.5f * length, thick}),
               at(middle, rng.uniform(0, 360), axis), iron);
    }
    const Mesh ball = make_sphere(1.0f, 10, 6);
    const int ball_count = std::max(1, triangle_count / (2 * static_cast<int>(ball.corners.size())));
    for (int i = 0; i < ball_count; ++i) {
        const glm::vec3 middle(rng.uniform(-3.7f, 3.7f), rng.uniform(0.1f, 3), rng.uniform(-3.7f, 3.7f));
        append(balls, ball, at(middle, 0.0f, {0, 1, 0}, glm::vec3(rng.uniform(0.03f, 0.12f))), glazed);
    }
    scene.add(shown("walls", scene.add(std::move(walls))));
    scene.add(shown("boards", scene.add(std::move(boards))));
    scene.add(shown("poles", scene.add(std::move(poles))));
    scene.add(shown("balls", scene.add(std::move(balls))));
}

Content make_static_scene(int size) {
    Content content;
    add_slats(content.scene, size);
    return content;
}

}  // namespace zoe
