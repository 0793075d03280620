// A skinned figure with creases, in a bent pose: what each level shows of its limit surface.

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "content/content.h"
#include "engine/frame/frame.h"
#include "engine/render/view.h"
#include "tests/support/point_distance.h"

namespace zoe::test {
namespace {

constexpr double kBent_s = 4.0 / 24.0;  // Elbows and knees are far from where they were bound.
constexpr int kLevels = 3, kFine = 5;

/// The dancer alone at a level; what stands around him is not shown.
Scene dancer(int level) {
    Scene scene = make_content("dancers", 1).scene;
    scene.clip_poses = 1;
    for (Node& node : scene.nodes) {
        if (node.mesh == kNone<MeshId>) continue;
        node.is_shown = scene[node.mesh].surface.has_value();
        if (node.is_shown) scene[node.mesh].surface->options.level = level;
    }
    return scene;
}

struct Shown {
    std::vector<glm::dvec3> positions;
    std::vector<glm::uvec3> corners;
};

Shown show(int level) {
    Scene scene = dancer(level);
    const Tlas& tlas = advance(scene, kBent_s);
    EXPECT_EQ(tlas.instances.size(), 1u);
    const Instance& figure = tlas.instances.front();
    return {{figure.positions.begin(), figure.positions.end()}, figure.mesh->corners};
}

TEST(SubdivisionFigure, ComesNearerToItsLimitWithEachLevel) {
    const Shown fine = show(kFine);  // On the limit surface.
    double before = HUGE_VAL;
    for (int level = 1; level <= kLevels; ++level) {
        const Shown shown = show(level);
        double worst = 0.0;
        for (size_t v = 0; v < fine.positions.size(); v += 127) {
            const glm::dvec3& p = fine.positions[v];
            double nearest = HUGE_VAL;
            for (const glm::uvec3& c : shown.corners)
                nearest = std::min(nearest, distance(p, shown.positions[c.x], shown.positions[c.y], shown.positions[c.z]));
            worst = std::max(worst, nearest);
        }
        EXPECT_LT(worst, 0.5 * before) << "level " << level;
        before = worst;
    }
    EXPECT_LT(before, 2e-3) << "metres";
}

TEST(SubdivisionFigure, OutlineSettlesWithEachLevel) {
    constexpr int kWidth = 160, kHeight = 200;
    const auto outline = [](int level) {
        Scene scene = dancer(level);
        const Tlas& tlas = advance(scene, kBent_s);
        const View view = look_at({1.3f, 1.3f, 4.4f}, {0.0f, 0.86f, 0.0f}, 30.0f, float(kWidth) / float(kHeight));
        std::vector<bool> is_hit;
        for (int y = 0; y < kHeight; ++y) {
            for (int x = 0; x < kWidth; ++x)
                is_hit.push_back(any_hit(tlas, camera_ray(view, float(x) + 0.5f, float(y) + 0.5f, kWidth, kHeight)));
        }
        return is_hit;
    };
    const std::vector<bool> fine = outline(kLevels + 1);
    EXPECT_GT(std::ranges::count(fine, true), kWidth * kHeight / 10);
    std::ptrdiff_t before = kWidth * kHeight;
    for (int level = 1; level <= kLevels; ++level) {
        const std::vector<bool> shown = outline(level);
        std::ptrdiff_t different_count = 0;
        for (size_t k = 0; k < fine.size(); ++k) different_count += shown[k] != fine[k];
        EXPECT_LT(2 * different_count, before) << "level " << level;
        before = different_count;
    }
}

using Point = std::tuple<double, double, double>;

/// Vertices that are there several times, for their normals' sake, are one.
std::map<std::array<Point, 2>, std::vector<glm::dvec3>> normals_at_edges(const Shown& shown) {
    std::map<std::array<Point, 2>, std::vector<glm::dvec3>> normals;
    for (const glm::uvec3& c : shown.corners) {
        const glm::dvec3 corners[] = {shown.positions[c.x], shown.positions[c.y], shown.positions[c.z]};
        const glm::dvec3 normal = glm::normalize(glm::cross(corners[1] - corners[0], corners[2] - corners[0]));
        for (int k = 0; k < 3; ++k) {
            const auto point = [&](int corner) {
                const glm::dvec3& p = corners[corner % 3];
                return Point{p.x, p.y, p.z};
            };
            normals[{std::min(point(k), point(k + 1)), std::max(point(k), point(k + 1))}].push_back(normal);
        }
    }
    return normals;
}

// The soles' edges are creases that stay; the others, at the hem and the head, fade after three levels at most.
TEST(SubdivisionFigure, StaysClosedAndSharpAtItsCreasesAndIsSmoothElsewhere) {
    constexpr size_t kSoleEdges = 12;  // Of the cage.
    constexpr int kFaded = 3;
    double most_elsewhere = 0.0;
    for (int level = 2; level <= kFine; ++level) {
        std::vector<double> bends;  // Degrees.
        for (const auto& [edge, normals] : normals_at_edges(show(level))) {
            ASSERT_EQ(normals.size(), 2u) << "level " << level;
            bends.push_back(glm::degrees(std::acos(std::clamp(glm::dot(normals[0], normals[1]), -1.0, 1.0))));
        }
        std::ranges::sort(bends, std::greater());
        const size_t crease_count = kSoleEdges << level;
        EXPECT_NEAR(bends[crease_count - 1], 90.0, 0.1) << "level " << level;
        if (level > kFaded) {
            EXPECT_LT(bends[crease_count], 0.8 * most_elsewhere) << "level " << level;
        }
        most_elsewhere = bends[crease_count];
    }
}

}  // namespace
}  // namespace zoe::test
