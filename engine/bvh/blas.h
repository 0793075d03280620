#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "engine/bvh/build_binned.h"
#include "engine/bvh/static_bvh.h"
#include "engine/bvh/wide.h"
#include "engine/math/triangle.h"

namespace zoe {

/// Four triangles side by side, tested together. A slot that holds none, or one with a corner that is not finite, has NaN
/// corners and is never hit.
struct alignas(32) TriangleBlock {
    static constexpr uint32_t kSize = 4;

    float corners[9][kSize];    ///< a.x, a.y, a.z, b.x, ... c.z.
    uint32_t primitive[kSize];  ///< kEmptyChild: none.

    Triangle triangle(int slot) const;
};

/// The tree of one mesh.
struct Blas {
    WideBvh tree;
    std::vector<TriangleBlock, HugeAllocator<TriangleBlock>> blocks;
    uint32_t triangle_count = 0;
    uint32_t not_finite_count = 0;  ///< Triangles with a NaN or infinite corner: in the tree, never hit.
    bool has_pieces = false;  ///< Some triangles stand in several leaves, which bound pieces of them: never to be refitted.

    size_t byte_count() const {
        return tree.nodes.capacity() * sizeof(WideNode) + blocks.capacity() * sizeof(TriangleBlock);
    }
};

enum class BlasBuilder : uint8_t {
    kBinned,      ///< Each frame.
    kSweep,       ///< Once, or to be refitted.
    kReinserted,  ///< Sweep, then reinsertion: once, where time is not short.
    kSbvh,        ///< Spatial splits, then reinsertion: once, and never to be refitted.
    kMedian,      ///< What the others are measured against.
};

/// Bytes that differ where `build_blas` may make another tree of the same mesh: which builder, and the settings of all.
std::string settings(BlasBuilder builder);

/// How kBinned builds, for who compares it with other settings.
BinnedConfig blas_binned_config();

/// Memory that one build hands to the next: for meshes that are rebuilt every frame.
struct BlasScratch {
    std::vector<Aabb> boxes;
    BinnedScratch binned;
    Bvh bvh;  ///< What the tree was made of.
    std::vector<uint32_t> slots;
    CollapseScratch collapse;
};

/// Builds a BLAS over an indexed mesh, into storage that it reuses. Without scratch, memory is given back as soon as it has
/// served: at most 2.5 times what the tree takes is in use at once.
/// positions  [vertex_count] local space.
/// corners    [triangle_count] indices into positions; each below vertex_count.
void build_blas(std::span<const glm::vec3> positions, std::span<const glm::uvec3> corners, BlasBuilder builder, Blas* blas,
                BlasScratch* scratch);
void build_blas(std::span<const glm::vec3> positions, std::span<const glm::uvec3> corners, BlasBuilder builder, Blas* blas);

/// Makes a BLAS of a binary tree over the mesh's triangles from any builder.
void make_blas(const Bvh& bvh, std::span<const glm::vec3> positions, std::span<const glm::uvec3> corners, Blas* blas,
               BlasScratch* scratch);
void make_blas(const StaticBvh& bvh, std::span<const glm::vec3> positions, std::span<const glm::uvec3> corners, Blas* blas,
               BlasScratch* scratch);

/// Fills the blocks under a tree, and what the BLAS knows of them.
/// slots      [blocks * TriangleBlock::kSize] what `collapse` gave: each triangle at least once.
/// positions, corners   of the mesh that the slots' primitives are of.
/// Cost       O(blocks), in parallel.
void fill_blocks(std::span<const uint32_t> slots, std::span<const glm::vec3> positions, std::span<const glm::uvec3> corners,
                 Blas* blas);

/// What a refit did, in boxes.
struct RefitCounts {
    uint64_t fitted = 0;   ///< Worked out: those of all leaves, and those around nodes in which a box changed.
    uint64_t changed = 0;  ///< Found to be others than before.
};

/// Moves the triangles to new positions and refits the boxes, bottom up; the topology stays. Boxes that are as before are
/// left alone, and so is all that only they could change.
/// positions, corners   as when built; only the positions' values may differ.
/// Requires   a tree without pieces.
/// Cost       O(triangles), in one pass, in parallel, no allocation.
/// Source     Wald, Boulos, Shirley. Ray Tracing Deformable Scenes Using Dynamic Bounding Volume Hierarchies. TOG 2007.
RefitCounts refit_blas(std::span<const glm::vec3> positions, std::span<const glm::uvec3> corners, Blas* blas);

/// Checks the tree, that every triangle is in it with the right corners, once unless the tree has pieces, and that its
/// leaves contain it: all of it where it stands once, else its corners, its centre and the centres of its edges.
/// Returns    the first broken invariant in words, empty when all hold.
std::string validate(const Blas& blas, std::span<const glm::vec3> positions, std::span<const glm::uvec3> corners);

}  // namespace zoe
