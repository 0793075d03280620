#include "engine/bvh/wide_plan.h"

#include <array>

#include "engine/bvh/wide_plan_range.h"
#include "engine/math/parallel.h"

namespace zoe {

namespace {

using Waiting = CollapseScratch::Waiting;

// Takes the place of a choice while nodes are planned: the node waits, and where.
constexpr uint32_t kWaits = 1u << 31;

// What ranges have left: nodes whose parents are planned apart from them, and those parents.
class Rest {
public:
    explicit Rest(const PlanTask& task, CollapseScratch* scratch) : task_(task), scratch_(*scratch) {}

    void plan(size_t range_count) {
        std::array<CollapsePlan, 3> plans;
        for (size_t range = range_count; range-- > 0;) {
            for (Waiting& at : scratch_.waiting[range]) {
                if (at.plan.primitive_count > 0) continue;
                const uint32_t first = task_.nodes[at.node].first;
                for (uint32_t k = 0; k < 2; ++k) plans[k].plan = waiting(first + k).plan;
                at.choice = plan_node(task_, at.node, plans[0], plans[1], &plans[2]);
                at.plan = plans[2].plan;
            }
        }
        for (size_t range = 0; range < range_count; ++range) {
            for (const Waiting& at : scratch_.waiting[range]) scratch_.choices[at.node] = at.choice;
        }
    }

private:
    const Waiting& waiting(uint32_t n) const { return scratch_.waiting[n / kPlanRange][scratch_.choices[n] & ~kWaits]; }

    const PlanTask& task_;
    CollapseScratch& scratch_;
};

void wait_for_others(const PlanRange& range, uint32_t begin, uint32_t end, CollapseScratch* scratch) {
    std::vector<Waiting>& waiting = scratch->waiting[begin / kPlanRange];
    waiting.clear();
    for (uint32_t n = end; n-- > begin;) {
        if (!range.waits[n - begin]) continue;
        waiting.push_back({n, scratch->choices[n], range.plans[n - begin].plan});
        scratch->choices[n] = kWaits | static_cast<uint32_t>(waiting.size() - 1);
    }
}

}  // namespace

// Children stand after their parents, most of them near: ranges of nodes are planned apart from each other, and what has a
// child in another range, or above such a node, is left for the end. Costs are kept no longer than until the parent is
// planned.
void plan_collapse(const Bvh& bvh, const CollapseConfig& config, CollapseScratch* scratch) {
    const size_t count = bvh.nodes.size(), range_count = (count + kPlanRange - 1) / kPlanRange;
    scratch->choices.resize(count);
    if (scratch->waiting.size() < range_count) scratch->waiting.resize(range_count);
    const PlanTask task{.nodes = bvh.nodes.data(), .config = config, .root_area = bvh.bounds().half_area()};
    parallel_for(0, count, kPlanRange, [&](size_t from, size_t to) {
        PlanRange range;
        const auto begin = static_cast<uint32_t>(from), end = static_cast<uint32_t>(to);
        plan_range(task, begin, end, scratch->choices.data(), &range);
        wait_for_others(range, begin, end, scratch);
    });
    Rest(task, scratch).plan(range_count);
}

}  // namespace zoe
