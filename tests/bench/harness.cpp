#include "tests/bench/harness.h"

#include <cstring>
#include <numeric>

#include <glm/geometric.hpp>

#include "tests/math/random_inputs.h"

namespace zoe::test {

namespace {
bool is_any_failed = false;
}

void fail(benchmark::State& state, const std::string& reason) {
    is_any_failed = true;
    state.SkipWithError(reason.c_str());
}

bool has_any_failed() {
    return is_any_failed;
}

void count_per_second(benchmark::State& state, const std::string& what, size_t count) {
    state.counters[what + "_per_second"] =
        benchmark::Counter(static_cast<double>(count), benchmark::Counter::kIsIterationInvariantRate);
}

void copy_bytes(benchmark::State& state, size_t moved_bytes) {
    std::vector<uint8_t> from(moved_bytes / 2), to(moved_bytes / 2);
    std::iota(from.begin(), from.end(), uint8_t{1});
    for (auto _ : state) {
        std::memcpy(to.data(), from.data(), from.size());
        benchmark::DoNotOptimize(to.data());
        benchmark::ClobberMemory();
    }
    count_per_second(state, "bytes", moved_bytes);
    if (from != to) fail(state, "the copy differs");
}

std::vector<glm::vec3> random_points(size_t count, uint64_t seed) {
    Rng rng(seed);
    std::vector<glm::vec3> points(count);
    for (glm::vec3& p : points) p = random_point(rng, 1.0f);
    return points;
}

bool is_near(const glm::vec3& point, const glm::dvec3& expected) {
    return glm::distance(glm::dvec3(point), expected) <= 1e-4;
}

}  // namespace zoe::test
