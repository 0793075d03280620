#include <algorithm>
#include <cassert>
#include <iterator>

#include "engine/bvh/wide.h"
#include "engine/bvh/wide_plan.h"
#include "engine/math/parallel.h"

namespace zoe {

namespace {

constexpr size_t kMakeGrain = 128;

// Makes the wide nodes that were planned, top down.
class Collapse {
public:
    Collapse(const Bvh& bvh, const CollapseConfig& config, CollapseScratch* scratch)
        : bvh_(bvh), config_(config), scratch_(*scratch) {}

    void make(WideBvh* wide, std::vector<uint32_t>* slots) {
        wide->level_ends.clear();
        slots->clear();
        scratch_.roots.assign(1, 0);
        scratch_.sketches.clear();
        while (scratch_.sketches.size() < scratch_.roots.size()) {
            sketch_level(slots);
            wide->level_ends.push_back(static_cast<uint32_t>(scratch_.sketches.size()));
        }
        resize_anew(&wide->nodes, scratch_.sketches.size());
        for (size_t level = wide->level_ends.size(); level-- > 0;) {
            const size_t level_begin = level == 0 ? 0 : wide->level_ends[level - 1];
            parallel_for(level_begin, wide->level_ends[level], kMakeGrain, [&](size_t begin, size_t end) {
                for (size_t k = begin; k < end; ++k) make_node(scratch_.sketches[k], *wide, &wide->nodes[k]);
            });
        }
    }

private:
    using Sketch = CollapseScratch::Sketch;
    using Part = CollapseScratch::Part;

    // Sketches a level's wide nodes, places the primitives of their leaves, and finds the roots of the level below. Parts of
    // the level are worked on in parallel, their children numbered from 0; then all find their places.
    void sketch_level(std::vector<uint32_t>* slots) {
        const size_t level_begin = scratch_.sketches.size(), level_end = scratch_.roots.size();
        scratch_.sketches.resize(level_end);
        const size_t part_count = (level_end - level_begin + kMakeGrain - 1) / kMakeGrain;
        if (scratch_.parts.size() < part_count) scratch_.parts.resize(part_count);
        parallel_for(level_begin, level_end, kMakeGrain, [&](size_t begin, size_t end) {
            Part& part = scratch_.parts[(begin - level_begin) / kMakeGrain];
            part.next.clear();
            part.slots.clear();
            for (size_t k = begin; k < end; ++k) sketch(scratch_.roots[k], &scratch_.sketches[k], &part);
        });
        size_t next_count = level_end, slot_count = slots->size();
        for (size_t k = 0; k < part_count; ++k) {
            scratch_.parts[k].first_next = static_cast<uint32_t>(next_count);
            scratch_.parts[k].first_slot = static_cast<uint32_t>(slot_count);
            next_count += scratch_.parts[k].next.size();
            slot_count += scratch_.parts[k].slots.size();
        }
        assert(slot_count / config_.block_size <= kMaxBlocks);
        scratch_.roots.resize(next_count);
        slots->resize(slot_count);
        parallel_for(level_begin, level_end, kMakeGrain, [&](size_t begin, size_t end) {
            const Part& part = scratch_.parts[(begin - level_begin) / kMakeGrain];
            std::copy(part.next.begin(), part.next.end(), scratch_.roots.begin() + part.first_next);
            std::copy(part.slots.begin(), part.slots.end(), slots->begin() + part.first_slot);
            const uint32_t first_block = part.first_slot / config_.block_size;
            for (size_t k = begin; k < end; ++k) {
                for (uint32_t& child : scratch_.sketches[k].child) {
                    if (child != kEmptyChild) child += is_leaf(child) ? first_block : part.first_next;
                }
            }
        });
    }

    void sketch(uint32_t n, Sketch* made, Part* part) const {
        int count = 0;
        const auto add = [&](uint32_t child) {
            made->binary[count] = child;
            made->child[count++] =
                CollapseChoice{scratch_.choices[child]}.is_leaf() ? make_leaf(child, part) : make_child(child, part);
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
            const CollapseChoice choice{scratch_.choices[at.node]};
            const bool must_split = is_top && !choice.is_leaf();
            is_top = false;
            if (!must_split) {
                at.trees = std::min(at.trees, kWidth - 1);
                while (at.trees > 1 && choice.is_same_with_fewer(at.trees)) --at.trees;
            }
            if (at.trees == 1) {
                add(at.node);
                continue;
            }
            const int first = choice.first_trees(at.trees);
            open[open_count++] = {bvh_.nodes[at.node].first + 1, at.trees - first};
            open[open_count++] = {bvh_.nodes[at.node].first, first};
        }
        std::fill(made->binary + count, made->binary + kWidth, kEmptyChild);
        std::fill(made->child + count, made->child + kWidth, kEmptyChild);
    }

    // Children first.
    void make_node(const Sketch& sketch, const WideBvh& wide, WideNode* made) const {
        for (int slot = 0; slot < kWidth; ++slot) {
            const uint32_t binary = sketch.binary[slot];
            made->set_box(slot, binary == kEmptyChild ? Aabb{} : bvh_.nodes[binary].bounds());
            made->child[slot] = sketch.child[slot];
        }
        made->is_box_changed = made->is_sum_changed = 0;
        std::fill(std::begin(made->unused), std::end(made->unused), 0);
        sum_costs(wide, config_.block_cost, made);
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
    plan_collapse(bvh, config, scratch);
    Collapse(bvh, config, scratch).make(wide, slots);
}

}  // namespace zoe
