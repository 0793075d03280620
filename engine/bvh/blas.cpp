#include "engine/bvh/blas.h"

#include <algorithm>
#include <atomic>
#include <cassert>
#include <cmath>
#include <utility>

#include "engine/bvh/build_median.h"
#include "engine/bvh/build_sbvh.h"
#include "engine/bvh/build_sweep.h"
#include "engine/bvh/place_block.h"
#include "engine/bvh/reinsert.h"
#include "engine/math/parallel.h"

namespace zoe {

namespace {

// How `build_blas` builds. Static, so that padding is zero where settings are compared by their bytes.
constexpr SweepConfig kSweep;
constexpr ReinsertConfig kReinsert;
constexpr CollapseConfig kCollapse{.block_size = TriangleBlock::kSize};

// Rebuilt often: half the nodes of a tree that counts triangles one by one, a tenth less memory, and within 2 % of its
// wide tree's SAH. A binary node is about half of a block's work once eight of them are joined.
constexpr BinnedConfig kBinned{.block_size = TriangleBlock::kSize, .node_cost = 0.5f};

// Blocks are counted for memory's sake, too: pieces take room.
constexpr SbvhConfig kSbvh{.max_reference_growth = 1.5f, .block_size = TriangleBlock::kSize, .node_cost = 0.5f};

constexpr size_t kGrain = 4096, kBlockGrain = 1024, kPrefetchAhead = 4;

template <typename Value>
std::string bytes_of(const Value& value) {
    return {reinterpret_cast<const char*>(&value), sizeof value};
}

// An empty box for a triangle that is not finite: it bounds nothing and is never hit.
Aabb box_of(std::span<const glm::vec3> positions, const glm::uvec3& corners) {
    const glm::vec3 &a = positions[corners.x], &b = positions[corners.y], &c = positions[corners.z];
    return is_finite(a) && is_finite(b) && is_finite(c) ? bounds(Triangle{a, b, c, 0}) : Aabb{};
}

std::vector<Aabb> boxes_of(std::span<const glm::vec3> positions, std::span<const glm::uvec3> corners,
                           std::vector<Aabb> boxes) {
    boxes.resize(corners.size());
    parallel_for(0, corners.size(), kGrain, [&](size_t begin, size_t end) {
        for (size_t k = begin; k < end; ++k) boxes[k] = box_of(positions, corners[k]);
    });
    return boxes;
}

void fit_items(std::span<const glm::vec3> positions, std::span<const glm::uvec3> corners,
               std::vector<binning::Item>* items) {
    items->resize(corners.size());
    parallel_for(0, corners.size(), kGrain, [&](size_t begin, size_t end) {
        for (size_t k = begin; k < end; ++k) {
            (*items)[k] = binning::Item(box_of(positions, corners[k]), static_cast<uint32_t>(k));
        }
    });
}

// Puts this frame's triangles into the blocks.
void place_triangles(std::span<const glm::vec3> positions, std::span<const glm::uvec3> corners, Blas* blas) {
    std::atomic<uint32_t> not_finite_count{0};
    parallel_for(0, blas->blocks.size(), kBlockGrain, [&](size_t begin, size_t end) {
        place_detail::Int4 not_finite_here{};
        for (size_t k = begin; k < end; ++k) {
            place_detail::prefetch(positions, corners, blas->blocks[std::min(k + kPrefetchAhead, end - 1)]);
            place_detail::SlotBounds ignored = place_detail::SlotBounds::none();
            not_finite_here += place_detail::place_block(positions, corners, &blas->blocks[k], &ignored);
        }
        not_finite_count += static_cast<uint32_t>(place_detail::count(not_finite_here));
    });
    blas->not_finite_count = not_finite_count;
}

void fill_tree(const Bvh& bvh, size_t triangle_count, Blas* blas, BlasScratch* scratch) {
    CollapseConfig config = kCollapse;
    config.has_duplicates = bvh.primitives.size() > triangle_count;
    collapse(bvh, config, &blas->tree, &scratch->slots, &scratch->collapse);
}

// Whether memory is kept for the next build, or given back as soon as it has served.
enum class Memory { kKept, kReleased };

template <typename T>
void release(Memory memory, T* scratch) {
    if (memory == Memory::kReleased) *scratch = T();
}

// The binary tree: into scratch->bvh.
void build_binary(std::span<const glm::vec3> positions, std::span<const glm::uvec3> corners, BlasBuilder builder,
                  Memory memory, BlasScratch* scratch) {
    Bvh& bvh = scratch->bvh;
    if (builder == BlasBuilder::kSbvh) {
        release(Memory::kReleased, &bvh);
        bvh = build_sbvh(positions, corners, kSbvh).tree;
    } else if (builder == BlasBuilder::kBinned) {
        fit_items(positions, corners, &scratch->binned.items);
        bvh = build_binned_items(kBinned, std::move(bvh), &scratch->binned);
        release(memory, &scratch->binned);
    } else {
        scratch->boxes = boxes_of(positions, corners, std::move(scratch->boxes));
        bvh = builder == BlasBuilder::kMedian ? build_median(scratch->boxes, TriangleBlock::kSize, std::move(bvh))
                                              : build_sweep(scratch->boxes, kSweep, std::move(bvh));
        release(memory, &scratch->boxes);
    }
    if (builder == BlasBuilder::kReinserted || builder == BlasBuilder::kSbvh) reinsert(&bvh, kReinsert);
}

void build(std::span<const glm::vec3> positions, std::span<const glm::uvec3> corners, BlasBuilder builder, Memory memory,
           Blas* blas, BlasScratch* scratch) {
    build_binary(positions, corners, builder, memory, scratch);
    fill_tree(scratch->bvh, corners.size(), blas, scratch);
    release(memory, &scratch->bvh);
    release(memory, &scratch->collapse);
    fill_blocks(scratch->slots, positions, corners, blas);
}

}  // namespace

std::string settings(BlasBuilder builder) {
    return bytes_of(builder) + bytes_of(kSweep) + bytes_of(kReinsert) + bytes_of(kBinned) + bytes_of(kSbvh) +
           bytes_of(kCollapse);
}

BinnedConfig blas_binned_config() {
    return kBinned;
}

Triangle TriangleBlock::triangle(int slot) const {
    const auto corner = [&](int k) {
        return glm::vec3(corners[3 * k][slot], corners[3 * k + 1][slot], corners[3 * k + 2][slot]);
    };
    return {corner(0), corner(1), corner(2), primitive[slot]};
}

void make_blas(const Bvh& bvh, std::span<const glm::vec3> positions, std::span<const glm::uvec3> corners, Blas* blas,
               BlasScratch* scratch) {
    fill_tree(bvh, corners.size(), blas, scratch);
    fill_blocks(scratch->slots, positions, corners, blas);
}

void make_blas(const StaticBvh& bvh, std::span<const glm::vec3> positions, std::span<const glm::uvec3> corners, Blas* blas,
               BlasScratch* scratch) {
    make_blas(bvh.tree, positions, corners, blas, scratch);
}

void fill_blocks(std::span<const uint32_t> slots, std::span<const glm::vec3> positions, std::span<const glm::uvec3> corners,
                 Blas* blas) {
    const size_t count = slots.size() / TriangleBlock::kSize;
    resize_anew(&blas->blocks, count);
    std::atomic<size_t> held_count{0};
    parallel_for(0, count, kBlockGrain, [&](size_t begin, size_t end) {
        size_t held_here = 0;
        for (size_t k = begin; k < end; ++k) {
            for (uint32_t slot = 0; slot < TriangleBlock::kSize; ++slot) {
                const uint32_t primitive = slots[k * TriangleBlock::kSize + slot];
                blas->blocks[k].primitive[slot] = primitive;
                held_here += primitive != kEmptyChild;
            }
        }
        held_count += held_here;
    });
    blas->triangle_count = static_cast<uint32_t>(corners.size());
    blas->has_pieces = held_count > corners.size();
    place_triangles(positions, corners, blas);
}

void build_blas(std::span<const glm::vec3> positions, std::span<const glm::uvec3> corners, BlasBuilder builder, Blas* blas,
                BlasScratch* scratch) {
    build(positions, corners, builder, Memory::kKept, blas, scratch);
}

void build_blas(std::span<const glm::vec3> positions, std::span<const glm::uvec3> corners, BlasBuilder builder, Blas* blas) {
    BlasScratch scratch;
    build(positions, corners, builder, Memory::kReleased, blas, &scratch);
}

}  // namespace zoe
