#include "engine/bvh/build_auto.h"

#include <limits>

namespace zoe {

namespace {

// From the benchmark's `--trees` over static, deforming and five models (BENCHMARKS.md's but the ship), on two cores: the
// median build, and what rays gain in the mean. A sweep alone pays nowhere: what it gains over the binned builder,
// reinsertion gains many times over. Spatial splits take twice as long to build, and rays were slower for them in most of
// these scenes.
struct Price {
    BlasBuilder builder;
    double build_ns;  // A triangle.
    double ray_ns;    // A ray, beyond what the best tree takes.
};
constexpr Price kPrices[] = {{BlasBuilder::kBinned, 124.0, 10.0}, {BlasBuilder::kReinserted, 1380.0, 0.0}};

}  // namespace

double predicted_build_s(BlasBuilder builder, uint64_t triangle_count) {
    for (const Price& price : kPrices) {
        if (price.builder == builder) return 1e-9 * price.build_ns * static_cast<double>(triangle_count);
    }
    return std::numeric_limits<double>::infinity();
}

BlasBuilder choose_builder(uint64_t triangle_count, const AutoConfig& config) {
    BlasBuilder best = BlasBuilder::kBinned;
    double least_s = std::numeric_limits<double>::infinity();
    for (const Price& price : kPrices) {
        const double build_s = predicted_build_s(price.builder, triangle_count);
        const double total_s = build_s + 1e-9 * price.ray_ns * config.rays;
        if (total_s >= least_s || (build_s > config.budget_s && price.builder != BlasBuilder::kBinned)) continue;
        least_s = total_s;
        best = price.builder;
    }
    return best;
}

}  // namespace zoe
