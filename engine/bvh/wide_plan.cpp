#include "engine/bvh/wide_plan.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>

#include "engine/math/parallel.h"

namespace zoe {

namespace {

constexpr size_t kPlanGrain = 4096;
constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr uint32_t kWaits = 1u << 31;  // While nodes are planned, in place of a choice: the node waits, and where.

using Costs = float __attribute__((vector_size(kWidth * sizeof(float))));
using Counts = int32_t __attribute__((vector_size(kWidth * sizeof(int32_t))));

// One tree where a choice has it for k + 1 trees, in lane k.
constexpr Counts kPlacedOne{0, 1, 1 << 3, 1 << 6, 1 << 9, 1 << 12, 1 << 15, 1 << 18};

// Plans bottom up what each subtree costs least as.
class Planner {
public:
    Planner(const Bvh& bvh, const CollapseConfig& config, CollapseScratch* scratch)
        : bvh_(bvh), config_(config), scratch_(*scratch), root_area_(bvh.bounds().half_area()) {}

    // Children stand after their parents, most of them near: ranges of nodes are planned apart from each other, and what
    // has a child in another range, or above such a node, is left for the end. Costs are kept no longer than until the
    // parent is planned.
    void plan() {
        const size_t count = bvh_.nodes.size(), range_count = (count + kPlanGrain - 1) / kPlanGrain;
        scratch_.choices.resize(count);
        if (scratch_.waiting.size() < range_count) scratch_.waiting.resize(range_count);
        parallel_for(0, count, kPlanGrain, [&](size_t begin, size_t end) {
            plan_range(static_cast<uint32_t>(begin), static_cast<uint32_t>(end), &scratch_.waiting[begin / kPlanGrain]);
        });
        for (size_t range = range_count; range-- > 0;) {
            for (Waiting& at : scratch_.waiting[range]) {
                if (at.plan.primitive_count > 0) continue;
                const uint32_t first = bvh_.nodes[at.node].first;
                at.choice = plan_inner(at.node, waiting(first).plan, waiting(first + 1).plan, &at.plan);
            }
        }
        for (size_t range = 0; range < range_count; ++range) {
            for (const Waiting& at : scratch_.waiting[range]) scratch_.choices[at.node] = at.choice;
        }
    }

private:
    using Plan = CollapseScratch::Plan;
    using Waiting = CollapseScratch::Waiting;

    // [k] of two subtrees as a forest of k + 1 trees.
    struct Forests {
        Costs costs;    // The least; none for k = 0.
        Counts firsts;  // How many trees the first then gets, as few as may be, where a choice has it.
    };

    // Chance of a ray through the root to enter the node.
    float chance(const BvhNode& node) const {
        return root_area_ > 0.0 ? static_cast<float>(node.bounds().half_area() / root_area_) : 0.0f;
    }

    // All pairs of i + 1 and j + 1 trees with i + 1 + j = k at once, the second's costs being shifted along the register.
    static Forests forests_of(const Plan& a, const Plan& b) {
        float shifted[2 * kWidth];
        std::fill_n(shifted, kWidth, kInfinity);
        std::copy_n(b.costs, kWidth - 1, shifted + kWidth);
        Forests best{Costs{} + kInfinity, kPlacedOne};
        Counts firsts = kPlacedOne;
        for (int i = 0; i < kWidth - 1; ++i) {
            Costs costs;
            std::memcpy(&costs, shifted + kWidth - 1 - i, sizeof costs);
            costs += a.costs[i];
            const Costs least = costs < best.costs ? costs : best.costs;
            const Counts is_less = least != best.costs;  // By the least, which takes one instruction.
            best.costs = least;
            best.firsts = is_less ? firsts : best.firsts;
            firsts += kPlacedOne;
        }
        return best;
    }

    void plan_range(uint32_t begin, uint32_t end, std::vector<Waiting>* waiting) {
        std::array<Plan, kPlanGrain> plans;
        std::array<bool, kPlanGrain> waits;
        waiting->clear();
        for (uint32_t n = end; n-- > begin;) {
            const BvhNode& node = bvh_.nodes[n];
            Plan& plan = plans[n - begin];
            waits[n - begin] = true;
            if (node.is_leaf()) {
                scratch_.choices[n] = plan_leaf(node, node.count, &plan);
                continue;
            }
            plan.primitive_count = 0;
            if (node.first + 1 >= end) continue;
            const uint32_t first = node.first - begin;
            if (plans[first].primitive_count == 0 || plans[first + 1].primitive_count == 0) continue;
            scratch_.choices[n] = plan_inner(n, plans[first], plans[first + 1], &plan);
            waits[first] = waits[first + 1] = false;
        }
        for (uint32_t n = end; n-- > begin;) {
            if (!waits[n - begin]) continue;
            waiting->push_back({n, scratch_.choices[n], plans[n - begin]});
            scratch_.choices[n] = kWaits | static_cast<uint32_t>(waiting->size() - 1);
        }
    }

    const Waiting& waiting(uint32_t n) const { return scratch_.waiting[n / kPlanGrain][scratch_.choices[n] & ~kWaits]; }

    float leaf_cost(const BvhNode& node, uint32_t blocks) const {
        return chance(node) * config_.block_cost * static_cast<float>(blocks);
    }
    uint32_t blocks(uint32_t primitive_count) const {
        return (primitive_count + config_.block_size - 1) / config_.block_size;
    }

    // The same as however many trees.
    uint32_t plan_leaf(const BvhNode& node, uint32_t primitive_count, Plan* plan) const {
        plan->primitive_count = primitive_count;
        std::fill_n(plan->costs, kWidth - 1, leaf_cost(node, blocks(primitive_count)));
        return CollapseChoice::kLeaf | (CollapseChoice::kLeaf - CollapseChoice::kSame);
    }

    // Returns the choice.
    uint32_t plan_inner(uint32_t n, const Plan& a, const Plan& b, Plan* plan) const {
        const BvhNode& node = bvh_.nodes[n];
        plan->primitive_count = a.primitive_count + b.primitive_count;
        const uint32_t blocks = this->blocks(plan->primitive_count);
        // A whole block is never worth a node; else the cheaper one, and a tree goes on where areas are 0. A block more than
        // a leaf may have is no leaf.
        if (blocks <= 1) return plan_leaf(node, plan->primitive_count, plan);
        const float leaf_cost = blocks > config_.max_leaf_blocks ? kInfinity : this->leaf_cost(node, blocks);
        const Forests forests = forests_of(a, b);
        const float node_cost = chance(node) + forests.costs[kWidth - 1];
        uint32_t choice = leaf_cost < node_cost ? CollapseChoice::kLeaf : 0;
        plan->costs[0] = std::min(leaf_cost, node_cost);
        for (int k = 1; k < kWidth; ++k) choice |= static_cast<uint32_t>(forests.firsts[k]);
        for (int k = 1; k < kWidth - 1; ++k) {
            plan->costs[k] = std::min(plan->costs[k - 1], forests.costs[k]);
            if (plan->costs[k] == plan->costs[k - 1]) choice |= CollapseChoice::kSame << (k - 1);
        }
        return choice;
    }

    const Bvh& bvh_;
    const CollapseConfig& config_;
    CollapseScratch& scratch_;
    const double root_area_;
};

}  // namespace

void plan_collapse(const Bvh& bvh, const CollapseConfig& config, CollapseScratch* scratch) {
    Planner(bvh, config, scratch).plan();
}

}  // namespace zoe
