// Cages that meet along a common boundary.

#include <algorithm>
#include <cmath>
#include <vector>

#include <glm/ext/vector_double3.hpp>
#include <glm/geometric.hpp>

#include <gtest/gtest.h>

#include "engine/frame/frame.h"

namespace zoe::test {
namespace {

// Half of a wavy strip: two columns of quads on one side of x = 0.
// is_turned   vertices and faces are numbered from the other end.
Mesh half_strip(float side, bool is_turned, double time_s, int level = 3) {
    constexpr int kRows = 12;
    const auto place = [&](int x, int y) {
        const float u = side * static_cast<float>(x), v = static_cast<float>(y);
        const float t = static_cast<float>(time_s);
        return glm::vec3(u, v + 0.2f * std::sin(1.7f * u + t), 0.4f * std::sin(2.3f * v + u * u + t) + 0.3f * v);
    };
    std::vector<glm::vec3> positions;
    Cage cage;
    for (int k = 0; k < 3 * (kRows + 1); ++k) {
        const int n = is_turned ? 3 * (kRows + 1) - 1 - k : k;
        positions.push_back(place(n % 3, n / 3));
    }
    const auto vertex = [&](int x, int y) {
        const int n = 3 * y + x;
        return static_cast<uint32_t>(is_turned ? 3 * (kRows + 1) - 1 - n : n);
    };
    for (int y = 0; y < kRows; ++y) {
        for (int x = 0; x < 2; ++x) {
            cage.face_sizes.push_back(4);
            const std::vector<uint32_t> face = {vertex(x, y), vertex(x + 1, y), vertex(x + 1, y + 1), vertex(x, y + 1)};
            if (side > 0)
                cage.vertices.insert(cage.vertices.end(), face.begin(), face.end());
            else
                cage.vertices.insert(cage.vertices.end(), face.rbegin(), face.rend());
        }
    }
    return make_surface(positions, {.cage = cage, .options = {.level = level}});
}

// The vertices of a half at x = 0, in the order of y.
std::vector<glm::vec3> seam_of(const Instance& half) {
    std::vector<glm::vec3> seam;
    for (const glm::vec3& p : half.positions) {
        if (p.x == 0.0f) seam.push_back(p);
    }
    std::sort(seam.begin(), seam.end(), [](const auto& a, const auto& b) { return a.y < b.y; });
    return seam;
}

// The largest distance of a seam's vertices from the other one's lines.
double farthest(const std::vector<glm::vec3>& seam, const std::vector<glm::vec3>& other) {
    double most = 0.0;
    for (const glm::dvec3 p : seam) {
        double nearest = HUGE_VAL;
        for (size_t k = 0; k + 1 < other.size(); ++k) {
            const glm::dvec3 begin(other[k]), along = glm::dvec3(other[k + 1]) - begin;
            const double s = std::clamp(glm::dot(p - begin, along) / glm::dot(along, along), 0.0, 1.0);
            nearest = std::min(nearest, glm::distance(p, begin + s * along));
        }
        most = std::max(most, nearest);
    }
    return most;
}

// Two cages with the same boundary, numbered in opposite ways.
TEST(Subdivision, NeighbouringCagesDoNotCrack) {
    Scene scene;
    for (const float side : {1.0f, -1.0f}) {
        Node node;
        node.mesh = scene.add(half_strip(side, side < 0, 0.0));
        scene.add(node);
    }
    for (const double time_s : {0.0, 0.7, 2.1}) {
        if (time_s > 0.0) {
            for (uint32_t k = 0; k < 2; ++k)
                scene.write_cage(MeshId{k}, half_strip(k == 0 ? 1.0f : -1.0f, k == 1, time_s).positions);
        }
        const Tlas& tlas = advance(scene, time_s);
        const std::vector<glm::vec3> seams[2] = {seam_of(tlas.instances[0]), seam_of(tlas.instances[1])};
        EXPECT_EQ(seams[0].size(), 12u * 8 + 1);
        EXPECT_EQ(seams[0], seams[1]) << "to the last bit";
        for (size_t k = 0; k + 1 < seams[0].size(); ++k) {
            for (int step = 0; step < 50; ++step) {
                const glm::vec3 at_seam = glm::mix(seams[0][k], seams[0][k + 1], (static_cast<float>(step) + 0.5f) / 50.0f);
                const glm::vec3 eye{0.0f, at_seam.y + 0.1f, 9.0f};
                const Hit hit = closest_hit(tlas, {.origin = eye, .direction = at_seam - eye});
                ASSERT_TRUE(hit) << "time " << time_s << ", between seam vertices " << k << ", step " << step;
                EXPECT_NEAR(hit.t, 1.0f, 1e-3f);
            }
        }
    }
}

// Of different levels, they gape by no more than both are off their common limit, which either side shows as well.
TEST(Subdivision, BetweenLevelsTheGapIsWithinTheErrorsOfBoth) {
    const auto seam_at = [](bool is_other_side, int level) {
        Scene scene;
        Node node;
        node.mesh = scene.add(half_strip(is_other_side ? -1.0f : 1.0f, is_other_side, 0.7, level));
        scene.add(node);
        return seam_of(advance(scene, 0.0).instances[0]);
    };
    constexpr int kLevels = 4, kFine = 6;
    std::vector<glm::vec3> seams[2][kLevels + 1];
    double errors[2][kLevels + 1] = {};
    for (const int side : {0, 1}) {
        const std::vector<glm::vec3> limit = seam_at(side == 0, kFine);
        double before = HUGE_VAL;
        for (int level = 1; level <= kLevels; ++level) {
            seams[side][level] = seam_at(side == 1, level);
            errors[side][level] = farthest(limit, seams[side][level]);
            EXPECT_LT(errors[side][level], 0.4 * before) << "level " << level << ", side " << side;
            before = errors[side][level];
        }
    }
    for (int one = 1; one <= kLevels; ++one) {
        for (int other = 1; other <= kLevels; ++other) {
            const std::vector<glm::vec3>&a = seams[0][one], &b = seams[1][other];
            const double gap = std::max(farthest(a, b), farthest(b, a));
            EXPECT_LE(gap, errors[0][one] + errors[1][other]) << "levels " << one << " and " << other;
            EXPECT_EQ(gap == 0.0, one == other) << "levels " << one << " and " << other;
        }
    }
}

}  // namespace
}  // namespace zoe::test
