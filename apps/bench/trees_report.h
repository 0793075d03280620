#pragma once

#include <string>
#include <utility>
#include <vector>

#include "apps/bench/trees.h"

namespace zoe {

/// A table for people: a line a tree.
std::string trees_table(const TreeComparison& comparison);

/// Over all scenes: what SAH saves over a median split, what bins save over the full sweep and lose by it; with a peer, each
/// of our other trees beside each of the peer's. Ratios are geometric means; above 1, ours is faster, or smaller.
std::string trees_summary(const std::vector<TreeComparison>& comparisons);

/// {"machine": {...}, "trees": [{"scene": ..., "triangles": ..., "rays": {...}, "rows": [...]}]}.
std::string trees_json(const std::vector<TreeComparison>& comparisons,
                       const std::vector<std::pair<std::string, std::string>>& machine);

}  // namespace zoe
