#include <algorithm>
#include <atomic>
#include <cassert>

#include "engine/bvh/blas.h"
#include "engine/bvh/place_block.h"
#include "engine/math/parallel.h"

namespace zoe {

namespace {

constexpr size_t kGrain = 128, kPrefetchAhead = 4;

// What a range of nodes adds to the tree's counts.
struct Counts {
    RefitCounts boxes;
    uint32_t not_finite = 0;
};

// Refits nodes whose children have been.
class Refit {
public:
    Refit(std::span<const glm::vec3> positions, std::span<const glm::uvec3> corners, Blas* blas)
        : positions_(positions), corners_(corners), blas_(*blas) {}

    void fit(WideNode* node, Counts* counts) const {
        bool is_box_changed = false, is_sum_changed = false;
        for (int slot = 0; slot < kWidth; ++slot) {
            const uint32_t child = node->child[slot];
            if (child == kEmptyChild) continue;
            if (!is_leaf(child)) {
                is_sum_changed |= blas_.tree.nodes[child].is_sum_changed != 0;
                if (!blas_.tree.nodes[child].is_box_changed) continue;
            }
            const Aabb box = is_leaf(child) ? fit_leaf(child, counts) : blas_.tree.nodes[child].bounds();
            const Aabb before = node->box(slot);
            ++counts->boxes.fitted;
            if (box.lo == before.lo && box.hi == before.hi) continue;
            node->set_box(slot, box);
            ++counts->boxes.changed;
            is_box_changed = is_sum_changed = true;
        }
        node->is_box_changed = is_box_changed;
        node->is_sum_changed = is_sum_changed;
        if (is_sum_changed) sum_costs(blas_.tree, CollapseConfig{}.block_cost, node);
    }

private:
    Aabb fit_leaf(uint32_t leaf, Counts* counts) const {
        const size_t begin = first_block(leaf), last = blas_.blocks.size() - 1;
        place_detail::SlotBounds bounds;
        for (size_t k = begin; k < begin + block_count(leaf); ++k) {
            // The next leaves' blocks follow.
            place_detail::prefetch(positions_, corners_, blas_.blocks[std::min(k + kPrefetchAhead, last)]);
            counts->not_finite += place_detail::place_block(positions_, corners_, &blas_.blocks[k], &bounds);
        }
        return bounds.box();
    }

    std::span<const glm::vec3> positions_;
    std::span<const glm::uvec3> corners_;
    Blas& blas_;
};

}  // namespace

RefitCounts refit_blas(std::span<const glm::vec3> positions, std::span<const glm::uvec3> corners, Blas* blas) {
    assert(corners.size() == blas->triangle_count && !blas->has_pieces);
    const Refit refit(positions, corners, blas);
    const std::vector<uint32_t>& level_ends = blas->tree.level_ends;
    std::atomic<uint64_t> fitted{0}, changed{0};
    std::atomic<uint32_t> not_finite{0};
    for (size_t level = level_ends.size(); level-- > 0;) {
        parallel_for(level == 0 ? 0 : level_ends[level - 1], level_ends[level], kGrain, [&](size_t begin, size_t end) {
            Counts counts;
            for (size_t k = begin; k < end; ++k) refit.fit(&blas->tree.nodes[k], &counts);
            fitted += counts.boxes.fitted;
            changed += counts.boxes.changed;
            not_finite += counts.not_finite;
        });
    }
    blas->not_finite_count = not_finite;
    return {fitted, changed};
}

}  // namespace zoe
