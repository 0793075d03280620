// zoetrope-micro: what single methods cost, on one thread. Options are those of Google Benchmark (--help).
#include <cstdio>

#include "engine/math/parallel.h"
#include "tests/bench/harness.h"

int main(int argc, char** argv) {
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
    zoe::set_thread_count(1);
    benchmark::AddCustomContext("threads", "1");
    zoe::test::register_kernels();
    zoe::test::register_builders();
    zoe::test::register_rays();
    zoe::test::register_deformers();
    zoe::test::register_stencils();
    if (benchmark::RunSpecifiedBenchmarks() == 0) {
        std::fprintf(stderr, "zoetrope-micro: no benchmark has such a name (--benchmark_list_tests lists them)\n");
        return 2;
    }
    benchmark::Shutdown();
    return zoe::test::has_any_failed() ? 1 : 0;
}
