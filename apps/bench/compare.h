#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "apps/bench/judge.h"

namespace zoe {

/// Closest hits that differ: one side misses, another node, or another primitive at a t that differs by more than 1e-4 of
/// the larger one. NaN differs.
bool is_disagreement(const Hit& ours, const Hit& peers);

/// Appends the rays of a frame's batch that disagree.
/// ours, peers  [ray_count]
void compare_closest(int frame, RayKind kind, std::span<const Ray> rays, std::span<const Hit> ours,
                     std::span<const Hit> peers, std::vector<Disagreement>* disagreements);
void compare_any(int frame, RayKind kind, std::span<const Ray> rays, std::span<const uint8_t> ours,
                 std::span<const uint8_t> peers, std::vector<Disagreement>* disagreements);

}  // namespace zoe
