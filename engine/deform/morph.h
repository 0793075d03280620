#pragma once

#include <span>
#include <vector>

#include <glm/vec3.hpp>

namespace zoe {

/// Offsets that one morph target adds, times its weight. Dense; an empty array adds nothing.
struct MorphTarget {
    std::vector<glm::vec3> positions;  ///< [vertex_count] or empty.
    std::vector<glm::vec3> normals;    ///< [vertex_count] or empty.
};

/// out = base + sum of weights[i] * targets[i]. Targets with weight 0 cost nothing.
/// base, out  [vertex_count]; may be empty (no normals).
/// weights    [target_count]; missing ones count as 0.
/// Source     The glTF 2.0 specification, 3.7.2.2, Morph Targets.
void morph_positions(std::span<const glm::vec3> base, std::span<const MorphTarget> targets, std::span<const float> weights,
                     std::span<glm::vec3> out);
/// The same for normals. The result is not normalised.
void morph_normals(std::span<const glm::vec3> base, std::span<const MorphTarget> targets, std::span<const float> weights,
                   std::span<glm::vec3> out);

}  // namespace zoe
