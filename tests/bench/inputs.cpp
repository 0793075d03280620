#include "tests/bench/inputs.h"

#include <cmath>
#include <map>

#include <glm/geometric.hpp>

#include "content/content.h"
#include "content/shapes.h"
#include "engine/frame/frame.h"
#include "engine/math/rng.h"
#include "tests/math/random_inputs.h"

namespace zoe::test {

namespace {

struct WorldMesh {
    std::vector<glm::vec3> positions;
    std::vector<glm::uvec3> corners;
};

/// All of a scene's triangles, in world space.
WorldMesh world_mesh(Content& content, double time_s) {
    if (content.write) content.write(content.scene, time_s);
    WorldMesh mesh;
    for (const Instance& instance : advance(content.scene, time_s).instances) {
        const auto first = static_cast<uint32_t>(mesh.positions.size());
        for (const glm::vec3& p : instance.positions) mesh.positions.push_back(instance.world_from_local.point(p));
        for (const glm::uvec3& c : instance.mesh->corners) mesh.corners.push_back(c + first);
    }
    return mesh;
}

BenchMesh from_content(const char* content_name, int size, double rest_s, double time_s) {
    Content content = make_content(content_name, size);
    WorldMesh rest = world_mesh(content, rest_s), mesh = world_mesh(content, time_s);
    return {"", std::move(rest.positions), std::move(mesh.positions), std::move(mesh.corners)};
}

BenchMesh waving_torus() {
    const Mesh torus = make_torus(1.0f, 0.4f, 400, 100);
    BenchMesh mesh{"", torus.positions, torus.positions, torus.corners};
    for (glm::vec3& p : mesh.positions) p.y += 0.1f * std::sin(5.0f * p.x) + 0.1f * std::sin(4.0f * p.z);
    return mesh;
}

BenchMesh make_mesh(const std::string& name) {
    if (name == "torus") return waving_torus();
    if (name == "room") return from_content("static", 72000, 0.0, 0.0);
    return from_content("arbitrary", 20000, 0.0, 2.0);
}

}  // namespace

std::vector<Aabb> BenchMesh::boxes() const {
    std::vector<Aabb> result;
    for (const glm::uvec3& c : corners)
        result.push_back(bounds(Triangle{positions[c.x], positions[c.y], positions[c.z], 0}));
    return result;
}

const BenchMesh& mesh_named(const std::string& name) {
    static std::map<std::string, BenchMesh> meshes;
    const auto found = meshes.find(name);
    if (found != meshes.end()) return found->second;
    BenchMesh& mesh = meshes[name] = make_mesh(name);
    mesh.name = name;
    return mesh;
}

std::vector<Ray> coherent_rays(const Aabb& box, int side) {
    const glm::vec3 target = box.centre(), eye = target + glm::vec3(0.1f, 0.6f, 1.6f) * (0.5f * box.extent());
    const glm::vec3 forward = glm::normalize(target - eye);
    const glm::vec3 right = glm::normalize(glm::cross(forward, glm::vec3(0, 1, 0))), up = glm::cross(right, forward);
    std::vector<Ray> rays;
    for (int y = 0; y < side; ++y) {
        for (int x = 0; x < side; ++x) {
            const float u = (static_cast<float>(x) + 0.5f) / static_cast<float>(side) - 0.5f;
            const float v = 0.5f - (static_cast<float>(y) + 0.5f) / static_cast<float>(side);
            rays.push_back({.origin = eye, .direction = forward + u * right + v * up});
        }
    }
    return rays;
}

std::vector<Ray> incoherent_rays(const Aabb& box, int count) {
    Rng rng(31);
    std::vector<Ray> rays;
    for (int k = 0; k < count; ++k) {
        const glm::vec3 inside = 0.5f * (random_point(rng, 1.0f) * box.extent());
        rays.push_back({.origin = box.centre() + inside, .direction = random_direction(rng)});
    }
    return rays;
}

}  // namespace zoe::test
