// Exchanges of places in a tree, which charts measure.

#include <gtest/gtest.h>

#include "apps/chart/measure.h"
#include "apps/chart/moving.h"
#include "apps/chart/rotate.h"

namespace zoe::chart {
namespace {

TEST(Rotations, KeepTheTreeSoundAndTheHitsAndLowerItsCost) {
    constexpr Settings kSettings{.size = Size::kTiny};
    for (const std::string name : moving_names()) {
        const Moving moving = make_moving(name, kSettings);
        Blas refitted;
        build_blas(moving.positions(0), moving.corners, BlasBuilder::kSweep, &refitted);
        Blas rotated = refitted;
        for (const int frame : {20, 50, 80}) {
            const std::vector<glm::vec3> positions = moving.positions(frame);
            refit_blas(positions, moving.corners, &refitted);
            refit_blas(positions, moving.corners, &rotated);
            const double before = rotated.tree.summed_cost();
            const size_t count = rotate(&rotated.tree);
            ASSERT_EQ(validate(rotated, positions, moving.corners), "") << name << ", frame " << frame;
            const double after = rotated.tree.summed_cost(), expected = sah_cost(rotated.tree, CollapseConfig{}.block_cost);
            EXPECT_NEAR(after, expected, 1e-9 * expected) << name;
            EXPECT_TRUE(count == 0 ? after == before : after < before) << name << ", frame " << frame;
            const std::vector<Ray> rays = make_rays(refitted.tree.bounds(), 300, 17);
            EXPECT_EQ(work_of_rays(rotated, rays).hits_hash, work_of_rays(refitted, rays).hits_hash) << name;
        }
    }
}

}  // namespace
}  // namespace zoe::chart
