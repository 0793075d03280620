#pragma once

#include <array>
#include <cstdint>
#include <limits>

#include "engine/bvh/wide.h"

namespace zoe {

inline constexpr uint32_t kPlanRange = 2048;  ///< Nodes that are planned by one thread.

/// A plan, and before it what forests of no trees cost: so pairs of forests are read side by side.
struct alignas(64) CollapsePlan {
    CollapsePlan() { none.fill(std::numeric_limits<float>::infinity()); }
    std::array<float, kWidth> none;
    CollapseScratch::Plan plan;
};

/// A binary tree that becomes a wide one.
struct PlanTask {
    const BvhNode* nodes;
    CollapseConfig config;
    double root_area;
};

struct PlanRange {
    std::array<CollapsePlan, kPlanRange> plans;
    std::array<bool, kPlanRange> waits;  ///< Its parent was not planned.
};

/// Plans the nodes [begin, end) from the back, but for those that have a child outside of the range, or above such a node:
/// their plans have no primitives.
/// choices    result: [node_count] only those of the range are written; see CollapseChoice.
/// Cost       O(nodes), by the best instruction set that the processor has; the same choices on all of them.
void plan_range(const PlanTask& task, uint32_t begin, uint32_t end, uint32_t* choices, PlanRange* range);

/// Plans a node by its children's plans.
/// Returns    the choice.
uint32_t plan_node(const PlanTask& task, uint32_t node, const CollapsePlan& first, const CollapsePlan& second,
                   CollapsePlan* plan);

}  // namespace zoe
