#include <algorithm>
#include <array>
#include <cassert>
#include <cstring>
#include <limits>

#include "engine/bvh/wide.h"
#include "engine/math/parallel.h"

namespace zoe {

namespace {

constexpr size_t kPlanGrain = 4096, kMakeGrain = 128;
constexpr float kInfinity = std::numeric_limits<float>::infinity();

// Plans bottom up what each subtree costs least as, then makes it so top down.
class Collapse {
public:
    Collapse(const Bvh& bvh, const CollapseConfig& config, CollapseScratch* scratch)
        : bvh_(bvh), config_(config), scratch_(*scratch), root_area_(bvh.bounds().half_area()) {}

    // Children stand after their parents, most of them near: ranges of nodes are planned apart from each other, and what
    // has a child in another range, or above such a node, is left for the end.
    void plan() {
        const auto count = static_cast<uint32_t>(bvh_.nodes.size());
        scratch_.plans.resize(count);
        parallel_for(0, count, kPlanGrain, [&](size_t begin, size_t end) {
            for (auto n = static_cast<uint32_t>(end); n-- > begin;) {
                const BvhNode& node = bvh_.nodes[n];
                if (node.is_leaf() || (node.first + 1 < end && is_planned(node.first) && is_planned(node.first + 1))) {
                    plan_node(n);
                } else {
                    scratch_.plans[n].primitive_count = 0;
                }
            }
        });
        for (uint32_t n = count; n-- > 0;) {
            if (!is_planned(n)) plan_node(n);
        }
    }

    void make(WideBvh* wide, std::vector<uint32_t>* slots) {
        wide->nodes.clear();
        wide->level_ends.clear();
        slots->clear();
        scratch_.open.assign(1, 0);
        while (!scratch_.open.empty()) {
            make_level(wide, slots);
            std::swap(scratch_.open, scratch_.next);
        }
        // Each back where it was, so that the same tree made again finds the same room.
        if (wide->level_ends.size() % 2 != 0) std::swap(scratch_.open, scratch_.next);
    }

private:
    using Plan = CollapseScratch::Plan;
    using Part = CollapseScratch::Part;
    using Costs = float __attribute__((vector_size(kWidth * sizeof(float))));

    // Chance of a ray through the root to enter the node.
    float chance(const BvhNode& node) const {
        return root_area_ > 0.0 ? static_cast<float>(node.bounds().half_area() / root_area_) : 0.0f;
    }

    // How many trees of a forest the first child gets, where that costs least.
    int first_trees(uint32_t n, int trees) const {
        const Plan &a = scratch_.plans[bvh_.nodes[n].first], &b = scratch_.plans[bvh_.nodes[n].first + 1];
        float best = kInfinity;
        int best_k = 1;
        for (int k = 1; k < trees; ++k) {
            const float cost = a.costs[std::min(k, kWidth - 1) - 1] + b.costs[std::min(trees - k, kWidth - 1) - 1];
            if (cost < best) {
                best = cost;
                best_k = k;
            }
        }
        return best_k;
    }

    // [k] the least cost of two subtrees as a forest of k + 1 trees, none for k = 0: all pairs of i + 1 and j + 1 trees with
    // i + 1 + j = k at once, the second's costs being shifted along the register.
    static std::array<float, kWidth> forest_costs(const Plan& a, const Plan& b) {
        float shifted[2 * kWidth];
        std::fill_n(shifted, kWidth, kInfinity);
        std::copy_n(b.costs, kWidth - 1, shifted + kWidth);
        Costs best = Costs{} + kInfinity;
        for (int i = 0; i < kWidth - 1; ++i) {
            Costs costs;
            std::memcpy(&costs, shifted + kWidth - 1 - i, sizeof costs);
            costs += a.costs[i];
            best = costs < best ? costs : best;
        }
        std::array<float, kWidth> result;
        std::memcpy(result.data(), &best, sizeof best);
        return result;
    }

    bool is_planned(uint32_t n) const { return scratch_.plans[n].primitive_count > 0; }

    void plan_node(uint32_t n) {
        const BvhNode& node = bvh_.nodes[n];
        Plan& plan = scratch_.plans[n];
        plan.primitive_count =
            node.is_leaf() ? node.count
                           : scratch_.plans[node.first].primitive_count + scratch_.plans[node.first + 1].primitive_count;
        const uint32_t blocks = (plan.primitive_count + config_.block_size - 1) / config_.block_size;
        const float chance = this->chance(node);
        // A block more than a leaf may have is no leaf, unless nobody can split it.
        const float leaf_cost = blocks > config_.max_leaf_blocks && !node.is_leaf()
                                    ? kInfinity
                                    : chance * config_.block_cost * static_cast<float>(blocks);
        // A whole block is never worth a node; else the cheaper one, and a tree goes on where areas are 0.
        if (node.is_leaf() || blocks <= 1) {
            plan.is_leaf = 1;
            std::fill_n(plan.costs, kWidth - 1, leaf_cost);
            return;
        }
        const std::array<float, kWidth> forests = forest_costs(scratch_.plans[node.first], scratch_.plans[node.first + 1]);
        const float node_cost = chance + forests[kWidth - 1];
        plan.is_leaf = leaf_cost < node_cost;
        plan.costs[0] = std::min(leaf_cost, node_cost);
        for (int k = 1; k < kWidth - 1; ++k) plan.costs[k] = std::min(plan.costs[k - 1], forests[k]);
    }

    bool is_planned_as_leaf(uint32_t n) const { return scratch_.plans[n].is_leaf; }

