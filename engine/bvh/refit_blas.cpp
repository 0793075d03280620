#include <algorithm>
#include <atomic>
#include <cassert>
#include <cstring>

#include "engine/bvh/blas.h"
#include "engine/bvh/place_block.h"
#include "engine/math/parallel.h"

namespace zoe {

namespace {

constexpr size_t kGrain = 128;

// What is asked for before its turn, in blocks (each step reads what the one before has asked for) and nodes.
constexpr size_t kBlocksAhead = 20, kCornersAhead = 12, kVerticesAhead = 6, kNodesAhead = 3;
constexpr size_t kNearBytes = size_t{1} << 18;  // Corners that stay in a core's caches, where many nodes show their mesh.

using place_detail::Float4, place_detail::Int4, place_detail::SlotBounds;

constexpr int kSide = TriangleBlock::kSize;  // Slots of a node that are worked out side by side.
static_assert(kWidth % kSide == 0);

// What a range of nodes adds to the tree's counts.
struct Counts {
    Int4 fitted{}, changed{}, not_finite{};  // Sums of masks.
};

// Refits nodes whose children have been.
class Refit {
public:
    Refit(std::span<const glm::vec3> positions, std::span<const glm::uvec3> corners, Blas* blas)
        : positions_(positions), corners_(corners), are_corners_far_(corners.size_bytes() > kNearBytes), blas_(*blas) {}

    void fit(size_t index, Counts* counts) const {
        WideNode* node = &blas_.tree.nodes[index];
        prefetch_all(blas_.tree.nodes[std::min(index + kNodesAhead, blas_.tree.nodes.size() - 1)]);
        node->is_box_changed = node->is_sum_changed = 0;
        for (int first = 0; first < kWidth; first += kSide) fit_side(first, node, counts);
        if (node->is_sum_changed) sum_costs(blas_.tree, CollapseConfig{}.block_cost, node);
    }

private:
    // Asks for what is read and written one after another: processors don't do so by themselves as far as it pays.
    template <typename Value>
    static void prefetch_all(const Value& value) {
        constexpr size_t kLine = 64;
        for (size_t at = 0; at < sizeof value; at += kLine)
            __builtin_prefetch(reinterpret_cast<const char*>(&value) + at, 1);
    }

    void fit_side(int first, WideNode* node, Counts* counts) const {
        SlotBounds bounds[kSide];
        Int4 is_fitted{};
        for (int k = 0; k < kSide; ++k) {
            const uint32_t child = node->child[first + k];
            if (child != kEmptyChild && is_leaf(child)) {
                bounds[k] = fit_leaf(child, counts);
                is_fitted[k] = -1;
                continue;
            }
            bounds[k] = SlotBounds::none();
            if (child == kEmptyChild) continue;
            const WideNode& below = blas_.tree.nodes[child];
            node->is_sum_changed |= below.is_sum_changed;
            if (!below.is_box_changed) continue;
            bounds[k] = bounds_of(below);
            is_fitted[k] = -1;
        }
        Float4 fitted[6], before[6];
        Int4 is_changed{};
        for (int axis = 0; axis < 3; ++axis) {
            const auto lo = [&](int k) { return bounds[k].lo[axis]; };
            const auto hi = [&](int k) { return bounds[k].hi[axis]; };
            fitted[2 * axis] = place_detail::across(lo(0), lo(1), lo(2), lo(3), place_detail::smaller);
            fitted[2 * axis + 1] = place_detail::across(hi(0), hi(1), hi(2), hi(3), place_detail::larger);
        }
        for (int plane = 0; plane < 6; ++plane) {
            std::memcpy(&before[plane], &node->planes[plane][first], sizeof before[plane]);
            is_changed |= fitted[plane] != before[plane];
        }
        is_changed &= is_fitted;
        counts->fitted += is_fitted;
        if (!place_detail::any(is_changed)) return;
        counts->changed += is_changed;
        node->is_box_changed = node->is_sum_changed = 1;
        for (int plane = 0; plane < 6; ++plane) {
            const Float4 now = is_changed ? fitted[plane] : before[plane];
            std::memcpy(&node->planes[plane][first], &now, sizeof now);
        }
    }

    SlotBounds fit_leaf(uint32_t leaf, Counts* counts) const {
        SlotBounds bounds = SlotBounds::none();
        const size_t begin = first_block(leaf), last = blas_.blocks.size() - 1;
        const auto ahead = [&](size_t k) -> const TriangleBlock& { return blas_.blocks[std::min(k, last)]; };
        for (size_t k = begin; k < begin + block_count(leaf); ++k) {
            // The next leaves' blocks follow.
            prefetch_all(ahead(k + kBlocksAhead));
            if (are_corners_far_) place_detail::prefetch_corners(corners_, ahead(k + kCornersAhead));
            place_detail::prefetch(positions_, corners_, ahead(k + kVerticesAhead));
            counts->not_finite += place_detail::place_block(positions_, corners_, &blas_.blocks[k], &bounds);
        }
        return bounds;
    }

    // Of all boxes of a node. Of zeros of either sign the first slot's is left, as by WideNode::bounds.
    static SlotBounds bounds_of(const WideNode& node) {
        SlotBounds bounds;
        for (int axis = 0; axis < 3; ++axis) {
            bounds.lo[axis] = pairs_of(node.planes[2 * axis], place_detail::smaller);
            bounds.hi[axis] = pairs_of(node.planes[2 * axis + 1], place_detail::larger);
        }
        return bounds;
    }
    template <typename Better>
    static Float4 pairs_of(const float (&plane)[kWidth], Better better) {
        Float4 low, high;
        std::memcpy(&low, plane, sizeof low);
        std::memcpy(&high, plane + kSide, sizeof high);
        const Float4 even = __builtin_shufflevector(low, high, 6, 2, 4, 0),
                     odd = __builtin_shufflevector(low, high, 7, 3, 5, 1);
        return better(odd, even);
    }

    std::span<const glm::vec3> positions_;
    std::span<const glm::uvec3> corners_;
    bool are_corners_far_;
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
            for (size_t k = begin; k < end; ++k) refit.fit(k, &counts);
            fitted += place_detail::count(counts.fitted);
            changed += place_detail::count(counts.changed);
            not_finite += place_detail::count(counts.not_finite);
        });
    }
    blas->not_finite_count = not_finite;
    return {fitted, changed};
}

}  // namespace zoe
