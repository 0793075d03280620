#include "engine/bvh/build_binned.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cstddef>
#include <vector>

#include "engine/bvh/binning.h"
#include "engine/bvh/small_stack.h"
#include "engine/math/parallel.h"

namespace zoe {

namespace {

using binning::BinMap;
using binning::Bins;
using binning::Extents;
using binning::Item;

constexpr uint32_t kSubtreeSize = 4096;  // Subtrees of at most this many primitives are built by one thread each.
constexpr uint32_t kChunkSize = 4096;    // Larger nodes are worked on in chunks of this many, by all threads.

// Subtrees are built some at a time: those of this part of all items, or of so many items, whatever is more.
constexpr size_t kBatches = 8, kSmallestBatch = 65536;

using Range = BinnedScratch::Range;
using Subtree = BinnedScratch::Subtree;
using Chunk = BinnedScratch::Chunk;
using Swap = BinnedScratch::Swap;

class Builder {
public:
    Builder(const BinnedConfig& config, BinnedScratch* scratch, Bvh* bvh)
        : items_(scratch->items),
          config_(config),
          block_shift_(std::countr_zero(static_cast<uint32_t>(config.block_size))),
          scratch_(*scratch),
          bvh_(*bvh) {}

    void build() {
        bvh_.primitives.resize(items_.size());
        grow_top();
        std::vector<Subtree>& subtrees = scratch_.subtrees;
        used_ = static_cast<uint32_t>(scratch_.top.size());
        for (size_t begin = 0, end = 0; begin < subtrees.size(); begin = end) {
            end = make_room(begin);
            parallel_for(begin, end, 1, [&](size_t k, size_t) { grow(&subtrees[k]); });
            close_gaps(std::span(subtrees).subspan(begin, end - begin));
        }
        std::copy(scratch_.top.begin(), scratch_.top.end(), bvh_.nodes.begin());
        bvh_.nodes.resize(used_);
    }

private:
    // The large nodes, one after another, each by all threads.
    void grow_top() {
        scratch_.top.assign(1, BvhNode{});
        scratch_.subtrees.clear();
        SmallStack<Range, 64> open;
        open.push({0, 0, static_cast<uint32_t>(items_.size())});
        while (!open.is_empty()) {
            const Range range = open.pop();
            if (range.count() <= kSubtreeSize) {
                scratch_.subtrees.push_back({range, 0, 0});
                continue;
            }
            Extents extents;
            const uint32_t middle = split_in_parallel(range, &extents);
            const auto children = static_cast<uint32_t>(scratch_.top.size());
            scratch_.top[range.node] = {vec3(extents.lo), children, vec3(extents.hi), 0};
            scratch_.top.resize(children + 2);
            open.push({children + 1, middle, range.end});
            open.push({children, range.begin, middle});
        }
    }

    // Room after the nodes that are there for any trees over the next subtrees, as many as have a share of all items.
    // Returns their end. Most trees need a good deal less, and leave their room to those that follow.
    size_t make_room(size_t begin) {
        const size_t share = std::max<size_t>(items_.size() / kBatches, kSmallestBatch);
        size_t room = used_, count = 0, end = begin;
        for (; end < scratch_.subtrees.size() && count < share; ++end) {
            Subtree& subtree = scratch_.subtrees[end];
            subtree.room = static_cast<uint32_t>(room);
            count += subtree.range.count();
            room += 2 * subtree.range.count() - 2;
        }
        if (room > bvh_.nodes.capacity()) bvh_.nodes.reserve(room + room / 8);
        if (room > bvh_.nodes.size()) bvh_.nodes.resize(room);
        return end;
    }

