#include "engine/bvh/build_clusters.h"

#include <utility>

namespace zoe {

Bvh build_clusters(std::span<const Aabb> boxes, const ClusterConfig& config, Bvh storage, PlocScratch* scratch) {
    if (boxes.size() <= config.exact_up_to) return build_agglomerative(boxes, std::move(storage));
    return build_ploc(boxes, {.search_radius = config.search_radius}, std::move(storage), scratch);
}

}  // namespace zoe
