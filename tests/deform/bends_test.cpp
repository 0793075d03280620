// The estimate of a level's distance from the limit surface, against levels that are much finer.

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "engine/deform/bends.h"
#include "tests/deform/subdivide_surface.h"
#include "tests/support/point_distance.h"

namespace zoe::test {
namespace {

constexpr int kFine = 5, kCoarsest = 1, kCoarse = 3;

/// The largest distance of the fine surface's vertices from the coarse triangles of their own faces of the cage.
double measured_error(const Surface& coarse, const Surface& fine) {
    std::vector<std::vector<uint32_t>> of_face(fine.topology.cage_faces.back() + 1);
    for (uint32_t k = 0; k < coarse.topology.corners.size(); ++k) of_face[coarse.topology.cage_faces[k]].push_back(k);
    double worst = 0.0;
    for (uint32_t k = 0; k < fine.topology.corners.size(); ++k) {
        if (k % 3 != 0) continue;  // Each vertex belongs to several triangles.
        const glm::dvec3 p = fine.positions[fine.topology.corners[k].x];
        double nearest = 1e300;
        for (const uint32_t triangle : of_face[fine.topology.cage_faces[k]]) {
            const glm::uvec3& c = coarse.topology.corners[triangle];
            nearest = std::min(nearest, distance(p, coarse.positions[c.x], coarse.positions[c.y], coarse.positions[c.z]));
            if (nearest <= worst) break;
        }
        worst = std::max(worst, nearest);
    }
    return worst;
}

/// Far away, a metre has the same pixels everywhere.
std::array<float, kMaxSubdivisionLevel + 1> estimates_of(const PolygonMesh& mesh, const Cage& cage) {
    std::array<float, kMaxSubdivisionLevel + 1> errors;
    const std::vector<Bend> bends = find_bends(cage, mesh.points.size());
    const Seen seen{.eye_world = {0, 0, 1e6f}, .pixels_at_1m = 1e6f};
    estimate_errors(bends, mesh.positions(), seen, errors);
    return errors;
}

/// Adds what estimate and measurement are to each other: the estimate must not be smaller.
void compare(const PolygonMesh& mesh, SubdivisionScheme scheme, const std::string& what, double* log_sum, int* count) {
    const Cage cage = mesh.cage(scheme);
    const auto estimates = estimates_of(mesh, cage);
    const Surface fine = surface_of(mesh, {.level = kFine, .normals = false}, scheme);
    for (int level = kCoarsest; level <= kCoarse; ++level) {
        const Surface coarse = surface_of(mesh, {.level = level, .normals = false}, scheme);
        const double error = measured_error(coarse, fine);
        EXPECT_LE(error, estimates[level] * 1.0001 + 1e-6) << what << ", level " << level;
        if (error < 1e-5) continue;
        *log_sum += std::log2(estimates[level] / error);
        ++*count;
    }
}

TEST(Bends, EstimatesAreNeverTooSmallAndSeldomMuchTooLarge) {
    const uint64_t seed = 6300;
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Rng rng(seed);
    for (const SubdivisionScheme scheme : {SubdivisionScheme::kCatmullClark, SubdivisionScheme::kLoop}) {
        const bool is_loop = scheme == SubdivisionScheme::kLoop;
        double log_sum = 0.0;
        int count = 0;
        for (int round = 0; round < 12; ++round) {
            PolygonMesh mesh = random_closed(rng, 2, is_loop ? 3 : round % 4 == 0 ? 4 : 0);
            if (round % 6 == 5) mesh.faces.erase(mesh.faces.begin() + rng.below(uint32_t(mesh.faces.size())));
            if (round % 3 == 1) {
                for (const auto& [edge, sides] : mesh.edge_faces()) {
                    if (rng.below(4) == 0) mesh.creases[edge] = rng.below(2) == 0 ? 10.0 : 0.5 * (1 + rng.below(6));
                }
            }
            if (round % 4 == 3) mesh.corners[0] = 1.5;
            const std::string what = std::string(is_loop ? "Loop" : "Catmull-Clark") + " round " + std::to_string(round);
            compare(mesh, scheme, what, &log_sum, &count);
        }
        // A level is a factor of four.
        EXPECT_LT(std::exp2(log_sum / count), 4.0) << "the mean ratio of " << count;
        RecordProperty(is_loop ? "loop_mean_ratio" : "catmull_clark_mean_ratio", std::to_string(std::exp2(log_sum / count)));
    }
}

TEST(Bends, FlatCagesAndSharpOnesHaveNone) {
    for (const float error : estimates_of(sheet(5), sheet(5).cage())) EXPECT_TRUE(error == 0.0f || std::isinf(error));
    PolygonMesh box = cube();
    for (const auto& [edge, sides] : box.edge_faces()) box.creases[edge] = 10.0;
    EXPECT_EQ(estimates_of(box, box.cage())[1], 0.0f);
    box.creases[{0, 1}] = 2.0;
    EXPECT_GT(estimates_of(box, box.cage())[1], 0.0f);
}

TEST(Bends, PixelsFollowDistanceScaleAndPicture) {
    const PolygonMesh mesh = cube();
    const std::vector<Bend> bends = find_bends(mesh.cage(), 8);
    const auto error_from = [&](float distance, float scale, float pixels) {
        std::array<float, kMaxSubdivisionLevel + 1> errors;
        Seen seen{.eye_world = {distance, 0, 0}, .pixels_at_1m = pixels};
        seen.world_from_local.linear = glm::mat3(scale);
        estimate_errors(bends, mesh.positions(), seen, errors);
        return errors[2];
    };
    const float error = error_from(1000, 1, 500);
    EXPECT_NEAR(error_from(2000, 1, 500), 0.5f * error, 0.01f * error);
    EXPECT_NEAR(error_from(2000, 2, 500), error, 0.01f * error);
    EXPECT_NEAR(error_from(1000, 1, 1500), 3.0f * error, 0.01f * error);
    EXPECT_TRUE(std::isfinite(error_from(1, 1, 500))) << "inside";
    EXPECT_GT(error_from(1, 1, 500), 1e6f);
}

}  // namespace
}  // namespace zoe::test
