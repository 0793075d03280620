// No input makes a method slow: a triangle or box of the worst costs at most ten times what one of an ordinary input does.
// Builds by processor time of a single thread, the least of several runs, against the ordinary input's in the same run;
// rays by what they test.

#include <ctime>

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "engine/bvh/build_clusters.h"
#include "engine/bvh/traverse.h"
#include "engine/math/parallel.h"
#include "tests/bvh/inputs.h"
#include "tests/math/random_inputs.h"

namespace zoe::test {
namespace {

constexpr double kMostTimes = 10.0;

double processor_s() {
    timespec time;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

template <typename Work>
double least_s(Work&& work) {
    double least = std::numeric_limits<double>::infinity();
    for (int run = 0; run < 4; ++run) {
        const double begin = processor_s();
        work();
        least = std::min(least, processor_s() - begin);
    }
    return least;
}

class Cost : public ::testing::Test {
protected:
    void SetUp() override { set_thread_count(1); }
    void TearDown() override { set_thread_count(0); }
};

TEST_F(Cost, OfABuildIsBoundedOnEveryNastyInput) {
    for (const BlasBuilder builder :
         {BlasBuilder::kBinned, BlasBuilder::kSweep, BlasBuilder::kReinserted, BlasBuilder::kSbvh}) {
        BlasScratch scratch;
        const auto triangle_s = [&](const TestMesh& mesh) {
            Blas blas;
            const double time = least_s([&] { build_blas(mesh.positions, mesh.corners, builder, &blas, &scratch); });
            EXPECT_LE(static_cast<double>(blas.byte_count()), 300.0 * static_cast<double>(mesh.corners.size()) + 1e4)
                << mesh.name;
            return time / static_cast<double>(mesh.corners.size());
        };
        const double ordinary = triangle_s(random_soup(2000, 1.0f, 51));
        for (const TestMesh& mesh : nasty_meshes()) {
            if (mesh.corners.size() < 500) continue;  // What a build costs that is not its triangles'.
            EXPECT_LE(triangle_s(mesh), kMostTimes * ordinary) << mesh.name << ", builder " << static_cast<int>(builder);
        }
    }
}

// Where boxes coincide, a ray must look at all of them. So the measure is what the tree that splits in the middle takes,
// which looks at no areas and cannot be misled by them.
TEST_F(Cost, OfRaysIsBoundedOnEveryNastyInput) {
    constexpr int kRayCount = 500;
    for (const TestMesh& mesh : nasty_meshes()) {
        if (mesh.corners.size() > 5000) continue;  // Copies: smaller numbers of them do.
        SCOPED_TRACE(mesh.name);
        const std::vector<Ray> rays = rays_at(mesh, kRayCount, 53);
        const auto work = [&](BlasBuilder builder) {
            Blas blas;
            build_blas(mesh.positions, mesh.corners, builder, &blas);
            TraverseCounts counts;
            for (const Ray& ray : rays) {
                BlasHit hit;
                hit.t = ray.t_max;
                closest_hit(blas, RayFrame(ray), 0.0f, ray.t_min, &hit, &counts);
            }
            return static_cast<double>(counts.nodes + counts.triangles) / kRayCount;
        };
        const double naive = work(BlasBuilder::kMedian);
        for (const BlasBuilder builder :
             {BlasBuilder::kBinned, BlasBuilder::kSweep, BlasBuilder::kReinserted, BlasBuilder::kSbvh}) {
            const double ours = work(builder);
            EXPECT_LE(ours, 1.5 * naive + 8.0) << "builder " << static_cast<int>(builder) << ", seed 53";
        }
    }
}

TEST_F(Cost, OfClusteringIsBoundedOnEveryNastyInput) {
    constexpr int kCount = 5000;
    struct Input {
        const char* name;
        std::vector<Aabb> boxes;
    };
    Rng rng(7);
    std::vector<Input> inputs(8);
    inputs[0].name = "scattered";
    inputs[1].name = "coincident";
    inputs[2].name = "on a line, each twice as far as the one before, over and over";
    inputs[3].name = "one huge among small ones";
    inputs[4].name = "sixteen clusters of coincident ones";
    inputs[5].name = "a grid";
    inputs[6].name = "points on a line, without an area";
    inputs[7].name = "smaller than any area";
    const auto cube = [](const glm::vec3& p, float size) { return Aabb{p, p + size}; };
    for (int k = 0; k < kCount; ++k) {
        const glm::vec3 p = random_point(rng, 100.0f);
        inputs[0].boxes.push_back(cube(p, 1.0f));
        inputs[1].boxes.push_back(cube(glm::vec3(1, 2, 3), 1.0f));
        inputs[2].boxes.push_back(cube(glm::vec3(std::ldexp(1.0f, k % 40), 0, 0), 0.1f));
        inputs[3].boxes.push_back(k == 0 ? cube(glm::vec3(-1e6f), 2e6f) : cube(p, 1e-3f));
        inputs[4].boxes.push_back(cube(glm::vec3(float(k % 16) * 100.0f, 0, 0), 1.0f));
        inputs[5].boxes.push_back(cube(glm::vec3(k % 17, k / 17 % 17, k / 289), 1.0f));
        inputs[6].boxes.push_back(cube(glm::vec3(p.x, 0, 0), 0.0f));
        inputs[7].boxes.push_back(cube(1e-25f * p, 1e-27f));
    }
    PlocScratch scratch;
    for (const uint32_t exact_up_to : {0u, 0xffffffffu}) {
        double ordinary = 0.0;
        for (const Input& input : inputs) {
            const double time =
                least_s([&] { build_clusters(input.boxes, {.exact_up_to = exact_up_to}, {}, &scratch); }) / kCount;
            if (&input == inputs.data()) ordinary = time;
            EXPECT_LE(time, kMostTimes * ordinary) << input.name << (exact_up_to ? ", exact, seed 7" : ", fast, seed 7");
        }
    }
}

}  // namespace
}  // namespace zoe::test
