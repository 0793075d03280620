// Tangents against MikkTSpace's definition, by brute force in double precision.

#include <array>
#include <optional>

#include <gtest/gtest.h>
#include <glm/gtc/constants.hpp>
#include <glm/matrix.hpp>

#include "engine/math/rng.h"
#include "engine/scene/tangents.h"

namespace zoe::test {
namespace {

/// The definition, a line at a time; every search looks at everything.
class Oracle {
public:
    struct Tangent {
        glm::dvec4 value{0.0};
        bool is_sure = true;  ///< Else what was added up cancels, and rounding decides.
    };

    Oracle(const Mesh& mesh, int uv_set) : mesh_(mesh), uvs_(mesh.uvs[uv_set]), count_(3 * int(mesh.corners.size())) {
        for (int t = 0; 3 * t < count_; ++t) add_triangle(t);
        pair_edges();
        group();
    }

    Tangent at(int corner) const {
        Tangent own = group_of_[corner] < 0 ? Tangent{} : sum_of(group_of_[corner]);
        for (int c = 0; c < count_; ++c) {
            if (is_same(c, corner) && group_of_[c] >= 0) own.is_sure &= sum_of(group_of_[c]).is_sure;
        }
        for (int c = 0; c < count_ && own.value == glm::dvec4(0.0); ++c) {
            if (is_same(c, corner) && group_of_[c] >= 0) own.value = sum_of(group_of_[c]).value;
        }
        return own;
    }

private:
    static int next(int corner) { return corner / 3 * 3 + (corner + 1) % 3; }
    static int last(int corner) { return corner / 3 * 3 + (corner + 2) % 3; }
    uint32_t vertex(int corner) const { return mesh_.corners[corner / 3][corner % 3]; }
    glm::dvec3 position(int corner) const { return mesh_.positions[vertex(corner)]; }
    glm::dvec2 uv(int corner) const { return uvs_[vertex(corner)]; }
    glm::dvec3 normal(int corner) const { return glm::normalize(glm::dvec3(mesh_.normals[vertex(corner)])); }
    bool is_same(int a, int b) const {
        return position(a) == position(b) && uv(a) == uv(b) && mesh_.normals[vertex(a)] == mesh_.normals[vertex(b)];
    }
    glm::dvec3 flat(const glm::dvec3& v, int corner) const {
        const glm::dvec3 across = v - normal(corner) * glm::dot(normal(corner), v);
        return glm::length(across) > 1e-12 ? glm::normalize(across) : glm::dvec3(0.0);
    }

    void add_triangle(int t) {
        const int a = 3 * t, b = a + 1, c = a + 2;
        is_point_.push_back(position(a) == position(b) || position(b) == position(c) || position(c) == position(a));
        const glm::dmat2 uv_from_edges(uv(b) - uv(a), uv(c) - uv(a));
        const double area = glm::determinant(uv_from_edges);
        tangents_.emplace_back(0.0);
        signs_.push_back(0.0);
        if (area == 0.0) return;
        const glm::dvec2 edges = glm::inverse(uv_from_edges) * glm::dvec2(1.0, 0.0);
        const glm::dvec3 along_u = edges.x * (position(b) - position(a)) + edges.y * (position(c) - position(a));
        if (glm::length(along_u) < 1e-12) return;
        tangents_.back() = glm::normalize(along_u);
        signs_.back() = area < 0.0 ? 1.0 : -1.0;  // v points downwards
    }

    void pair_edges() {
        partner_.assign(count_, -1);
        for (int e = 0; e < count_; ++e) {
            for (int f = e + 1; f < count_ && partner_[e] < 0; ++f) {
                if (is_point_[e / 3] || is_point_[f / 3] || partner_[f] >= 0) continue;
                if (!is_same(e, next(f)) || !is_same(next(e), f)) continue;
                partner_[e] = f;
                partner_[f] = e;
            }
        }
    }

    bool is_next_to(int a, int b) const {
        if (!is_same(a, b)) return false;
        for (const int e : {a, last(a)}) {
            for (const int f : {b, last(b)}) {
                if (partner_[e] == f) return true;
            }
        }
        return false;
    }

