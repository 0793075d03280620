#include "engine/bvh/blas.h"

#include <atomic>
#include <cassert>
#include <cmath>
#include <utility>

#include "engine/bvh/build_binned.h"
#include "engine/bvh/build_sweep.h"
#include "engine/math/parallel.h"

namespace zoe {

namespace {

constexpr size_t kGrain = 4096, kBlockGrain = 1024, kNodeGrain = 256;

// How `build_blas` builds. Static, so that padding is zero where settings are compared by their bytes.
constexpr SweepConfig kSweepConfig;
constexpr BinnedConfig kBinnedConfig;
constexpr CollapseConfig kCollapseConfig{.block_size = TriangleBlock::kSize};

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

void set_corner(TriangleBlock* block, uint32_t slot, int corner, const glm::vec3& p) {
    for (int axis = 0; axis < 3; ++axis) block->corners[3 * corner + axis][slot] = p[axis];
}

}  // namespace

// Triangles that are not finite go in as NaN.
void place_triangles(std::span<const glm::vec3> positions, std::span<const glm::uvec3> corners, Blas* blas) {
    std::atomic<uint32_t> not_finite_count{0};
    parallel_for(0, blas->blocks.size(), kBlockGrain, [&](size_t begin, size_t end) {
        uint32_t not_finite_here = 0;
        for (size_t k = begin; k < end; ++k) {
            TriangleBlock& block = blas->blocks[k];
            for (uint32_t slot = 0; slot < TriangleBlock::kSize; ++slot) {
                const uint32_t primitive = block.primitive[slot];
                Triangle triangle{glm::vec3(NAN), glm::vec3(NAN), glm::vec3(NAN), primitive};
                if (primitive != kEmptyChild) {
                    const Triangle placed = triangle_at(positions, corners[primitive], primitive);
                    if (is_finite(placed)) {
                        triangle = placed;
                    } else {
                        ++not_finite_here;
                    }
                }
                set_corner(&block, slot, 0, triangle.a);
                set_corner(&block, slot, 1, triangle.b);
                set_corner(&block, slot, 2, triangle.c);
            }
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

}  // namespace

std::string settings(BlasBuilder builder) {
    return bytes_of(builder) + bytes_of(kSweepConfig) + bytes_of(kBinnedConfig) + bytes_of(kCollapseConfig);
}

Triangle TriangleBlock::triangle(int slot) const {
    const auto corner = [&](int k) {
        return glm::vec3(corners[3 * k][slot], corners[3 * k + 1][slot], corners[3 * k + 2][slot]);
    };
    return {corner(0), corner(1), corner(2), primitive[slot]};
}

void make_blas(const Bvh& bvh, std::span<const glm::vec3> positions, std::span<const glm::uvec3> corners, Blas* blas,
               BlasScratch* scratch) {
    collapse(bvh, kCollapseConfig, &blas->tree, &scratch->slots, &scratch->collapse);
    blas->blocks.resize(scratch->slots.size() / TriangleBlock::kSize);
    for (size_t k = 0; k < scratch->slots.size(); ++k) {
        blas->blocks[k / TriangleBlock::kSize].primitive[k % TriangleBlock::kSize] = scratch->slots[k];
    }
    blas->triangle_count = static_cast<uint32_t>(corners.size());
    place_triangles(positions, corners, blas);
}

void build_blas(std::span<const glm::vec3> positions, std::span<const glm::uvec3> corners, BlasBuilder builder, Blas* blas,
                BlasScratch* scratch) {
    fit_boxes(positions, corners, &scratch->boxes);
    scratch->bvh = builder == BlasBuilder::kSweep ? build_sweep(scratch->boxes, kSweepConfig, std::move(scratch->bvh))
                                                  : build_binned(scratch->boxes, kBinnedConfig, std::move(scratch->bvh));
    make_blas(scratch->bvh, positions, corners, blas, scratch);
}

void build_blas(std::span<const glm::vec3> positions, std::span<const glm::uvec3> corners, BlasBuilder builder, Blas* blas) {
    BlasScratch scratch;
    build_blas(positions, corners, builder, blas, &scratch);
}

void refit_blas(std::span<const glm::vec3> positions, std::span<const glm::uvec3> corners, Blas* blas) {
    assert(corners.size() == blas->triangle_count);
    place_triangles(positions, corners, blas);
    fit_leaves(blas);
    refit_inner(&blas->tree);
}

std::string validate(const Blas& blas, std::span<const glm::vec3> positions, std::span<const glm::uvec3> corners) {
    if (const std::string problem = validate(blas.tree, blas.blocks.size()); !problem.empty()) return problem;
    if (blas.triangle_count != corners.size()) return "another number of triangles";
    std::vector<uint8_t> is_seen(corners.size(), 0);
    for (const WideNode& node : blas.tree.nodes) {
        for (int slot = 0; slot < kWidth; ++slot) {
            const uint32_t child = node.child[slot];
            if (child == kEmptyChild || !is_leaf(child)) continue;
            for (uint32_t k = 0; k < block_count(child) * TriangleBlock::kSize; ++k) {
                const Triangle held =
                    blas.blocks[first_block(child) + k / TriangleBlock::kSize].triangle(int(k % TriangleBlock::kSize));
                if (held.primitive == kEmptyChild) continue;
                const std::string at = "triangle " + std::to_string(held.primitive) + ": ";
                if (held.primitive >= corners.size()) return at + "out of range";
                is_seen[held.primitive] = 1;
                const Triangle triangle = triangle_at(positions, corners[held.primitive], held.primitive);
                if (!is_finite(triangle)) {
                    if (is_finite(held)) return at + "not finite, but held as if it were";
                    continue;
                }
                if (held.a != triangle.a || held.b != triangle.b || held.c != triangle.c) return at + "other corners";
                if (!node.box(slot).contains(bounds(triangle))) return at + "its leaf does not contain it";
            }
        }
    }
    for (size_t k = 0; k < is_seen.size(); ++k) {
        if (!is_seen[k]) return "triangle " + std::to_string(k) + " is in no leaf";
    }
    return "";
}

}  // namespace zoe