    // Makes the wide nodes of `open`, the primitives of their leaves, and `next`. Parts of the level are made in parallel,
    // their children numbered from 0; then all find their places.
    void make_level(WideBvh* wide, std::vector<uint32_t>* slots) {
        const size_t level_begin = wide->nodes.size(), level_end = level_begin + scratch_.open.size();
        wide->nodes.resize(level_end);
        wide->level_ends.push_back(static_cast<uint32_t>(level_end));
        const size_t part_count = (scratch_.open.size() + kMakeGrain - 1) / kMakeGrain;
        if (scratch_.parts.size() < part_count) scratch_.parts.resize(part_count);
        parallel_for(0, scratch_.open.size(), kMakeGrain, [&](size_t begin, size_t end) {
            Part& part = scratch_.parts[begin / kMakeGrain];
            part.next.clear();
            part.slots.clear();
            for (size_t k = begin; k < end; ++k) wide->nodes[level_begin + k] = make_node(scratch_.open[k], &part);
        });
        size_t next_count = 0, slot_count = slots->size();
        for (size_t k = 0; k < part_count; ++k) {
            scratch_.parts[k].first_next = static_cast<uint32_t>(next_count);
            scratch_.parts[k].first_slot = static_cast<uint32_t>(slot_count);
            next_count += scratch_.parts[k].next.size();
            slot_count += scratch_.parts[k].slots.size();
        }
        assert(slot_count / config_.block_size <= kMaxBlocks);
        scratch_.next.resize(next_count);
        slots->resize(slot_count);
        parallel_for(0, scratch_.open.size(), kMakeGrain, [&](size_t begin, size_t end) {
            const Part& part = scratch_.parts[begin / kMakeGrain];
            std::copy(part.next.begin(), part.next.end(), scratch_.next.begin() + part.first_next);
            std::copy(part.slots.begin(), part.slots.end(), slots->begin() + part.first_slot);
            const auto first_node = static_cast<uint32_t>(level_end) + part.first_next;
            const uint32_t first_block = part.first_slot / config_.block_size;
            for (size_t k = level_begin + begin; k < level_begin + end; ++k) {
                for (uint32_t& child : wide->nodes[k].child) {
                    if (child != kEmptyChild) child += is_leaf(child) ? first_block : first_node;
                }
            }
        });
    }

    WideNode make_node(uint32_t n, Part* part) const {
        WideNode made{};
        int count = 0;
        const auto add = [&](uint32_t child) {
            made.set_box(count, bvh_.nodes[child].bounds());
            made.child[count++] = is_planned_as_leaf(child) ? make_leaf(child, part) : make_child(child, part);
        };
        // Opens subtrees until each is one child; of the two at hand the first goes on, the second waits.
        struct Forest {
            uint32_t node;
            int trees;
        };
        Forest open[kWidth];
        int open_count = 0;
        open[open_count++] = {n, kWidth};
        bool is_top = true;
        while (open_count > 0) {
            Forest at = open[--open_count];
            const bool must_split = is_top && !is_planned_as_leaf(at.node);
            is_top = false;
            if (!must_split) {
                at.trees = std::min(at.trees, kWidth - 1);
                const float* costs = scratch_.plans[at.node].costs;
                while (at.trees > 1 && costs[at.trees - 1] == costs[at.trees - 2]) --at.trees;
            }
            if (at.trees == 1 || bvh_.nodes[at.node].is_leaf()) {
                add(at.node);
                continue;
            }
            const int first = first_trees(at.node, at.trees);
            open[open_count++] = {bvh_.nodes[at.node].first + 1, at.trees - first};
            open[open_count++] = {bvh_.nodes[at.node].first, first};
        }
        for (; count < kWidth; ++count) {
            made.set_box(count, Aabb{});
            made.child[count] = kEmptyChild;
        }
        return made;
    }

    static uint32_t make_child(uint32_t n, Part* part) {
        part->next.push_back(n);
        return static_cast<uint32_t>(part->next.size()) - 1;
    }

    uint32_t make_leaf(uint32_t n, Part* part) const {
        std::vector<uint32_t>& slots = part->slots;
        const auto first = static_cast<uint32_t>(slots.size() / config_.block_size);
        part->below.assign(1, n);
        while (!part->below.empty()) {
            const BvhNode& node = bvh_.nodes[part->below.back()];
            part->below.pop_back();
            if (node.is_leaf()) {
                const auto begin = bvh_.primitives.begin() + node.first;
                slots.insert(slots.end(), begin, begin + node.count);
            } else {
                part->below.push_back(node.first + 1);
                part->below.push_back(node.first);
            }
        }
        if (config_.has_duplicates) {
            const auto begin = slots.begin() + first * config_.block_size;
            std::sort(begin, slots.end());
            slots.erase(std::unique(begin, slots.end()), slots.end());
        }
        while (slots.size() % config_.block_size != 0) slots.push_back(kEmptyChild);
        const auto count = static_cast<uint32_t>(slots.size() / config_.block_size) - first;
        assert(count <= kMaxLeafBlocks);
        return leaf_child(first, count);
    }

    const Bvh& bvh_;
    const CollapseConfig& config_;
    CollapseScratch& scratch_;
    const double root_area_;
};

}  // namespace

void collapse(const Bvh& bvh, const CollapseConfig& config, WideBvh* wide, std::vector<uint32_t>* slots,
              CollapseScratch* scratch) {
    assert(config.max_leaf_blocks >= 1 && config.max_leaf_blocks <= kMaxLeafBlocks);
    if (bvh.nodes.empty()) {
        wide->nodes.clear();
        wide->level_ends.clear();
        slots->clear();
        return;
    }
    Collapse collapse(bvh, config, scratch);
    collapse.plan();
    collapse.make(wide, slots);
}

}  // namespace zoe