    void grow(Subtree* subtree) {
        Bins bins;
        std::array<Item, kSubtreeSize> moved;
        uint32_t next = subtree->room;
        SmallStack<Range, 64> open;
        open.push(subtree->range);
        while (!open.is_empty()) {
            const Range range = open.pop();
            Extents extents;
            const std::span<Item> items = of(range);
            for (const Item& item : items) extents.extend(item);
            BvhNode& node = range.node == subtree->range.node ? scratch_.top[range.node] : bvh_.nodes[range.node];
            node = {vec3(extents.lo), range.begin, vec3(extents.hi), range.count()};
            const uint32_t middle = split(range, extents, &bins, moved.data());
            if (middle == range.begin) {
                for (uint32_t k = range.begin; k < range.end; ++k) bvh_.primitives[k] = items_[k].index();
                continue;
            }
            node.first = next;
            node.count = 0;
            open.push({next + 1, middle, range.end});
            open.push({next, range.begin, middle});
            next += 2;
        }
        subtree->used = next - subtree->room;
    }

    static glm::vec3 vec3(binning::Float4 v) { return {v[0], v[1], v[2]}; }
    std::span<Item> of(const Range& range) { return items_.subspan(range.begin, range.count()); }

    // Few primitives need few bins.
    int bin_count(uint32_t count) const {
        return count >= 256 ? config_.bin_count : std::min(config_.bin_count, static_cast<int>(4 + count / 16));
    }

    bool is_better_as_leaf(uint32_t count, float area, float split_cost) const {
        return count <= static_cast<uint32_t>(config_.max_leaf_size) &&
               config_.node_cost * area + split_cost >= area * static_cast<float>(blocks(count));
    }

    uint32_t blocks(uint32_t count) const { return ((count - 1) >> block_shift_) + 1; }

    bool is_one_block(uint32_t count) const {
        return count <= static_cast<uint32_t>(std::min(config_.block_size, config_.max_leaf_size));
    }

    // Reorders the range. Returns the first item of the right side; range.begin for a leaf.
    uint32_t split(const Range& range, const Extents& extents, Bins* bins, Item* moved) {
        if (is_one_block(range.count())) return range.begin;
        const binning::AreaScale scale(extents);
        const BinMap map(extents, bin_count(range.count()));
        binning::Split best;
        if (map.is_usable()) {
            bins->clear(map.bin_count);
            bins->add(of(range), map);
            best = binning::best_split(*bins, map.bin_count, range.count(), block_shift_, scale);
        }
        if (is_better_as_leaf(range.count(), scale.area(extents.lo, extents.hi), best.cost)) return range.begin;
        // All centres in one place: any halves are as good.
        if (best.axis < 0) return range.begin + range.count() / 2;
        return range.begin + binning::partition(of(range), map, best, moved);
    }

    template <typename Body>
    void for_each_chunk(const Range& range, const Body& body) {
        parallel_for(range.begin, range.end, kChunkSize, [&](size_t begin, size_t end) {
            body(scratch_.chunks[(begin - range.begin) / kChunkSize], items_.subspan(begin, end - begin));
        });
    }

    uint32_t split_in_parallel(const Range& range, Extents* extents) {
        const uint32_t chunk_count = (range.count() + kChunkSize - 1) / kChunkSize;
        if (scratch_.chunks.size() < chunk_count) scratch_.chunks.resize(chunk_count);
        for_each_chunk(range, [](Chunk& chunk, std::span<Item> items) {
            chunk.extents = {};
            for (const Item& item : items) chunk.extents.extend(item);
        });
        for (uint32_t k = 0; k < chunk_count; ++k) extents->extend(scratch_.chunks[k].extents);
        const BinMap map(*extents, config_.bin_count);
        if (!map.is_usable()) return range.begin + range.count() / 2;
        for_each_chunk(range, [&](Chunk& chunk, std::span<Item> items) {
            chunk.bins.clear(map.bin_count);
            chunk.bins.add(items, map);
        });
        Bins& bins = scratch_.chunks[0].bins;
        for (uint32_t k = 1; k < chunk_count; ++k) bins.add(scratch_.chunks[k].bins, map.bin_count);
        const binning::Split best =
            binning::best_split(bins, map.bin_count, range.count(), block_shift_, binning::AreaScale(*extents));
        if (best.axis < 0) return range.begin + range.count() / 2;
        for_each_chunk(range, [&](Chunk& chunk, std::span<Item> items) {
            std::array<Item, kChunkSize> moved;
            chunk.left_count = binning::partition(items, map, best, moved.data());
        });
        return swap_sides(range, chunk_count);
    }

