#include <gtest/gtest.h>

#include "engine/bvh/blas.h"
#include "engine/math/parallel.h"
#include "tests/bvh/inputs.h"
#include "tests/support/allocation_count.h"

namespace zoe::test {
namespace {

struct Case {
    const char* name;
    BlasBuilder builder;
};
constexpr Case kCases[] = {{"sweep", BlasBuilder::kSweep},
                           {"binned", BlasBuilder::kBinned},
                           {"reinserted", BlasBuilder::kReinserted},
                           {"SBVH", BlasBuilder::kSbvh},
                           {"median", BlasBuilder::kMedian}};

TEST(Memory, OfABuildIsAtMostTwoAndAHalfTimesThatOfItsTree) {
    const TestMesh mesh = random_soup(200'000, 0.02f, 171);
    for (const Case& c : kCases) {
        SCOPED_TRACE(c.name);
        Blas blas;
        const size_t before = live_bytes();
        reset_peak_bytes();
        build_blas(mesh.positions, mesh.corners, c.builder, &blas);
        const double tree = static_cast<double>(blas.byte_count());
        EXPECT_LE(static_cast<double>(peak_bytes() - before), 2.5 * tree) << "bytes; the tree has " << tree;
        // And what is kept is the tree.
        EXPECT_LE(static_cast<double>(live_bytes() - before), 1.3 * tree);
    }
}

TEST(Memory, OfBinnedSweptAndSplitTreesIsAtMost70BytesATriangle) {
    const TestMesh mesh = random_soup(100'000, 0.02f, 172);
    for (const BlasBuilder builder : {BlasBuilder::kBinned, BlasBuilder::kSweep, BlasBuilder::kSbvh}) {
        Blas blas;
        build_blas(mesh.positions, mesh.corners, builder, &blas);
        EXPECT_LE(blas.byte_count(), 70u * 100'000) << static_cast<int>(builder);
    }
}

}  // namespace
}  // namespace zoe::test
