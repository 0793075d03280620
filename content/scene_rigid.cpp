#include <cmath>
#include <numbers>

#include "content/scenes.h"
#include "content/shapes.h"

namespace zoe {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

// Keys of a circle in the XZ plane around a centre, with a rise and fall.
Sampler circle_path(const glm::vec3& centre, float radius, float phase) {
    Sampler sampler{.width = 3};
    for (int k = 0; k <= 32; ++k) {
        const float share = static_cast<float>(k) / 32.0f, angle = 2.0f * kPi * (share + phase);
        sampler.times_s.push_back(static_cast<float>(kLoop_s) * share);
        sampler.values.insert(sampler.values.end(),
                              {centre.x + radius * std::cos(angle), centre.y + 0.3f * std::sin(2.0f * angle),
                               centre.z + radius * std::sin(angle)});
    }
    return sampler;
}

}  // namespace

// One torus of 1,000 triangles; each copy goes round a circle of its own and turns.
void add_orbits(Scene& scene, int copy_count) {
    Mesh torus = make_torus(0.3f, 0.12f, 25, 20);
    torus.name = "torus";
    set_material(torus, add_color(scene, "torus", 0xc08a3e));
    const MeshId mesh = scene.add(std::move(torus));
    const int side = std::max(1, static_cast<int>(std::ceil(std::sqrt(static_cast<float>(copy_count)))));
    for (int i = 0; i < copy_count; ++i) {
        const auto column = static_cast<float>(i % side), row = static_cast<float>(i / side);
        const float middle = 0.5f * static_cast<float>(side - 1), phase = 0.381966f * static_cast<float>(i);
        Node node;
        node.name = "orbit " + std::to_string(i);
        node.mesh = mesh;
        const NodeId id = scene.add(std::move(node));
        const glm::vec3 centre(1.3f * (column - middle), 1.5f, 1.3f * (row - middle)),
            axis(std::cos(phase), std::sin(phase), 0);
        add_channel(scene, id, ChannelPath::kTranslation, add_sampler(scene, circle_path(centre, 0.4f, phase)));
        add_channel(scene, id, ChannelPath::kRotation, add_sampler(scene, spin(axis, 1 + i % 3, 40.0f * phase)));
    }
}

Content make_rigid_scene(int size) {
    Content content;
    add_orbits(content.scene, size);
    return content;
}

// Rows that slide, and in each row copies of an 80-triangle ball that is drawn out, so that its turning shows.
Content make_instances_scene(int size) {
    Content content;
    Scene& scene = content.scene;
    Mesh seed;
    append(seed, make_sphere(1.0f, 10, 5), at(glm::vec3(0), 0.0f, {0, 1, 0}, {0.3f, 0.12f, 0.2f}));
    seed.name = "seed";
    set_material(seed, add_color(scene, "seed", 0x6f9a6a));
    const MeshId mesh = scene.add(std::move(seed));
    uint32_t turns[8];
    for (int k = 0; k < 8; ++k) {
        const float phase = static_cast<float>(k) / 8.0f;
        turns[k] = add_sampler(
            scene, spin(glm::vec3(std::sin(2 * kPi * phase), std::cos(2 * kPi * phase), 0), 1 + k % 2, 360 * phase));
    }
    const int side = std::max(1, static_cast<int>(std::ceil(std::sqrt(static_cast<float>(size)))));
    const float middle = 0.5f * static_cast<float>(side - 1);
    NodeId row = kNone<NodeId>;
    for (int i = 0; i < size; ++i) {
        const int column = i % side;
        if (column == 0) {
            const float phase = static_cast<float>(i / side) / static_cast<float>(side);
            Node parent;
            parent.name = "row " + std::to_string(i / side);
            row = scene.add(std::move(parent));
            const glm::vec3 centre(0, 0.5f * std::sin(2 * kPi * phase), 0.6f * (static_cast<float>(i / side) - middle));
            add_channel(scene, row, ChannelPath::kTranslation, add_sampler(scene, circle_path(centre, 0.5f, phase)));
        }
        Node node;
        node.name = "seed " + std::to_string(i);
        node.parent = row;
        node.mesh = mesh;
        node.local.translation = {0.6f * (static_cast<float>(column) - middle), 0, 0};
        add_channel(scene, scene.add(std::move(node)), ChannelPath::kRotation, turns[(i * 5 + i / side) % 8]);
    }
    return content;
}

}  // namespace zoe
