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
    parallel_for(0, 100, 1, [](size_t, size_t) {});  // The scheduler's own memory is there before.
    for (const Case& c : kCases) {
        SCOPED_TRACE(c.name);
        Blas blas;
        const size_t before = live_bytes();
        reset_peak_bytes();
        build_blas(mesh.positions, mesh.corners, c.builder, &blas);
        const double tree = static_cast<double>(blas.byte_count());
        EXPECT_LE(static_cast<double>(peak_bytes() - before), 2.5 * tree) << "bytes; the tree has " << tree;
        // And what is kept is the tree, where its levels end, and a little of the scheduler's.
        EXPECT_LE(live_bytes() - before, blas.byte_count() + (1 << 14));
    }
}

TEST(Memory, OfAMeshThatGrowsMovesNowAndThenOnly) {
    set_thread_count(1);  // With more, the scheduler allocates its own tasks.
    const TestMesh mesh = random_soup(6000, 0.02f, 173);
    Blas blas;
    BlasScratch scratch;
    const auto build = [&](size_t count) {
        build_blas(mesh.positions, std::span(mesh.corners).first(count), BlasBuilder::kBinned, &blas, &scratch);
    };
    build(3000);
    const size_t before = allocation_count();
    size_t build_count = 0;
    for (size_t count = 3010; count <= 6000; count += 10, ++build_count) build(count);
    EXPECT_LT(allocation_count() - before, build_count / 4);
    const size_t all = allocation_count();
    for (size_t count = 3000; count <= 6000; count += 1000) build(count);
    EXPECT_EQ(allocation_count(), all);
    set_thread_count(0);
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
