#pragma once

#include <glm/gtc/quaternion.hpp>

#include "content/content.h"

namespace zoe::test {

/// A floor seen from above, and a lid close over it that the two cameras look under; it goes away at once when it opens.
struct LidScene {
    static constexpr double kOpensS = 2.0;
    Content content;
    NodeId floor, lid, cameras[2];

    LidScene() {
        Scene& scene = content.scene;
        Material white;
        white.metallic = 0.0f;
        white.is_double_sided = true;
        const MaterialId material = scene.add(white);
        const auto add_square = [&](const char* name, float size, float height) {
            Mesh mesh;
            mesh.positions = {{-size, 0, -size}, {size, 0, -size}, {size, 0, size}, {-size, 0, size}};
            mesh.corners = {{0, 2, 1}, {0, 3, 2}};
            mesh.materials = {{0, 2, material}};
            Node node;
            node.name = name;
            node.mesh = scene.add(std::move(mesh));
            node.local.translation.y = height;
            return scene.add(std::move(node));
        };
        floor = add_square("floor", 4.0f, 0.0f);
        lid = add_square("lid", 40.0f, 3.0f);
        scene.cameras.push_back({});
        for (NodeId& camera : cameras) {
            Node node;
            node.camera = CameraId{0};
            node.local.translation = {0.0f, 2.5f, 0.0f};
            node.local.rotation = glm::angleAxis(-1.5707963f, glm::vec3(1, 0, 0));
            camera = scene.add(std::move(node));
        }
        content.write = [this](Scene& written, double time_s) {
            written[lid].local.translation.y = time_s < kOpensS ? 3.0f : -1000.0f;
        };
    }
    LidScene(const LidScene&) = delete;
    LidScene& operator=(const LidScene&) = delete;
};

}  // namespace zoe::test
