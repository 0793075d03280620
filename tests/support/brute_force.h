#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include <glm/vec3.hpp>

#include "tests/support/world_triangle.h"

namespace zoe::test {

/// A ray whose numbers are floats, kept in double. `t` counts in lengths of the direction.
struct OracleRay {
    glm::dvec3 origin{0.0}, direction{0.0, 0.0, -1.0};
    double t_min = 0.0, t_max = std::numeric_limits<double>::infinity();
};

struct OracleHit {
    double t = std::numeric_limits<double>::infinity();
    size_t triangle = 0;  ///< Position in `BruteForce::triangles`.
};

/// A triangle that the ray hits, or passes so close by that rounding to float may make it a hit.
///
///      looking along the ray, which is the dot:   |<-- edge_distance
///               /\                                |
///              /  \      is_sure: farther inside than any rounding of the corners moves an edge
///             / .  \     else: a hit or a miss, both are right
///            /______\                                                                              .
struct Candidate {
    size_t triangle = 0;
    bool is_sure = false;
    double t_lo = 0.0, t_hi = 0.0;  ///< Where rounding may put the hit.
    double edge_distance = 0.0;     ///< From the ray to the nearest edge, across the ray; negative outside.
    double cosine = 0.0;            ///< Between ray and normal: near 0 the ray grazes.
    double tolerance = 0.0;         ///< How far rounding may move a corner, in world units.
    double shift = 0.0;             ///< How far it may move the point of the triangle that is hit, across the ray.
};

/// Closest hits by trying every triangle, both sides, in extended precision; and what rounding to float may make of them.
///
/// The tolerance: a program that computes in float places a corner, seen from the ray, within
///     kRounding * (magnitude + |origin|)
/// of where it belongs. `magnitude` sums up every offset on the way from the root to the corner: no rounded number on that
/// way (products of matrices, blends, the ray's own transform) is larger. kRounding is 8 roundings of 2^-24, all in the
/// same direction; real models need up to about 3 (`Agreement::worst_t` tells).
class BruteForce {
public:
    static constexpr double kRounding = 0x1p-21;

    explicit BruteForce(std::vector<WorldTriangle> triangles);

    const std::vector<WorldTriangle>& triangles() const { return triangles_; }

    /// The closest hit with t in [t_min, t_max]; ties go by (t, node, primitive). Zero-area and non-finite triangles are
    /// never hit, nor is anything by a ray that is not finite or has no direction.
    std::optional<OracleHit> closest_hit(const OracleRay& ray) const;

    /// Every triangle that the ray hits or nearly hits, in [t_min, t_max] give or take the tolerance.
    std::vector<Candidate> candidates(const OracleRay& ray) const;

private:
    /// A run of consecutive triangles and a box around them: only to skip what the ray passes by far.
    struct Group {
        size_t begin, end;
        glm::dvec3 lo, hi;
        double magnitude;
    };
    bool may_touch(const Group& group, const OracleRay& ray) const;

    std::vector<WorldTriangle> triangles_;
    std::vector<Group> groups_;
};

}  // namespace zoe::test
