#include "engine/bvh/blas.h"

#include <algorithm>
#include <atomic>
#include <cassert>
#include <cmath>
#include <utility>

#include "engine/bvh/build_binned.h"
#include "engine/bvh/build_sbvh.h"
#include "engine/bvh/build_sweep.h"
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

constexpr size_t kGrain = 4096, kBlockGrain = 1024, kNodeGrain = 256, kPrefetchAhead = 4;

template <typename Value>
std::string bytes_of(const Value& value) {
    return {reinterpret_cast<const char*>(&value), sizeof value};
}

bool is_finite(const Triangle& t) {
    return zoe::is_finite(t.a) && zoe::is_finite(t.b) && zoe::is_finite(t.c);
}

Triangle triangle_at(std::span<const glm::vec3> positions, const glm::uvec3& corners, uint32_t primitive) {
    return {positions[corners.x], positions[corners.y], positions[corners.z], primitive};
}

// An empty box for a triangle that is not finite: it bounds nothing and is never hit.
Aabb box_of(const Triangle& triangle) {
    return is_finite(triangle) ? bounds(triangle) : Aabb{};
}

void fit_boxes(std::span<const glm::vec3> positions, std::span<const glm::uvec3> corners, std::vector<Aabb>* boxes) {
    boxes->resize(corners.size());
    parallel_for(0, corners.size(), kGrain, [&](size_t begin, size_t end) {
        for (size_t k = begin; k < end; ++k) (*boxes)[k] = box_of(triangle_at(positions, corners[k], 0));
    });
}

// Four triangles side by side, row by row. Returns how many of them are not finite: they go in as NaN.
uint32_t place_block(std::span<const glm::vec3> positions, std::span<const glm::uvec3> corners, TriangleBlock* block) {
    static const glm::vec3 nowhere(NAN);
    constexpr uint32_t kSize = TriangleBlock::kSize;
    float probes[kSize] = {};  // 0, or NaN where any coordinate is not finite.
    for (uint32_t slot = 0; slot < kSize; ++slot) {
        const uint32_t primitive = block->primitive[slot];
        const bool is_empty = primitive == kEmptyChild;
        const glm::uvec3 corner = is_empty ? glm::uvec3(0) : corners[primitive];
        const auto put = [&](int row, const glm::vec3& p) {
            block->corners[row][slot] = p.x;
            block->corners[row + 1][slot] = p.y;
            block->corners[row + 2][slot] = p.z;
            probes[slot] += 0.0f * p.x + 0.0f * p.y + 0.0f * p.z;
        };
        put(0, is_empty ? nowhere : positions[corner.x]);
        put(3, is_empty ? nowhere : positions[corner.y]);
        put(6, is_empty ? nowhere : positions[corner.z]);
    }
    uint32_t not_finite_count = 0;
    for (uint32_t slot = 0; slot < kSize; ++slot) {
        if (probes[slot] == 0.0f || block->primitive[slot] == kEmptyChild) continue;
        for (auto& row : block->corners) row[slot] = NAN;
        ++not_finite_count;
    }
    return not_finite_count;
}

}  // namespace

// Puts this frame's triangles into the blocks.
void place_triangles(std::span<const glm::vec3> positions, std::span<const glm::uvec3> corners, Blas* blas) {
    std::atomic<uint32_t> not_finite_count{0};
    parallel_for(0, blas->blocks.size(), kBlockGrain, [&](size_t begin, size_t end) {
        uint32_t not_finite_here = 0;
        for (size_t k = begin; k < end; ++k) {
            // Vertices lie anywhere in memory; asked for ahead, they are there in time.
            const TriangleBlock& ahead = blas->blocks[std::min(k + kPrefetchAhead, end - 1)];
            for (const uint32_t primitive : ahead.primitive) {
                if (primitive == kEmptyChild) continue;
                const glm::uvec3& corner = corners[primitive];
                __builtin_prefetch(&positions[corner.x]);
                __builtin_prefetch(&positions[corner.z]);
            }
            not_finite_here += place_block(positions, corners, &blas->blocks[k]);
        }
        not_finite_count += not_finite_here;
    });
    blas->not_finite_count = not_finite_count;
}