    void group() {
        group_of_.assign(count_, -1);
        int group = 0;
        for (int start = 0; start < count_; ++start) {
            if (group_of_[start] >= 0 || is_point_[start / 3] || tangents_[start / 3] == glm::dvec3(0.0)) continue;
            group_of_[start] = group;
            for (bool grows = true; grows;) {
                grows = false;
                for (int a = 0; a < count_; ++a) {
                    for (int b = 0; b < count_; ++b) {
                        if (group_of_[a] != group || group_of_[b] >= 0 || !is_next_to(a, b)) continue;
                        if (signs_[b / 3] == 0.0) signs_[b / 3] = signs_[start / 3];
                        if (signs_[b / 3] != signs_[start / 3]) continue;
                        group_of_[b] = group;
                        grows = true;
                    }
                }
            }
            ++group;
        }
    }

    Tangent sum_of(int group) const {
        glm::dvec3 sum(0.0);
        double weight = 0.0, sign = 0.0;
        for (int c = 0; c < count_; ++c) {
            if (group_of_[c] != group || tangents_[c / 3] == glm::dvec3(0.0)) continue;
            const glm::dvec3 to_next = flat(position(next(c)) - position(c), c);
            const glm::dvec3 to_last = flat(position(last(c)) - position(c), c);
            const double angle = std::acos(glm::clamp(glm::dot(to_next, to_last), -1.0, 1.0));
            sum += angle * flat(tangents_[c / 3], c);
            weight += angle;
            sign = signs_[c / 3];
        }
        if (glm::length(sum) < 1e-3 * weight || weight < 1e-6) return {glm::dvec4(0.0), false};
        return {glm::dvec4(glm::normalize(sum), sign), true};
    }

