#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "content/scenes.h"
#include "content/shapes.h"

namespace zoe {

Clip& loop_of(Scene& scene) {
    if (scene.clips.empty()) {
        scene.clips.push_back({.name = "loop", .samplers = {}, .channels = {}, .duration_s = kLoop_s});
        scene.playback.clips = {ClipId{0}};
    }
    return scene.clips.front();
}

uint32_t add_sampler(Scene& scene, Sampler sampler) {
    Clip& clip = loop_of(scene);
    clip.samplers.push_back(std::move(sampler));
    return static_cast<uint32_t>(clip.samplers.size() - 1);
}

void add_channel(Scene& scene, NodeId node, ChannelPath path, uint32_t sampler) {
    loop_of(scene).channels.push_back({node, path, sampler});
}

Sampler spin(const glm::vec3& axis, int turns, float degrees) {
    Sampler sampler{.is_rotation = true, .width = 4};
    const int keys = 4 * std::abs(turns);  // A quarter turn apart: the short way is the right way.
    for (int k = 0; k <= keys; ++k) {
        const double share = static_cast<double>(k) / keys;
        const double half = std::numbers::pi * (degrees / 360.0 + turns * share);
        const glm::vec3 v = static_cast<float>(std::sin(half)) * axis;
        sampler.times_s.push_back(static_cast<float>(kLoop_s * share));
        sampler.values.insert(sampler.values.end(), {v.x, v.y, v.z, static_cast<float>(std::cos(half))});
    }
    return sampler;
}

MaterialId add_color(Scene& scene, const char* name, uint32_t srgb_hex) {
    Material material;
    material.name = name;
    material.base_color = glm::vec4(srgb(srgb_hex), 1.0f);
    material.is_double_sided = true;
    return scene.add(material);
}

void set_material(Mesh& mesh, MaterialId material) {
    mesh.materials = {{0, static_cast<uint32_t>(mesh.corners.size()), material}};
}

void add_view(Scene& scene, const glm::vec3& eye, const glm::vec3& target, float fov_degrees) {
    Camera camera;
    camera.name = "view";
    camera.yfov = glm::radians(fov_degrees);
    Node node;
    node.name = camera.name;
    node.local.translation = eye;
    node.local.rotation = glm::quatLookAt(glm::normalize(target - eye), glm::vec3(0, 1, 0));
    node.camera = CameraId{static_cast<uint32_t>(scene.cameras.size())};
    scene.cameras.push_back(std::move(camera));
    scene.add(std::move(node));
}

glm::vec3 Lattice::place(int i) const {
    const glm::ivec3 cell(i % count.x, i / count.x % count.y, count.z - 1 - i / (count.x * count.y));  // The front first.
    return pitch * (glm::vec3(cell) - 0.5f * glm::vec3(count - 1));
}

Lattice make_lattice(int point_count, float pitch) {
    const auto holds = [&](const glm::ivec3& n) { return int64_t{n.x} * n.y * n.z >= point_count; };
    Lattice lattice{.count = glm::ivec3(1), .pitch = pitch};
    glm::ivec3& n = lattice.count;
    while (!holds({n.x, n.x, n.x})) ++n.x;
    while (!holds({n.x, n.y, n.y})) ++n.y;
    while (!holds(n)) ++n.z;
    return lattice;
}

void add_view(Scene& scene, const Lattice& lattice) {
    const glm::vec3 half = 0.5f * lattice.extent();
    add_view(scene, half * glm::vec3(0.5f, 0.4f, 1.1f) + glm::vec3(0, 0, 0.3f), half * glm::vec3(-0.2f, -0.2f, -0.5f),
             50.0f);
}

}  // namespace zoe