namespace {

// Comparisons with NaN are false: slots without a finite triangle add nothing.
Aabb bounds(const TriangleBlock* blocks, uint32_t count) {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    Aabb box;
    for (int axis = 0; axis < 3; ++axis) {
        float lo[TriangleBlock::kSize], hi[TriangleBlock::kSize];
        for (uint32_t slot = 0; slot < TriangleBlock::kSize; ++slot) {
            lo[slot] = kInfinity;
            hi[slot] = -kInfinity;
        }
        for (uint32_t k = 0; k < count; ++k) {
            for (int corner = 0; corner < 3; ++corner) {
                const float* row = blocks[k].corners[3 * corner + axis];
                for (uint32_t slot = 0; slot < TriangleBlock::kSize; ++slot) {
                    lo[slot] = row[slot] < lo[slot] ? row[slot] : lo[slot];
                    hi[slot] = row[slot] > hi[slot] ? row[slot] : hi[slot];
                }
            }
        }
        for (uint32_t slot = 0; slot < TriangleBlock::kSize; ++slot) {
            box.lo[axis] = glm::min(box.lo[axis], lo[slot]);
            box.hi[axis] = glm::max(box.hi[axis], hi[slot]);
        }
    }
    return box;
}

void fit_leaves(Blas* blas) {
    parallel_for(0, blas->tree.nodes.size(), kNodeGrain, [&](size_t begin, size_t end) {
        for (size_t k = begin; k < end; ++k) {
            WideNode& node = blas->tree.nodes[k];
            for (int slot = 0; slot < kWidth; ++slot) {
                const uint32_t child = node.child[slot];
                if (child == kEmptyChild || !is_leaf(child)) continue;
                node.set_box(slot, bounds(&blas->blocks[first_block(child)], block_count(child)));
            }
        }
    });
}

// blas->has_pieces says whether the tree holds triangles more than once.
void fill_blas(const Bvh& bvh, std::span<const glm::vec3> positions, std::span<const glm::uvec3> corners, Blas* blas,
               BlasScratch* scratch) {
    CollapseConfig config = kCollapse;
    config.has_duplicates = blas->has_pieces;
    collapse(bvh, config, &blas->tree, &scratch->slots, &scratch->collapse);
    blas->blocks.resize(scratch->slots.size() / TriangleBlock::kSize);
    parallel_for(0, blas->blocks.size(), kBlockGrain, [&](size_t begin, size_t end) {
        for (size_t k = begin; k < end; ++k) {
            std::copy_n(&scratch->slots[k * TriangleBlock::kSize], TriangleBlock::kSize, blas->blocks[k].primitive);
        }
    });
    blas->triangle_count = static_cast<uint32_t>(corners.size());
    place_triangles(positions, corners, blas);
}

// A triangle in a leaf.
struct Held {
    Triangle triangle;
    Aabb leaf;
};

// All in leaves, those of a triangle one after another.
std::vector<Held> all_held(const Blas& blas) {
    std::vector<Held> all;
    for (const WideNode& node : blas.tree.nodes) {
        for (int slot = 0; slot < kWidth; ++slot) {
            const uint32_t child = node.child[slot];
            if (child == kEmptyChild || !is_leaf(child)) continue;
            for (uint32_t k = 0; k < block_count(child) * TriangleBlock::kSize; ++k) {
                const TriangleBlock& block = blas.blocks[first_block(child) + k / TriangleBlock::kSize];
                const Triangle triangle = block.triangle(static_cast<int>(k % TriangleBlock::kSize));
                if (triangle.primitive != kEmptyChild) all.push_back({triangle, node.box(slot)});
            }
        }
    }
    std::stable_sort(all.begin(), all.end(),
                     [](const Held& a, const Held& b) { return a.triangle.primitive < b.triangle.primitive; });
    return all;
}

// What is wrong with the places of one triangle; empty where nothing is.
std::string check_places(std::span<const Held> places, const Triangle& triangle, bool may_have_pieces) {
    if (places.empty()) return "in no leaf";
    if (places.size() > 1 && !may_have_pieces) return "in two leaves";
    for (const Held& place : places) {
        const Triangle& held = place.triangle;
        if (is_finite(held) != is_finite(triangle)) return "not finite, or held as if it were not";
        if (is_finite(triangle) && (held.a != triangle.a || held.b != triangle.b || held.c != triangle.c)) {
            return "other corners";
        }
    }
    if (!is_finite(triangle)) return "";
    if (places.size() == 1) return places[0].leaf.contains(bounds(triangle)) ? "" : "its leaf does not contain it";
    std::vector<Aabb> leaves;
    for (const Held& place : places) leaves.push_back(place.leaf);
    if (!is_held(triangle, leaves)) return "its leaves do not contain it";
    return "";
}

}  // namespace

