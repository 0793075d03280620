#include "engine/render/tangent_frame.h"

#include <cmath>

#include <gtest/gtest.h>
#include <glm/gtc/quaternion.hpp>

#include "engine/math/rng.h"
#include "engine/scene/tangents.h"
#include "tests/render/scenes.h"

namespace zoe::test {
namespace {

TEST(TangentFrame, IsSmoothBesideMirroredSeams) {
    const uint64_t seed = 31;
    SCOPED_TRACE(seed);
    Rng rng(seed);
    Scene scene;
    Mesh mesh;
    constexpr uint32_t kSide = 7;
    for (uint32_t j = 0; j < kSide; ++j) {
        for (uint32_t i = 0; i < kSide; ++i) {
            const float x = static_cast<float>(i), y = static_cast<float>(j);
            mesh.positions.emplace_back(x + rng.uniform(-0.2f, 0.2f), y + rng.uniform(-0.2f, 0.2f),
                                        rng.uniform(-0.2f, 0.2f));
            mesh.normals.push_back(glm::normalize(glm::vec3(rng.uniform(-0.2f, 0.2f), rng.uniform(-0.2f, 0.2f), 1)));
            mesh.uvs[0].emplace_back(std::abs(x - 3.0f), rng.uniform(-0.2f, 0.2f) - y);
            if (i == 0 || j == 0) continue;
            const uint32_t d = j * kSide + i, c = d - 1, b = d - kSide, a = b - 1;
            mesh.corners.insert(mesh.corners.end(), {{a, b, d}, {a, d, c}});
        }
    }
    mesh.materials = {{0, static_cast<uint32_t>(mesh.corners.size()), kNone<MaterialId>}};
    derive_tangents(&mesh, mesh.materials[0], 0);
    add_node(scene, std::move(mesh));
    const Tlas& tlas = advance(scene, 0.0);
    Instance instance = tlas.instances[0];
    const std::vector<glm::uvec3>& corners = scene.meshes[0].corners;
    const glm::mat3 turn = glm::mat3_cast(glm::angleAxis(0.7f, glm::normalize(glm::vec3(1, -2, 3))));
    std::vector<glm::vec3> moved;
    for (const glm::vec3& p : scene.meshes[0].positions) moved.push_back(turn * p);
    instance.positions = moved;
    const auto frame_at = [&](uint32_t triangle, uint32_t one, uint32_t other) {
        glm::vec3 weights(0.0f);
        for (int k = 0; k < 3; ++k) {
            if (corners[triangle][k] == one || corners[triangle][k] == other) weights[k] = 0.5f;
        }
        const std::vector<glm::vec3>& normals = scene.meshes[0].normals;
        return tangent_frame(instance, triangle, weights, 0, glm::normalize(turn * (normals[one] + normals[other])));
    };
    // Two triangles agree on their edge; along the seam, where x is 3, u turns round.
    int smooth = 0, mirrored = 0;
    for (uint32_t t = 0; t < corners.size(); ++t) {
        for (uint32_t other = t + 1; other < corners.size(); ++other) {
            std::vector<uint32_t> shared;
            for (int k = 0; k < 9; ++k) {
                if (corners[t][k / 3] == corners[other][k % 3]) shared.push_back(corners[t][k / 3]);
            }
            if (shared.size() != 2) continue;
            const bool is_seam = shared[0] % kSide == 3 && shared[1] % kSide == 3;
            ++(is_seam ? mirrored : smooth);
            const TangentFrame one = frame_at(t, shared[0], shared[1]), two = frame_at(other, shared[0], shared[1]);
            if (is_seam) {
                EXPECT_LT(glm::dot(one.x, two.x), -0.7f);
                EXPECT_GT(glm::dot(one.y, two.y), 0.7f);
            } else {
                EXPECT_LT(glm::distance(one.x, two.x), 1e-4f) << shared[0] << ", " << shared[1];
                EXPECT_LT(glm::distance(one.y, two.y), 1e-4f) << shared[0] << ", " << shared[1];
            }
        }
    }
    EXPECT_EQ(mirrored, 6);
    EXPECT_GT(smooth, 80);
}

}  // namespace
}  // namespace zoe::test