    const Mesh& mesh_;
    const std::vector<glm::vec2>& uvs_;
    int count_;
    std::vector<bool> is_point_;
    std::vector<glm::dvec3> tangents_;
    std::vector<double> signs_;
    std::vector<int> partner_, group_of_;
};

/// Derives the tangents of a whole mesh and compares each corner's.
/// unsure     counts the corners whose tangents cancel.
void expect_as_defined(Mesh mesh, int uv_set, int* unsure = nullptr) {
    mesh.materials = {{0, static_cast<uint32_t>(mesh.corners.size()), kNone<MaterialId>}};
    derive_tangents(&mesh, mesh.materials[0], uv_set);
    const Oracle oracle(mesh, uv_set);
    for (int corner = 0; corner < 3 * int(mesh.corners.size()); ++corner) {
        const Oracle::Tangent expected = oracle.at(corner);
        if (!expected.is_sure) {
            ASSERT_NE(unsure, nullptr) << "corner " << corner;
            ++*unsure;
            continue;
        }
        const glm::vec4 tangent = mesh.tangents[tangents_of(mesh, static_cast<uint32_t>(corner / 3))[corner % 3]];
        ASSERT_LT(glm::distance(glm::dvec4(tangent), expected.value), 1e-6) << "corner " << corner;
    }
}

glm::vec3 random_normal(Rng& rng) {
    return glm::normalize(glm::vec3(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(0.3f, 1)));
}

/// An uneven sheet of squares whose texture is mirrored at the middle and again at a quarter.
Mesh mirrored_sheet(Rng& rng) {
    Mesh mesh;
    constexpr uint32_t kSide = 9;
    for (uint32_t j = 0; j < kSide; ++j) {
        for (uint32_t i = 0; i < kSide; ++i) {
            const float x = static_cast<float>(i), y = static_cast<float>(j);
            mesh.positions.emplace_back(x + rng.uniform(-0.3f, 0.3f), y + rng.uniform(-0.3f, 0.3f),
                                        rng.uniform(-0.4f, 0.4f));
            mesh.normals.push_back(random_normal(rng));
            mesh.uvs[2].emplace_back(std::abs(std::abs(x - 4.0f) - 2.0f), y + 0.2f * x);
            if (i == 0 || j == 0) continue;
            const uint32_t d = j * kSide + i, c = d - 1, b = d - kSide, a = b - 1;
            mesh.corners.insert(mesh.corners.end(), {{a, b, d}, {a, d, c}});
        }
    }
    return mesh;
}

/// A ball by latitude and longitude: one vertex a pole, and where u ends a seam of vertices that are there twice.
/// is_mirrored    u returns on the second half, and there is no seam.
Mesh ball(int rings, int segments, bool is_mirrored) {
    Mesh mesh;
    const auto add = [&](float latitude, float longitude, const glm::vec2& uv) {
        const float pi = glm::pi<float>();
        mesh.normals.emplace_back(std::sin(latitude * pi) * std::cos(2 * longitude * pi), std::cos(latitude * pi),
                                  std::sin(latitude * pi) * std::sin(2 * longitude * pi));
        mesh.positions.push_back(2.0f * mesh.normals.back());
        mesh.uvs[2].push_back(uv);
        return static_cast<uint32_t>(mesh.positions.size() - 1);
    };
    const int columns = is_mirrored ? segments : segments + 1;
    for (int r = 1; r < rings; ++r) {
        for (int s = 0; s < columns; ++s) {
            const float v = static_cast<float>(r) / static_cast<float>(rings);
            const float u = static_cast<float>(s) / static_cast<float>(segments);
            add(v, s == segments ? 0.0f : u, {is_mirrored ? std::abs(2.0f * u - 1.0f) : u, v});
        }
    }
    const uint32_t north = add(0, 0, {0.5f, 0}), south = add(1, 0, {0.5f, 1});
    const auto at = [&](int r, int s) { return static_cast<uint32_t>((r - 1) * columns + s % columns); };
    for (int s = 0; s < segments; ++s) {
        mesh.corners.emplace_back(north, at(1, s + 1), at(1, s));
        mesh.corners.emplace_back(south, at(rings - 1, s), at(rings - 1, s + 1));
        for (int r = 1; r + 1 < rings; ++r) {
            mesh.corners.emplace_back(at(r, s), at(r, s + 1), at(r + 1, s + 1));
            mesh.corners.emplace_back(at(r, s), at(r + 1, s + 1), at(r + 1, s));
        }
    }
    return mesh;
}

TEST(TangentsAsDefined, WhereATextureIsMirrored) {
    const uint64_t seed = 71;
    SCOPED_TRACE(seed);
    Rng rng(seed);
    for (int round = 0; round < 5; ++round) {
        const Mesh mesh = mirrored_sheet(rng);
        expect_as_defined(mesh, 2);
        // Each vertex on a seam has a tangent of both kinds.
        Mesh derived = mesh;
        derive_tangents(&derived, {0, static_cast<uint32_t>(mesh.corners.size()), kNone<MaterialId>}, 2);
        std::array<std::array<int, 2>, 81> count{};
        for (size_t t = 0; t < mesh.corners.size(); ++t) {
            for (int k = 0; k < 3; ++k) {
                const glm::vec4& tangent = derived.tangents[derived.tangent_corners[t][k]];
                ASSERT_EQ(std::abs(tangent.w), 1.0f);
                ++count[mesh.corners[t][k]][tangent.w > 0.0f];
            }
        }
        for (size_t v = 0; v < 81; ++v) {
            const bool is_seam = v % 9 == 2 || v % 9 == 4 || v % 9 == 6;
            EXPECT_EQ(count[v][0] > 0 && count[v][1] > 0, is_seam) << "vertex " << v;
        }
    }
}

TEST(TangentsAsDefined, OnBallsWithASeam) {
    for (const bool is_mirrored : {false, true}) {
        int unsure = 0;
        expect_as_defined(ball(7, 12, is_mirrored), 2, &unsure);
        EXPECT_LE(unsure, 24) << "at the poles only";
    }
}

TEST(TangentsAsDefined, OnSoupsOfTriangles) {
    int corner_count = 0, unsure = 0;
    for (uint64_t seed = 0; seed < 400; ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        Rng rng(seed);
        // Few vertices, so that many triangles meet, and numbers so coarse that some have no area, here or in the texture.
        Mesh mesh;
        const uint32_t vertex_count = 4 + rng.below(8);
        const bool is_coarse = seed % 2 == 0;
        const auto number = [&] { return is_coarse ? static_cast<float>(rng.below(3)) : rng.uniform(); };
        for (uint32_t v = 0; v < vertex_count; ++v) {
            mesh.positions.emplace_back(number(), number(), number());
            mesh.normals.push_back(random_normal(rng));
            mesh.uvs[0].emplace_back(number(), number());
            if (v == 0 || rng.below(4) > 0) continue;
            const uint32_t same = rng.below(v);  // There twice; or in the same place only.
            mesh.positions[v] = mesh.positions[same];
            if (rng.below(3) == 0) continue;
            mesh.normals[v] = mesh.normals[same];
            mesh.uvs[0][v] = mesh.uvs[0][same];
        }
        for (uint32_t t = 4 + rng.below(40); t > 0; --t) {
            mesh.corners.emplace_back(rng.below(vertex_count), rng.below(vertex_count), rng.below(vertex_count));
        }
        corner_count += 3 * static_cast<int>(mesh.corners.size());
        expect_as_defined(mesh, 0, &unsure);
        if (HasFatalFailure()) return;
    }
    EXPECT_LT(unsure, corner_count / 20) << "of " << corner_count;
}

}  // namespace
}  // namespace zoe::test
