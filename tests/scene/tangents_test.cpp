#include "engine/scene/tangents.h"

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "engine/math/rng.h"
#include "tests/scene/glb_builder.h"

namespace zoe::test {
namespace {

/// A strip of squares along x in the plane z = 0, each one unit wide; u follows `u_of`, v falls from 1 at y = 0 to 0 at y
/// = 1.
template <typename U>
Mesh strip(int square_count, U&& u_of) {
    Mesh mesh;
    for (int i = 0; i <= square_count; ++i) {
        for (int j = 0; j < 2; ++j) {
            mesh.positions.emplace_back(i, j, 0);
            mesh.normals.emplace_back(0, 0, 1);
            mesh.uvs[0].emplace_back(u_of(i), 1 - j);
        }
        if (i == 0) continue;
        const uint32_t a = static_cast<uint32_t>(2 * i - 2);
        mesh.corners.emplace_back(a, a + 2, a + 3);
        mesh.corners.emplace_back(a, a + 3, a + 1);
    }
    mesh.materials = {{0, static_cast<uint32_t>(mesh.corners.size()), kNone<MaterialId>}};
    return mesh;
}

/// By triangle and corner.
glm::vec4 tangent_at(const Mesh& mesh, size_t triangle, int corner) {
    return mesh.tangents[tangents_of(mesh, static_cast<uint32_t>(triangle))[corner]];
}

TEST(Tangents, FollowUAndTheBitangentRises) {
    Mesh mesh = strip(4, [](int i) { return 0.25f * static_cast<float>(i); });
    derive_tangents(&mesh, mesh.materials[0], 0);
    for (size_t i = 0; i < 3 * mesh.corners.size(); ++i) {
        const glm::vec4 tangent = tangent_at(mesh, i / 3, static_cast<int>(i % 3));
        EXPECT_LT(glm::distance(glm::vec3(tangent), glm::vec3(1, 0, 0)), 1e-6f);
        const glm::vec3 bitangent = tangent.w * glm::cross(glm::vec3(0, 0, 1), glm::vec3(tangent));
        EXPECT_LT(glm::distance(bitangent, glm::vec3(0, 1, 0)), 1e-6f);  // v falls that way
    }
}

TEST(Tangents, ATextureAndItsMirrorImageHaveTheirOwnWhereTheyMeet) {
    Mesh mesh = strip(4, [](int i) { return 0.25f * std::abs(static_cast<float>(i - 2)); });
    derive_tangents(&mesh, mesh.materials[0], 0);
    for (size_t t = 0; t < mesh.corners.size(); ++t) {
        const glm::vec4 expected = t < 4 ? glm::vec4(-1, 0, 0, -1) : glm::vec4(1, 0, 0, 1);
        for (int k = 0; k < 3; ++k) EXPECT_EQ(tangent_at(mesh, t, k), expected) << t;
    }
    EXPECT_EQ(mesh.positions.size(), 10u) << "no vertex is split";
}

TEST(Tangents, SplitVerticesCountAsOneAndScaleDoesNotMatter) {
    const uint64_t seed = 51;
    SCOPED_TRACE(seed);
    Rng rng(seed);
    for (float scale : {1e-6f, 1.0f, 1e6f}) {
        Mesh mesh = strip(6, [](int i) { return 0.1f * static_cast<float>(i); });
        for (glm::vec3& p : mesh.positions) p = scale * (p + glm::vec3(0, 0, rng.uniform(-0.2f, 0.2f)));
        for (glm::vec3& n : mesh.normals)
            n = glm::normalize(glm::vec3(rng.uniform(-0.3f, 0.3f), rng.uniform(-0.3f, 0.3f), 1));
        Mesh split;
        for (const glm::uvec3& c : mesh.corners) {
            const uint32_t first = static_cast<uint32_t>(split.positions.size());
            for (int i = 0; i < 3; ++i) {
                split.positions.push_back(mesh.positions[c[i]]);
                split.normals.push_back(mesh.normals[c[i]]);
                split.uvs[0].push_back(mesh.uvs[0][c[i]]);
            }
            split.corners.emplace_back(first, first + 1, first + 2);
        }
        derive_tangents(&mesh, mesh.materials[0], 0);
        derive_tangents(&split, mesh.materials[0], 0);
        for (size_t t = 0; t < mesh.corners.size(); ++t) {
            for (int i = 0; i < 3; ++i) {
                const glm::vec4 one = tangent_at(mesh, t, i);
                EXPECT_EQ(tangent_at(split, t, i), one);
                EXPECT_NEAR(glm::length(glm::vec3(one)), 1.0f, 1e-5f);
                EXPECT_NEAR(glm::dot(glm::vec3(one), mesh.normals[mesh.corners[t][i]]), 0.0f, 1e-5f);
            }
        }
    }
}

TEST(Tangents, WithoutAreaInTheTextureThereAreNone) {
    Mesh mesh = strip(2, [](int) { return 0.5f; });
    derive_tangents(&mesh, mesh.materials[0], 0);
    for (const glm::vec4& tangent : mesh.tangents) EXPECT_EQ(tangent, glm::vec4(0.0f));
}

TEST(Tangents, AreReadFromFilesAndDerivedWhereANormalTextureNeedsThem) {
    const std::vector<float> positions = {0, 0, 0, 1, 0, 0, 0, 1, 0}, normals = {0, 0, 1, 0, 0, 1, 0, 0, 1};
    const std::vector<float> uvs = {0, 1, 1, 1, 0, 0}, tangents = {0, 1, 0, -1, 0, 1, 0, -1, 0, 1, 0, -1};
    for (bool has_tangents : {true, false}) {
        for (bool has_texture : {true, false}) {
            GlbBuilder glb;
            glb.push("images", {{"uri", "missing.png"}});
            glb.push("textures", {{"source", 0}});
            glb.push("materials",
                     has_texture ? nlohmann::json{{"normalTexture", {{"index", 0}}}} : nlohmann::json::object());
            nlohmann::json attributes = {{"POSITION", glb.floats(positions, "VEC3")},
                                         {"NORMAL", glb.floats(normals, "VEC3")},
                                         {"TEXCOORD_0", glb.floats(uvs, "VEC2")}};
            if (has_tangents) attributes["TANGENT"] = glb.floats(tangents, "VEC4");
            glb.mesh({{"attributes", attributes}, {"material", 0}});
            const Mesh mesh = std::move(glb.load().meshes[0]);
            EXPECT_EQ(mesh.tangent_corners.empty(), has_tangents || !has_texture);
            ASSERT_EQ(mesh.tangents.empty(), !has_tangents && !has_texture);
            if (mesh.tangents.empty()) continue;
            for (int k = 0; k < 3; ++k) {
                EXPECT_EQ(tangent_at(mesh, 0, k), has_tangents ? glm::vec4(0, 1, 0, -1) : glm::vec4(1, 0, 0, 1));
            }
        }
    }
}

}  // namespace
}  // namespace zoe::test
