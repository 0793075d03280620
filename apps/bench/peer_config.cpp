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

bool has_arbitrary(const Scene& scene) {
    for (const Shape& shape : scene.frame->shapes) {
        if (shape.motion.motion == Motion::kArbitrary) return true;
    }
    return false;
}

}  // namespace

std::string EmbreeConfig::describe() const {
    std::string packets;
    for (const RayKind kind : kRayKinds) {
        if (uses_packets[static_cast<size_t>(kind)])
            packets += fmt::format("{}{}", packets.empty() ? "" : " and ", name(kind));
    }
    const char* const form =
        layout == Layout::kInstances ? "instances, deforming REFIT" : "one scene, rigid and deforming REFIT";
    return fmt::format("{}, arbitrary {}, static {}, {}, {}", form, is_arbitrary_medium ? "MEDIUM" : "LOW",
                       is_static_high ? "HIGH" : "MEDIUM", is_robust ? "robust" : "fast",
                       packets.empty() ? "single rays" : fmt::format("packets of 16 for {} rays", packets));
}

std::vector<EmbreeConfig> embree_configs(const Scene& scene, const Tlas& tlas, bool is_static_high, bool is_robust) {
    std::vector<EmbreeConfig::Layout> layouts = {EmbreeConfig::Layout::kInstances};
    if (world_triangle_count(tlas) <= kMaxOneSceneTriangles) layouts.push_back(EmbreeConfig::Layout::kOneScene);
    std::vector<EmbreeConfig> configs;
    for (const EmbreeConfig::Layout layout : layouts) {
        for (const bool is_arbitrary_medium : {false, true}) {
            if (is_arbitrary_medium && !has_arbitrary(scene)) continue;
            configs.push_back({.layout = layout,
                               .is_arbitrary_medium = is_arbitrary_medium,
                               .is_static_high = is_static_high,
                               .is_robust = is_robust});
        }
    }
    return configs;
}

}  // namespace zoe
