#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

namespace zoe {

/// Weighted sums of cage vertices, one a vertex of the refined mesh: entries [offsets[v], offsets[v + 1]), a multiple of
/// four, filled up with weights of 0.
struct StencilTable {
    std::vector<uint32_t> offsets;  ///< [vertex_count + 1]
    std::vector<uint32_t> indices;  ///< [entry_count] cage vertices, ascending within a stencil until they are sorted.
    std::vector<float> weights;     ///< [entry_count] of the position; they sum to 1.
    std::vector<float> u_weights;   ///< [entry_count] of a tangent of the limit surface, or empty; they sum to 0.
    std::vector<float> v_weights;   ///< [entry_count] of another, counter-clockwise of the first, or empty.

    size_t vertex_count() const { return offsets.empty() ? 0 : offsets.size() - 1; }
};

/// Puts each stencil's entries in order of their cage vertices' ranks, and so the order of its sums. Where two cages meet
/// and ranks follow from positions, vertices that both refine from the same ones come out the same to the last bit.
/// rank       [cage vertices]
/// Cost       O(entries log entries of a stencil); for loading, not for frames.
void sort_entries(StencilTable* stencils, std::span<const uint32_t> rank);

/// The refined vertices of a pose of the cage. Each is summed by one thread in the order of its stencil.
/// cage_positions   finite, as many as the stencils were made for.
/// positions        [vertex_count] out.
/// normals          [vertex_count] out, of length 1, or zero where the surface has none; or empty: not wanted.
/// Requires   tangents in the stencils where normals are wanted.
/// Cost       O(entries), one pass; no allocation once this thread has evaluated a cage as large. The same bits with every
///            instruction set and on any number of threads.
/// Source     Halstead, Kass, DeRose. Efficient, Fair Interpolation Using Catmull-Clark Surfaces. SIGGRAPH 1993.
void evaluate(const StencilTable& stencils, std::span<const glm::vec3> cage_positions, std::span<glm::vec3> positions,
              std::span<glm::vec3> normals);

}  // namespace zoe
