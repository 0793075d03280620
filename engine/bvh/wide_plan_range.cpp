#include "engine/bvh/wide_plan_range.h"

#include <algorithm>
#include <cstddef>

#include "engine/bvh/wide_plan.h"
#include "engine/math/simd_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "engine/bvh/wide_plan_range.cpp"
#include <hwy/foreach_target.h>  // Compiles what follows once an instruction set.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace zoe {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Plan = CollapseScratch::Plan;
using FloatTag = hn::CappedTag<float, kWidth>;
using IntTag = hn::RebindToSigned<FloatTag>;

// [k] of two subtrees as a forest of k + 1 trees.
struct Forests {
    alignas(32) float costs[kWidth];     // The least; none for k = 0.
    alignas(32) int32_t firsts[kWidth];  // How many trees the first then gets, as few as may be, where a choice has it.
};

// All pairs of i + 1 and j + 1 trees with i + 1 + j = k at once, a lane for each k: the second's costs, shifted.
HWY_INLINE void find_forests(const Plan& first, const CollapsePlan& second, Forests* best) {
    const FloatTag d;
    const IntTag ints;
    // One tree where a choice has it for k + 1 trees.
    alignas(32) static constexpr int32_t kPlacedOne[kWidth] = {0, 1, 1 << 3, 1 << 6, 1 << 9, 1 << 12, 1 << 15, 1 << 18};
    for (size_t lane = 0; lane < kWidth; lane += hn::Lanes(d)) {
        const auto one = hn::Load(ints, kPlacedOne + lane);
        auto costs = hn::Set(d, std::numeric_limits<float>::infinity());
        auto firsts = one, trees = one;
        const float* shifted = second.plan.costs + lane;
        for (int i = 0; i < kWidth - 1; ++i) {
            const auto pair = hn::Add(hn::Set(d, first.costs[i]), hn::LoadU(d, --shifted));
            const auto is_less = hn::Lt(pair, costs);
            costs = hn::Min(pair, costs);
            firsts = hn::IfThenElse(hn::RebindMask(ints, is_less), trees, firsts);
            trees = hn::Add(trees, one);
        }
        hn::Store(costs, d, best->costs + lane);
        hn::Store(firsts, ints, best->firsts + lane);
    }
}

// Chance of a ray through the root to enter the node.
HWY_INLINE float chance(const PlanTask& task, const BvhNode& node) {
    return task.root_area > 0.0 ? static_cast<float>(node.bounds().half_area() / task.root_area) : 0.0f;
}

HWY_INLINE float leaf_cost(const PlanTask& task, float chance, uint32_t blocks) {
    return chance * task.config.block_cost * static_cast<float>(blocks);
}

HWY_INLINE uint32_t block_count(const PlanTask& task, uint32_t primitive_count) {
    return (primitive_count + task.config.block_size - 1) / task.config.block_size;
}

// The same as however many trees.
HWY_INLINE uint32_t plan_leaf(float cost, uint32_t primitive_count, Plan* plan) {
    plan->primitive_count = primitive_count;
    std::fill_n(plan->costs, kWidth - 1, cost);
    return CollapseChoice::kLeaf | (CollapseChoice::kLeaf - CollapseChoice::kSame);
}

HWY_INLINE uint32_t plan_inner(const PlanTask& task, const BvhNode& node, const Plan& first, const CollapsePlan& second,
                               Plan* plan) {
    plan->primitive_count = first.primitive_count + second.plan.primitive_count;
    const uint32_t blocks = block_count(task, plan->primitive_count);
    const float chance = HWY_NAMESPACE::chance(task, node);
    // A whole block is never worth a node; else the cheaper one, and a tree goes on where areas are 0. A block more than a
    // leaf may have is no leaf.
    if (blocks <= 1) return plan_leaf(leaf_cost(task, chance, blocks), plan->primitive_count, plan);
    const bool is_too_large = blocks > task.config.max_leaf_blocks;
    const float as_leaf = is_too_large ? std::numeric_limits<float>::infinity() : leaf_cost(task, chance, blocks);
    Forests forests;
    find_forests(first, second, &forests);
    const float as_node = chance + forests.costs[kWidth - 1];
    uint32_t choice = as_leaf < as_node ? CollapseChoice::kLeaf : 0;
    plan->costs[0] = std::min(as_leaf, as_node);
    for (int k = 1; k < kWidth; ++k) choice |= static_cast<uint32_t>(forests.firsts[k]);
    for (int k = 1; k < kWidth - 1; ++k) {
        plan->costs[k] = std::min(plan->costs[k - 1], forests.costs[k]);
        choice |= plan->costs[k] == plan->costs[k - 1] ? CollapseChoice::kSame << (k - 1) : 0;
    }
    return choice;
}

void plan_some(const PlanTask& task, uint32_t begin, uint32_t end, uint32_t* choices, PlanRange* range) {
    for (uint32_t n = end; n-- > begin;) {
        const BvhNode& node = task.nodes[n];
        Plan& plan = range->plans[n - begin].plan;
        range->waits[n - begin] = true;
        if (node.is_leaf()) {
            const float cost = leaf_cost(task, chance(task, node), block_count(task, node.count));
            choices[n] = plan_leaf(cost, node.count, &plan);
            continue;
        }
        plan.primitive_count = 0;
        if (node.first + 1 >= end) continue;
        const uint32_t at = node.first - begin;
        const CollapsePlan &first = range->plans[at], &second = range->plans[at + 1];
        if (first.plan.primitive_count == 0 || second.plan.primitive_count == 0) continue;
        choices[n] = plan_inner(task, node, first.plan, second, &plan);
        range->waits[at] = range->waits[at + 1] = false;
    }
}

uint32_t plan_one(const PlanTask& task, uint32_t node, const CollapsePlan& first, const CollapsePlan& second,
                  CollapsePlan* plan) {
    return plan_inner(task, task.nodes[node], first.plan, second, &plan->plan);
}

}  // namespace HWY_NAMESPACE
}  // namespace zoe
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace zoe {

HWY_EXPORT(plan_some);
HWY_EXPORT(plan_one);

void plan_range(const PlanTask& task, uint32_t begin, uint32_t end, uint32_t* choices, PlanRange* range) {
    HWY_DYNAMIC_DISPATCH(plan_some)(task, begin, end, choices, range);
}

uint32_t plan_node(const PlanTask& task, uint32_t node, const CollapsePlan& first, const CollapsePlan& second,
                   CollapsePlan* plan) {
    return HWY_DYNAMIC_DISPATCH(plan_one)(task, node, first, second, plan);
}

}  // namespace zoe

#endif  // HWY_ONCE
