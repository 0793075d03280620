#include "apps/bench/compare.h"

#include <algorithm>
#include <cmath>

namespace zoe {

bool is_disagreement(const Hit& ours, const Hit& peers) {
    if (bool(ours) != bool(peers)) return true;
    if (!ours) return false;
    if (ours.node != peers.node || std::isnan(ours.t) || std::isnan(peers.t)) return true;
    return ours.primitive != peers.primitive && std::abs(ours.t - peers.t) > 1e-4f * std::max(ours.t, peers.t);
}

void compare_closest(int frame, RayKind kind, std::span<const Ray> rays, std::span<const Hit> ours,
                     std::span<const Hit> peers, std::vector<Disagreement>* disagreements) {
    for (size_t k = 0; k < rays.size(); ++k) {
        if (is_disagreement(ours[k], peers[k])) disagreements->push_back({frame, kind, k, rays[k], ours[k], peers[k]});
    }
}

void compare_any(int frame, RayKind kind, std::span<const Ray> rays, std::span<const uint8_t> ours,
                 std::span<const uint8_t> peers, std::vector<Disagreement>* disagreements) {
    const auto hit = [](bool is_hit) { return is_hit ? Hit{.t = 0.0f} : Hit{}; };
    for (size_t k = 0; k < rays.size(); ++k) {
        if (ours[k] != peers[k]) disagreements->push_back({frame, kind, k, rays[k], hit(ours[k]), hit(peers[k])});
    }
}

}  // namespace zoe
