#include <algorithm>
#include <cassert>
#include <limits>

#include "engine/bvh/wide.h"

namespace zoe {

namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

// Plans bottom up what each subtree costs least as, then makes it so top down.
class Collapse {
public:
    Collapse(const Bvh& bvh, const CollapseConfig& config, CollapseScratch* scratch)
        : bvh_(bvh), config_(config), scratch_(*scratch), root_area_(bvh.bounds().half_area()) {}

    void plan() {
        scratch_.plans.resize(bvh_.nodes.size());
        for (uint32_t n = static_cast<uint32_t>(bvh_.nodes.size()); n-- > 0;) plan_node(n);
    }

    void make(WideBvh* wide, std::vector<uint32_t>* slots) {
        wide->nodes.clear();
        wide->level_ends.clear();
        slots->clear();
        scratch_.open.assign(1, 0);
        uint32_t node_count = 1;
        while (!scratch_.open.empty()) {
            scratch_.next.clear();
            wide->level_ends.push_back(node_count);
            for (const uint32_t n : scratch_.open) wide->nodes.push_back(make_node(n, node_count, slots));
            node_count += static_cast<uint32_t>(scratch_.next.size());
            std::swap(scratch_.open, scratch_.next);
        }
    }

private:
    using Plan = CollapseScratch::Plan;

    // Chance of a ray through the root to enter the node.
    float chance(const BvhNode& node) const {
        return root_area_ > 0.0 ? static_cast<float>(node.bounds().half_area() / root_area_) : 0.0f;
    }
    uint32_t block_total(uint32_t primitive_count) const {
        return (primitive_count + config_.block_size - 1) / config_.block_size;
    }
    float leaf_cost(uint32_t n) const {
        const uint32_t blocks = block_total(scratch_.plans[n].primitive_count);
        if (blocks > config_.max_leaf_blocks && !bvh_.nodes[n].is_leaf()) return kInfinity;
        return chance(bvh_.nodes[n]) * config_.block_cost * static_cast<float>(blocks);
    }
    // The least cost of the two children as a forest of at most `trees`, and how many of them the first one gets.
    float split_cost(uint32_t n, int trees, int* first_trees) const {
        const Plan &a = scratch_.plans[bvh_.nodes[n].first], &b = scratch_.plans[bvh_.nodes[n].first + 1];
        float best = kInfinity;
        *first_trees = 1;
        for (int k = 1; k < trees; ++k) {
            const float cost = a.costs[std::min(k, kWidth - 1) - 1] + b.costs[std::min(trees - k, kWidth - 1) - 1];
            if (cost < best) {
                best = cost;
                *first_trees = k;
            }
        }
        return best;
    }
    float node_cost(uint32_t n) const {
        int ignored;
        return bvh_.nodes[n].is_leaf() ? kInfinity : chance(bvh_.nodes[n]) + split_cost(n, kWidth, &ignored);
    }

    void plan_node(uint32_t n) {
        const BvhNode& node = bvh_.nodes[n];
        Plan& plan = scratch_.plans[n];
        plan.primitive_count =
            node.is_leaf() ? node.count
                           : scratch_.plans[node.first].primitive_count + scratch_.plans[node.first + 1].primitive_count;
        const bool is_whole = node.is_leaf() || plan.primitive_count <= config_.block_size;
        plan.costs[0] = is_whole ? leaf_cost(n) : std::min(leaf_cost(n), node_cost(n));
        for (int k = 1; k < kWidth - 1; ++k) {
            int ignored;
            plan.costs[k] = is_whole ? plan.costs[0] : std::min(plan.costs[k - 1], split_cost(n, k + 1, &ignored));
        }
    }

    bool is_planned_as_leaf(uint32_t n) const {
        // A whole block is never worth a node; else the cheaper one, and a tree goes on where areas are 0.
        return bvh_.nodes[n].is_leaf() || scratch_.plans[n].primitive_count <= config_.block_size ||
               leaf_cost(n) < node_cost(n);
    }

    WideNode make_node(uint32_t n, uint32_t first_free_node, std::vector<uint32_t>* slots) {
        WideNode made{};
        int count = 0;
        const auto add = [&](uint32_t child) {
            made.set_box(count, bvh_.nodes[child].bounds());
            made.child[count++] = is_planned_as_leaf(child) ? make_leaf(child, slots) : make_child(child, first_free_node);
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
            int first_trees;
            split_cost(at.node, at.trees, &first_trees);
            open[open_count++] = {bvh_.nodes[at.node].first + 1, at.trees - first_trees};
            open[open_count++] = {bvh_.nodes[at.node].first, first_trees};
        }
        for (; count < kWidth; ++count) {
            made.set_box(count, Aabb{});
            made.child[count] = kEmptyChild;
        }
        return made;
    }

    uint32_t make_child(uint32_t n, uint32_t first_free_node) {
        scratch_.next.push_back(n);
        return first_free_node + static_cast<uint32_t>(scratch_.next.size()) - 1;
    }

    uint32_t make_leaf(uint32_t n, std::vector<uint32_t>* slots) {
        const auto first = static_cast<uint32_t>(slots->size() / config_.block_size);
        scratch_.below.assign(1, n);
        while (!scratch_.below.empty()) {
            const BvhNode& node = bvh_.nodes[scratch_.below.back()];
            scratch_.below.pop_back();
            if (node.is_leaf()) {
                const auto begin = bvh_.primitives.begin() + node.first;
                slots->insert(slots->end(), begin, begin + node.count);
            } else {
                scratch_.below.push_back(node.first + 1);
                scratch_.below.push_back(node.first);
            }
        }
        if (config_.has_duplicates) {
            const auto begin = slots->begin() + first * config_.block_size;
            std::sort(begin, slots->end());
            slots->erase(std::unique(begin, slots->end()), slots->end());
        }
        while (slots->size() % config_.block_size != 0) slots->push_back(kEmptyChild);
        const auto count = static_cast<uint32_t>(slots->size() / config_.block_size) - first;
        assert(count <= kMaxLeafBlocks && first + count <= kMaxBlocks);
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
