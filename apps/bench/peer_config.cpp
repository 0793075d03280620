#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "apps/bench/peer_embree.h"
#include "engine/frame/frame_state.h"

namespace zoe {
namespace {

/// Triangles in the world above which all of them in one scene take too much memory: about 200 bytes each.
constexpr uint64_t kMaxOneSceneTriangles = 10'000'000;

uint64_t world_triangle_count(const Tlas& tlas) {
    uint64_t count = 0;
    for (const Instance& instance : tlas.instances) count += instance.mesh->corners.size();
    return count;
}

/// Fewer instances than this have their top level built in next to no time by either quality: MEDIUM is the better tree.
constexpr size_t kFewInstances = 1000;

bool has(const Scene& scene, Motion motion) {
    return std::ranges::any_of(scene.frame->shapes, [=](const Shape& shape) { return shape.motion.motion == motion; });
}

bool is_all_static(const Scene& scene) {
    return std::ranges::all_of(scene.frame->shapes,
                               [](const Shape& shape) { return shape.motion.motion == Motion::kStatic; });
}

const char* medium_or_low(bool is_medium) {
    return is_medium ? "MEDIUM" : "LOW";
}

}  // namespace

std::string EmbreeConfig::describe() const {
    std::string form = "one scene, rigid and deforming REFIT";
    if (layout == Layout::kInstances)
        form = fmt::format("instances under {}, deforming REFIT", medium_or_low(is_top_medium));
    constexpr std::array kForms = {"single", "packets of 16 for", "coherent packets of 16 for"};
    std::string forms;
    for (const RayKind kind : kRayKinds) {
        const size_t k = static_cast<size_t>(kind);
        forms += fmt::format("{}{} {}", forms.empty() ? "" : ", ", kForms[static_cast<size_t>(rays[k])], name(kind));
    }
    return fmt::format("{}, arbitrary {}, static {}, {}; {} rays", form, medium_or_low(is_arbitrary_medium),
                       is_static_high ? "HIGH" : "MEDIUM", is_robust ? "robust" : "fast", forms);
}

std::vector<EmbreeConfig> embree_configs(const Scene& scene, const Tlas& tlas, const PeerOptions& options) {
    using Layout = EmbreeConfig::Layout;
    std::vector<EmbreeConfig> configs;
    for (const bool is_arbitrary_medium : {false, true}) {
        if (is_arbitrary_medium && !has(scene, Motion::kArbitrary)) continue;
        EmbreeConfig config{.is_arbitrary_medium = is_arbitrary_medium, .is_robust = options.is_robust};
        if (!options.is_two_level && world_triangle_count(tlas) <= kMaxOneSceneTriangles) {
            config.layout = Layout::kOneScene;
            config.is_static_high = options.is_static_high && is_all_static(scene);
            configs.push_back(config);
        }
        config.layout = Layout::kInstances;
        config.is_static_high = options.is_static_high;
        for (const bool is_top_medium : {false, true}) {
            if (!is_top_medium && tlas.instances.size() < kFewInstances) continue;
            config.is_top_medium = is_top_medium;
            configs.push_back(config);
        }
    }
    return configs;
}

}  // namespace zoe
