#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

namespace zoe {

/// Offsets that one morph target adds, times its weight. Dense; an empty array adds nothing.
struct MorphTarget {
    std::vector<glm::vec3> positions;  ///< [vertex_count] or empty.
    std::vector<glm::vec3> normals;    ///< [vertex_count] or empty.
};

/// Vertices [begin, end).
struct VertexRange {
    uint32_t begin = 0, end = 0;
    friend bool operator==(const VertexRange&, const VertexRange&) = default;
};

/// Which vertices the targets move, as ranges, ascending and apart. Short gaps between them count as moved.
struct MorphReach {
    struct Moved {
        std::vector<VertexRange> by_any;
        std::vector<std::vector<VertexRange>> by_target;  ///< [target_count]
    };
    Moved positions, normals;
};

/// Cost       O(vertices * targets), once.
MorphReach find_reach(std::span<const MorphTarget> targets);

/// out = base + sum of weights[i] * targets[i]. Targets with weight 0 cost nothing.
/// base, out  [vertex_count]; may be empty (no normals).
/// weights    [target_count]; missing ones count as 0.
/// Source     The glTF 2.0 specification, 3.7.2.2, Morph Targets.
void morph_positions(std::span<const glm::vec3> base, std::span<const MorphTarget> targets, std::span<const float> weights,
                     std::span<glm::vec3> out);
/// The same for normals. The result is not normalised.
void morph_normals(std::span<const glm::vec3> base, std::span<const MorphTarget> targets, std::span<const float> weights,
                   std::span<glm::vec3> out);

/// The same where it is known what the targets move: nothing else is looked at.
/// out        [vertex_count] of what no target moves, it already holds the base.
/// Cost       O(vertices that targets of a weight move, and those that any target moves).
void morph_positions(std::span<const glm::vec3> base, std::span<const MorphTarget> targets, const MorphReach& reach,
                     std::span<const float> weights, std::span<glm::vec3> out);
void morph_normals(std::span<const glm::vec3> base, std::span<const MorphTarget> targets, const MorphReach& reach,
                   std::span<const float> weights, std::span<glm::vec3> out);

}  // namespace zoe