std::string settings(BlasBuilder builder) {
    return bytes_of(builder) + bytes_of(kSweep) + bytes_of(kReinsert) + bytes_of(kBinned) + bytes_of(kSbvh) +
           bytes_of(kCollapse);
}

Triangle TriangleBlock::triangle(int slot) const {
    const auto corner = [&](int k) {
        return glm::vec3(corners[3 * k][slot], corners[3 * k + 1][slot], corners[3 * k + 2][slot]);
    };
    return {corner(0), corner(1), corner(2), primitive[slot]};
}

void make_blas(const Bvh& bvh, std::span<const glm::vec3> positions, std::span<const glm::uvec3> corners, Blas* blas,
               BlasScratch* scratch) {
    blas->has_pieces = false;
    fill_blas(bvh, positions, corners, blas, scratch);
}

void make_blas(const StaticBvh& bvh, std::span<const glm::vec3> positions, std::span<const glm::uvec3> corners, Blas* blas,
               BlasScratch* scratch) {
    blas->has_pieces = bvh.tree.primitives.size() > bvh.primitive_count;
    fill_blas(bvh.tree, positions, corners, blas, scratch);
}

void build_blas(std::span<const glm::vec3> positions, std::span<const glm::uvec3> corners, BlasBuilder builder, Blas* blas,
                BlasScratch* scratch) {
    if (builder == BlasBuilder::kSbvh) {
        StaticBvh bvh = build_sbvh(positions, corners, kSbvh);
        reinsert(&bvh.tree, kReinsert);
        return make_blas(bvh, positions, corners, blas, scratch);
    }
    fit_boxes(positions, corners, &scratch->boxes);
    scratch->bvh = builder == BlasBuilder::kBinned ? build_binned(scratch->boxes, kBinned, std::move(scratch->bvh))
                                                   : build_sweep(scratch->boxes, kSweep, std::move(scratch->bvh));
    if (builder == BlasBuilder::kReinserted) reinsert(&scratch->bvh, kReinsert);
    make_blas(scratch->bvh, positions, corners, blas, scratch);
}

void build_blas(std::span<const glm::vec3> positions, std::span<const glm::uvec3> corners, BlasBuilder builder, Blas* blas) {
    BlasScratch scratch;
    build_blas(positions, corners, builder, blas, &scratch);
}

void refit_blas(std::span<const glm::vec3> positions, std::span<const glm::uvec3> corners, Blas* blas) {
    assert(corners.size() == blas->triangle_count && !blas->has_pieces);
    place_triangles(positions, corners, blas);
    fit_leaves(blas);
    refit_inner(&blas->tree);
}

std::string validate(const Blas& blas, std::span<const glm::vec3> positions, std::span<const glm::uvec3> corners) {
    if (const std::string problem = validate(blas.tree, blas.blocks.size()); !problem.empty()) return problem;
    if (blas.triangle_count != corners.size()) return "another number of triangles";
    const std::vector<Held> all = all_held(blas);
    size_t end = 0;
    for (uint32_t primitive = 0; primitive < corners.size(); ++primitive) {
        const size_t begin = end;
        while (end < all.size() && all[end].triangle.primitive == primitive) ++end;
        const std::string problem = check_places(std::span(all).subspan(begin, end - begin),
                                                 triangle_at(positions, corners[primitive], primitive), blas.has_pieces);
        if (!problem.empty()) return "triangle " + std::to_string(primitive) + ": " + problem;
    }
    if (end < all.size()) return "triangle " + std::to_string(all[end].triangle.primitive) + ": out of range";
    return "";
}

}  // namespace zoe