    // Chunks are parted: L R L R ... Swaps every right part before the middle with left parts after it.
    uint32_t swap_sides(const Range& range, uint32_t chunk_count) {
        uint32_t middle = range.begin;
        for (uint32_t k = 0; k < chunk_count; ++k) middle += scratch_.chunks[k].left_count;
        struct Run {
            uint32_t begin, end;
        };
        const auto chunk_begin = [&](uint32_t k) { return std::min(range.begin + k * kChunkSize, range.end); };
        const auto right_run = [&](uint32_t k) {
            return Run{chunk_begin(k) + scratch_.chunks[k].left_count, std::min(chunk_begin(k + 1), middle)};
        };
        const auto left_run = [&](uint32_t k) {
            return Run{std::max(chunk_begin(k), middle), chunk_begin(k) + scratch_.chunks[k].left_count};
        };
        scratch_.swaps.clear();
        uint32_t a = 0, b = 0;
        Run right = right_run(a), left = left_run(b);
        while (true) {
            while (right.begin >= right.end && ++a < chunk_count) right = right_run(a);
            while (left.begin >= left.end && ++b < chunk_count) left = left_run(b);
            if (a >= chunk_count || b >= chunk_count) break;
            const uint32_t count = std::min(right.end - right.begin, left.end - left.begin);
            scratch_.swaps.push_back({right.begin, left.begin, count});
            right.begin += count;
            left.begin += count;
        }
        parallel_for(0, scratch_.swaps.size(), 8, [&](size_t begin, size_t end) {
            for (size_t k = begin; k < end; ++k) {
                const Swap& swap = scratch_.swaps[k];
                const auto items = items_.begin();
                std::swap_ranges(items + swap.a, items + swap.a + swap.count, items + swap.b);
            }
        });
        return middle;
    }

    // Subtrees move together; inside of one nothing changes but by how far it moved.
    void close_gaps(std::span<const Subtree> subtrees) {
        for (const Subtree& subtree : subtrees) {
            const uint32_t shift = subtree.room - used_;
            const auto move = [&](BvhNode node) {
                if (!node.is_leaf()) node.first -= shift;
                return node;
            };
            BvhNode& root = scratch_.top[subtree.range.node];
            root = move(root);
            for (uint32_t k = subtree.room; k < subtree.room + subtree.used; ++k) bvh_.nodes[used_++] = move(bvh_.nodes[k]);
        }
    }

    std::span<Item> items_;
    uint32_t used_ = 0;  // Nodes that are there, one after another.
    const BinnedConfig& config_;
    int block_shift_;
    BinnedScratch& scratch_;
    Bvh& bvh_;
};

}  // namespace

Bvh build_binned_items(const BinnedConfig& config, Bvh storage, BinnedScratch* scratch) {
    assert(std::has_single_bit(static_cast<uint32_t>(config.block_size)));
    assert(config.bin_count >= 2 && config.bin_count <= binning::kMaxBins);
    if (scratch->items.empty()) {
        storage.nodes.clear();
        storage.primitives.clear();
        return storage;
    }
    Builder(config, scratch, &storage).build();
    return storage;
}

Bvh build_binned(std::span<const Aabb> boxes, const BinnedConfig& config, Bvh storage) {
    BinnedScratch scratch;
    scratch.items.resize(boxes.size());
    parallel_for(0, boxes.size(), kChunkSize, [&](size_t begin, size_t end) {
        for (size_t k = begin; k < end; ++k) scratch.items[k] = Item(boxes[k], static_cast<uint32_t>(k));
    });
    return build_binned_items(config, std::move(storage), &scratch);
}

}  // namespace zoe
