#pragma once

#include <cstddef>
#include <string>

#include <gtest/gtest.h>

#include "engine/frame/trace.h"
#include "tests/support/brute_force.h"

namespace zoe::test {

/// The same ray for the engine. Exact: an oracle ray's numbers are floats.
Ray engine_ray(const OracleRay& ray);

/// What a series of rays came to, ray by ray.
struct Agreement {
    size_t ray_count = 0, hit_count = 0;
    /// Rays whose answer differs from the exact one, where the oracle shows that rounding may do that: the ray passes an
    /// edge, or another triangle, within the tolerance (see `BruteForce`).
    size_t borderline_count = 0;
    /// Rays that surely hit both the exact triangle and the one answered, at the same t within the tolerance: surfaces that
    /// lie in each other in the file.
    size_t tie_count = 0;
    size_t wrong_count = 0;
    std::string first_wrong;  ///< The first few wrong rays in words.
    double worst_t = 0.0;     ///< Largest error in t of all hits, as a share of what is allowed.

    /// Fails for any wrong ray, for more borderline rays than 1 %, for more ties than told (one of each is always allowed),
    /// and where no ray was compared.
    testing::AssertionResult verdict(double largest_tie_share = 0.01) const;
    /// Adds the counts of another series.
    void add(const Agreement& other);
};

/// Compares the closest hit of one ray: hit or miss, t, node, primitive, and that (u, v) is the point hit.
/// NaN, infinite t of a hit, and t outside [t_min, t_max] are wrong.
void compare_closest(const BruteForce& truth, const OracleRay& ray, const Hit& hit, Agreement* agreement);

/// Compares whether anything is hit.
void compare_any(const BruteForce& truth, const OracleRay& ray, bool is_hit, Agreement* agreement);

}  // namespace zoe::test
