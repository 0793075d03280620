#pragma once

#include <string>
#include <vector>

#include <benchmark/benchmark.h>
#include <glm/vec3.hpp>

namespace zoe::test {

/// Each file's benchmarks, named `method/input`. Inputs are made by the first benchmark that needs them.
void register_kernels();
void register_builders();
void register_rays();
void register_deformers();
void register_stencils();

/// Ends a benchmark that gave a wrong result; the program's exit code says so, too.
void fail(benchmark::State& state, const std::string& reason);
bool has_any_failed();

/// Adds the counter `WHAT_per_second`.
/// count      of an iteration.
void count_per_second(benchmark::State& state, const std::string& what, size_t count);

/// A memcpy that reads and writes so many bytes in all: what memory allows.
void copy_bytes(benchmark::State& state, size_t moved_bytes);

/// Points in the cube from -1 to 1.
std::vector<glm::vec3> random_points(size_t count, uint64_t seed);
/// Within 1e-4; a NaN is near nothing.
bool is_near(const glm::vec3& point, const glm::dvec3& expected);

}  // namespace zoe::test
