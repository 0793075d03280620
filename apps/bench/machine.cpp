#include "apps/bench/machine.h"

#include <fstream>
#include <thread>

#include <zoetrope_build_info.h>  // made by the build
#include "apps/bench/peer_embree.h"
#include "apps/common/stats_json.h"
#include "engine/math/parallel.h"

namespace zoe {
namespace {

/// The processor's own name, where the system tells it.
std::string processor_name() {
    std::ifstream info("/proc/cpuinfo");
    for (std::string line; std::getline(info, line);) {
        if (!line.starts_with("model name")) continue;
        const size_t colon = line.find(": ");
        if (colon != std::string::npos) return line.substr(colon + 2);
    }
    return "unknown";
}

}  // namespace

std::vector<std::pair<std::string, std::string>> describe_machine() {
    return {{"processor", processor_name()},
            {"cores", std::to_string(std::thread::hardware_concurrency())},
            {"threads", std::to_string(thread_count())},
            {"compiler", ZOETROPE_COMPILER},
            {"flags", ZOETROPE_FLAGS},
            {"simd", simd_target()},
            {"version", ZOETROPE_VERSION},
            {"commit", ZOETROPE_COMMIT}};
}

}  // namespace zoe
