#pragma once

#include <array>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "engine/deform/cage.h"
#include "engine/math/affine.h"

namespace zoe {

/// How far a cage is from flat at one of its places: the length of (a - v) + share * ((b - v) + (c - v)).
///
///      a --- v --- b = c     share 1/2: how much the edges through a vertex turn     a --- b
///                            share -1: how much a face is twisted                    |     |
///                                                                                    c --- v
struct Bend {
    uint32_t v, a, b, c;
    float share;
    float weight;     ///< How far triangles as large as the cage's faces may be off because of it, as a share of it.
    float decay;      ///< What is left of it after a round of refinement, as a share.
    float sharpness;  ///< Rounds for which it stays sharp, so that it halves in each; then it decays.
    bool is_twist;
};

/// Finds the bends of a cage that its limit surface rounds off. Bends that stay sharp are none.
/// Requires   that the cage passes `check`.
/// Cost       O(corners), for loading.
std::vector<Bend> find_bends(const Cage& cage, size_t vertex_count);

/// From where a cage is seen.
struct Seen {
    Affine world_from_local;
    glm::vec3 eye_world{0.0f};
    float pixels_at_1m = 0.0f;  ///< Pixels that a metre covers at a distance of a metre, in the middle of the picture.
    friend bool operator==(const Seen&, const Seen&) = default;
};

/// Estimates, by level, how many pixels the triangles of a level are away from the limit surface at most, where their
/// vertices lie on it. Meant to be too large rather than too small: a test compares it with much finer levels.
/// positions  [vertex_count] of the cage, local space.
/// errors     [level] pixels; [0] is not used.
/// Cost       O(bends * levels), no allocation.
/// Source     Second differences of control points bound a patch's second derivatives, and those what triangles are away
/// from
///            it: Cheng, Yong. Subdivision Depth Computation for Catmull-Clark Subdivision Surfaces. CAD&A 2006. Eigenvalues
///            at other valences: Ball, Storry. Conditions for Tangent Plane Continuity over Recursively Generated B-spline
///            Surfaces. TOG 1988; Loop 1987. Deviation: one decay stands for all that a round does around such a vertex.
void estimate_errors(std::span<const Bend> bends, std::span<const glm::vec3> positions, const Seen& seen,
                     std::span<float, kMaxSubdivisionLevel + 1> errors);

}  // namespace zoe
