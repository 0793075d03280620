#include <cmath>
#include <memory>
#include <numbers>

#include <glm/geometric.hpp>

#include "content/polygonise.h"
#include "content/scenes.h"
#include "content/shapes.h"
#include "engine/math/rng.h"

namespace zoe {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

// Triangles that share no vertices, and how each one flies.
struct Shards {
    struct Flight {
        glm::vec3 middle, velocity, axis;
        float turns;
    };
    std::vector<glm::vec3> rest, positions, normals;  // [3 * triangle_count]
    std::vector<glm::uvec3> corners;
    std::vector<Flight> flights;
};

Shards break_up(const Mesh& mesh, size_t triangle_count) {
    Shards shards;
    Rng rng(77);
    for (size_t i = 0; i < triangle_count; ++i) {
        const glm::uvec3 c = mesh.corners[i % mesh.corners.size()];
        const glm::vec3 middle = (mesh.positions[c.x] + mesh.positions[c.y] + mesh.positions[c.z]) / 3.0f;
        for (int k = 0; k < 3; ++k) shards.rest.push_back(mesh.positions[c[k]]);
        const glm::vec3 noise(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1));
        shards.flights.push_back({middle, rng.uniform(0.3f, 1.0f) * (glm::normalize(middle) + 0.35f * noise),
                                  glm::normalize(noise + glm::vec3(1e-3f)), rng.uniform(-1.5f, 1.5f)});
        const auto first = static_cast<uint32_t>(3 * i);
        shards.corners.push_back({first, first + 1, first + 2});
    }
    shards.positions = shards.rest;
    shards.normals.resize(shards.rest.size());
    return shards;
}

// Out and back over the loop; 0 at its ends.
void fly(Shards& shards, double time_s) {
    const double s = std::sin(std::numbers::pi * time_s / kLoop_s);
    const auto away = static_cast<float>(s * s);
    for (size_t i = 0; i < shards.flights.size(); ++i) {
        const Shards::Flight& flight = shards.flights[i];
        const glm::quat turn = glm::angleAxis(2.0f * kPi * flight.turns * away, flight.axis);
        const glm::vec3 middle = flight.middle + away * flight.velocity;
        glm::vec3* p = &shards.positions[3 * i];
        for (size_t k = 0; k < 3; ++k) p[k] = middle + turn * (shards.rest[3 * i + k] - flight.middle);
        const glm::vec3 n = glm::cross(p[1] - p[0], p[2] - p[0]);
        for (size_t k = 0; k < 3; ++k) shards.normals[3 * i + k] = n;
    }
}

}  // namespace

std::function<void(Scene&, double)> add_explosion(Scene& scene, int triangle_count, const Trs& placed) {
    const int rings = std::max(3, static_cast<int>(std::lround(std::sqrt(static_cast<float>(triangle_count) / 4.0f))));
    const Mesh ball = make_sphere(0.8f, 2 * rings, rings + 1);  // 4 rings^2 triangles.
    auto shards = std::make_shared<Shards>(break_up(ball, static_cast<size_t>(triangle_count)));
    Mesh mesh;
    mesh.name = "shards";
    set_material(mesh, add_color(scene, "shards", 0xa8483f));
    Node node;
    node.name = "shards";
    node.local = placed;
    const MeshId id = scene.add(std::move(mesh));
    node.mesh = id;
    scene.add(std::move(node));
    const auto write = [shards, id](Scene& written, double time_s) {
        fly(*shards, time_s);
        written.write_mesh(id, shards->positions, shards->normals, shards->corners);
    };
    write(scene, 0.0);
    return write;
}

Content make_arbitrary_scene(int size) {
    Content content;
    content.write = add_explosion(content.scene, size, Trs{});
    add_view(content.scene, {0.25f, 0.3f, 1.15f}, glm::vec3(0.0f), 50.0f);
    return content;
}

// Seven drops that meet and part; the number of vertices and triangles is another one in nearly every frame.
Content make_topology_scene(int size) {
    constexpr int kDrops = 7;
    Content content;
    Mesh mesh;
    mesh.name = "drops";
    set_material(mesh, add_color(content.scene, "drops", 0x5a86a8));
    const MeshId id = content.scene.add(std::move(mesh));
    Node node;
    node.name = "drops";
    node.mesh = id;
    content.scene.add(std::move(node));
    content.write = [id, size](Scene& scene, double time_s) {
        glm::vec3 centres[kDrops];
        for (int i = 0; i < kDrops; ++i) {
            const float turn = static_cast<float>(2.0 * std::numbers::pi * time_s / kLoop_s),
                        phase = 2.0f * kPi * static_cast<float>(i) / kDrops;
            centres[i] =
                0.55f * glm::vec3(std::sin(turn + phase), std::cos(2 * turn + 1.7f * phase), std::sin(turn - 2 * phase));
        }
        const auto field = [&](const glm::vec3& p) {
            float sum = 0.0f;
            for (const glm::vec3& c : centres) sum += 0.05f / (glm::dot(p - c, p - c) + 0.02f);
            return 1.0f - sum;
        };
        const Mesh drops = polygonise(field, {glm::vec3(-1.4f), glm::vec3(1.4f)}, 2.8f / static_cast<float>(size));
        scene.write_mesh(id, drops.positions, drops.normals, drops.corners);
    };
    content.write(content.scene, 0.0);
    add_view(content.scene, {0.3f, 0.4f, 1.6f}, glm::vec3(0.0f), 36.0f);
    return content;
}

}  // namespace zoe
