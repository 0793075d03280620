#pragma once

#include "engine/frame/build_tlas.h"
#include "engine/scene/mesh.h"

namespace zoe {

/// All triangles of a frame as one mesh in the world, at node 0.
class WorldMesh {
public:
    explicit WorldMesh(const Tlas& tlas) {
        for (const Instance& instance : tlas.instances) {
            const auto first = static_cast<uint32_t>(mesh_.positions.size());
            for (const glm::vec3& p : instance.positions) mesh_.positions.push_back(instance.world_from_local.point(p));
            for (const glm::uvec3& c : instance.mesh->corners) mesh_.corners.push_back(c + first);
        }
    }

    std::span<const glm::vec3> positions() const { return mesh_.positions; }
    std::span<const glm::uvec3> corners() const { return mesh_.corners; }
    Triangle triangle(uint32_t primitive) const {
        const glm::uvec3& c = mesh_.corners[primitive];
        return {mesh_.positions[c.x], mesh_.positions[c.y], mesh_.positions[c.z], primitive};
    }

    /// As a frame that shows nothing else, for `judge`: without trees. Valid as long as this is.
    Tlas as_frame() const {
        Tlas tlas;
        tlas.instances.push_back({.node = NodeId{0}, .is_identity = true, .mesh = &mesh_, .positions = mesh_.positions});
        return tlas;
    }

private:
    Mesh mesh_;
};

}  // namespace zoe
