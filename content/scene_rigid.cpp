#include <cmath>
#include <numbers>

#include "content/scenes.h"
#include "content/shapes.h"

namespace zoe {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

// Keys of a circle in the XZ plane around a centre, with a rise and fall.
Sampler circle_path(const glm::vec3& centre, float radius, float rise, float phase) {
    Sampler sampler{.width = 3};
    for (int k = 0; k <= 32; ++k) {
        const float share = static_cast<float>(k) / 32.0f, angle = 2.0f * kPi * (share + phase);
        sampler.times_s.push_back(static_cast<float>(kLoop_s) * share);
        sampler.values.insert(sampler.values.end(),
                              {centre.x + radius * std::cos(angle), centre.y + rise * std::sin(2.0f * angle),
                               centre.z + radius * std::sin(angle)});
    }
    return sampler;
}

}  // namespace

Lattice orbit_lattice(int copy_count) {
    return make_lattice(copy_count, 0.9f);
}

// One torus of 1,000 triangles; each copy goes round a circle of its own and turns.
void add_orbits(Scene& scene, int copy_count, const Trs& placed) {
    Mesh torus = make_torus(0.3f, 0.12f, 25, 20);
    torus.name = "torus";
    set_material(torus, add_color(scene, "torus", 0xc08a3e));
    const MeshId mesh = scene.add(std::move(torus));
    Node swarm;
    swarm.name = "swarm";
    swarm.local = placed;
    const NodeId swarm_id = scene.add(std::move(swarm));
    const Lattice lattice = orbit_lattice(copy_count);
    for (int i = 0; i < copy_count; ++i) {
        const float phase = 0.381966f * static_cast<float>(i);
        Node node;
        node.name = "orbit " + std::to_string(i);
        node.parent = swarm_id;
        node.mesh = mesh;
        const NodeId id = scene.add(std::move(node));
        const glm::vec3 axis(std::cos(phase), std::sin(phase), 0);
        add_channel(scene, id, ChannelPath::kTranslation,
                    add_sampler(scene, circle_path(lattice.place(i), 0.25f, 0.2f, phase)));
        add_channel(scene, id, ChannelPath::kRotation, add_sampler(scene, spin(axis, 1 + i % 3, 40.0f * phase)));
    }
}

Content make_rigid_scene(int size) {
    Content content;
    add_orbits(content.scene, size, Trs{});
    add_view(content.scene, orbit_lattice(size));
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
    const Lattice lattice = make_lattice(size, 0.6f);
    NodeId row = kNone<NodeId>;
    for (int i = 0; i < size; ++i) {
        const int row_index = i / lattice.count.x;
        const glm::vec3 place = lattice.place(i), centre(0, place.y, place.z);
        if (i % lattice.count.x == 0) {
            const float phase = 0.381966f * static_cast<float>(row_index);
            Node parent;
            parent.name = "row " + std::to_string(row_index);
            row = scene.add(std::move(parent));
            add_channel(scene, row, ChannelPath::kTranslation, add_sampler(scene, circle_path(centre, 0.3f, 0.2f, phase)));
        }
        Node node;
        node.name = "seed " + std::to_string(i);
        node.parent = row;
        node.mesh = mesh;
        node.local.translation = place - centre;
        add_channel(scene, scene.add(std::move(node)), ChannelPath::kRotation, turns[(i * 5 + row_index) % 8]);
    }
    add_view(scene, lattice);
    return content;
}

}  // namespace zoe
