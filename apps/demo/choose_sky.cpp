#include "apps/demo/choose_sky.h"

#include <algorithm>
#include <cstdio>

#include <fmt/format.h>

#include "engine/render/physical_sky.h"

namespace zoe {
namespace {

bool has_light(const Scene& scene) {
    return std::ranges::any_of(scene.nodes, [](const Node& node) { return node.light != kNone<LightId> && node.is_shown; });
}

Environment make_uniform(const glm::dvec3& color) {
    FloatImage picture{.width = 1, .height = 1, .channels = {"R", "G", "B"}};
    for (int c = 0; c < 3; ++c) picture.values.push_back(static_cast<float>(color[c]));
    return Environment(picture);
}

Environment read_sky(const std::string& file) {
    Environment environment = read_environment(file);
    if (const uint64_t count = environment.repaired_count(); count > 0) {
        fmt::print(stderr, "{}: warning: {}: {} of its pixels have numbers that are no light: brought into range\n",
                   kProgram, file, count);
    }
    return environment;
}

}  // namespace

std::shared_ptr<const Environment> choose_sky(const Options& options, const Scene& scene) {
    switch (options.sky) {
        case Sky::kByLights:
            if (has_light(scene)) return nullptr;
            break;
        case Sky::kPlain:
            return nullptr;
        case Sky::kColor:
            return std::make_shared<Environment>(make_uniform(options.sky_color));
        case Sky::kFile:
            return std::make_shared<Environment>(read_sky(options.sky_file));
        case Sky::kPhysical:
            break;
    }
    return std::make_shared<Environment>(make_physical_sky(sky_direction(options.sun.x, options.sun.y)));
}

}  // namespace zoe
