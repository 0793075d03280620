#include "tests/support/compare.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>
#include <glm/geometric.hpp>

namespace zoe::test {
namespace {

std::string words(const glm::dvec3& v) {
    return fmt::format("({:.9g}, {:.9g}, {:.9g})", v.x, v.y, v.z);
}

std::string words(const OracleRay& ray) {
    return fmt::format("ray {} -> {} t [{:.9g}, {:.9g}]", words(ray.origin), words(ray.direction), ray.t_min, ray.t_max);
}

std::string words(const BruteForce& truth, const std::optional<OracleHit>& hit) {
    if (!hit) return "a miss";
    const WorldTriangle& triangle = truth.triangles()[hit->triangle];
    return fmt::format("t {:.9g}, node {}, primitive {}", hit->t, triangle.node, triangle.primitive);
}

void add_wrong(const OracleRay& ray, const std::string& reason, Agreement* agreement) {
    constexpr size_t kShown = 3;
    if (agreement->wrong_count++ < kShown) agreement->first_wrong += "\n  " + reason + "\n    " + words(ray);
}

/// Where the sure hits leave room: none may be passed by.
double farthest_allowed(const std::vector<Candidate>& candidates) {
    double limit = std::numeric_limits<double>::infinity();
    for (const Candidate& candidate : candidates) {
        if (candidate.is_sure) limit = std::min(limit, candidate.t_hi);
    }
    return limit;
}

/// How far (u, v) on the triangle is from the point at t on the ray.
double distance_of_point(const OracleRay& ray, const WorldTriangle& triangle, const Hit& hit) {
    const double u = hit.u, v = hit.v;
    return glm::length((1.0 - u - v) * triangle.a + u * triangle.b + v * triangle.c -
                       (ray.origin + static_cast<double>(hit.t) * ray.direction));
}

/// Returns    what is wrong with a hit of this candidate, empty if nothing.
std::string check_hit(const OracleRay& ray, const WorldTriangle& triangle, const Candidate& candidate, double limit,
                      const Hit& hit) {
    // Each test is written so that a NaN fails it.
    if (!(hit.t >= candidate.t_lo && hit.t <= candidate.t_hi)) {
        return fmt::format("t must be in [{:.9g}, {:.9g}]", candidate.t_lo, candidate.t_hi);
    }
    if (!(candidate.t_lo <= limit)) return fmt::format("something is hit before {:.9g}", limit);
    constexpr float kSlack = 0x1p-20f;
    if (!(hit.u >= -kSlack && hit.v >= -kSlack && hit.u + hit.v <= 1.0f + kSlack)) return "(u, v) is outside the triangle";
    const double allowed = 2.0 * candidate.shift + (candidate.t_hi - candidate.t_lo) * glm::length(ray.direction);
    if (!(distance_of_point(ray, triangle, hit) <= allowed)) {
        return fmt::format("(u, v) is {:.3g} from the point on the ray, allowed is {:.3g}",
                           distance_of_point(ray, triangle, hit), allowed);
    }
    return "";
}

}  // namespace

Ray engine_ray(const OracleRay& ray) {
    return {.origin = glm::vec3(ray.origin),
            .direction = glm::vec3(ray.direction),
            .t_min = static_cast<float>(ray.t_min),
            .t_max = static_cast<float>(ray.t_max)};
}

testing::AssertionResult Agreement::verdict(double largest_tie_share) const {
    constexpr double kLargestBorderlineShare = 0.01;
    const std::string counts =
        fmt::format("{} rays, {} hits, {} borderline, {} ties, {} wrong; worst t {:.3g} of the tolerance{}", ray_count,
                    hit_count, borderline_count, tie_count, wrong_count, worst_t, first_wrong);
    const auto is_few = [this](size_t count, double share) {
        return static_cast<double>(count) <= std::max(1.0, share * static_cast<double>(ray_count));
    };
    if (ray_count == 0 || wrong_count > 0 || !is_few(borderline_count, kLargestBorderlineShare) ||
        !is_few(tie_count, largest_tie_share)) {
        return testing::AssertionFailure() << counts;
    }
    return testing::AssertionSuccess() << counts;
}

void Agreement::add(const Agreement& other) {
    ray_count += other.ray_count;
    hit_count += other.hit_count;
    borderline_count += other.borderline_count;
    tie_count += other.tie_count;
    wrong_count += other.wrong_count;
    first_wrong += other.first_wrong;
    worst_t = std::max(worst_t, other.worst_t);
}

void compare_closest(const BruteForce& truth, const OracleRay& ray, const Hit& hit, Agreement* agreement) {
    ++agreement->ray_count;
    const std::optional<OracleHit> exact = truth.closest_hit(ray);
    const std::vector<Candidate> candidates = truth.candidates(ray);
    const double limit = farthest_allowed(candidates);
    if (!hit) {
        if (!(hit == Hit{})) return add_wrong(ray, "a miss with numbers in it", agreement);
        if (limit < std::numeric_limits<double>::infinity()) {
            return add_wrong(ray, "a miss; exact is " + words(truth, exact), agreement);
        }
        if (exact) ++agreement->borderline_count;
        return;
    }
    ++agreement->hit_count;
    const std::string answer = fmt::format("t {:.9g}, u {:.9g}, v {:.9g}, node {}, primitive {}; exact is {}", hit.t, hit.u,
                                           hit.v, static_cast<uint32_t>(hit.node), hit.primitive, words(truth, exact));
    if (!(hit.t >= ray.t_min && hit.t <= ray.t_max)) return add_wrong(ray, answer + ": t outside the ray", agreement);
    for (const Candidate& candidate : candidates) {
        const WorldTriangle& triangle = truth.triangles()[candidate.triangle];
        if (triangle.node != static_cast<uint32_t>(hit.node) || triangle.primitive != hit.primitive) continue;
        const std::string reason = check_hit(ray, triangle, candidate, limit, hit);
        if (!reason.empty()) return add_wrong(ray, answer + ": " + reason, agreement);
        if (exact && exact->triangle == candidate.triangle) {
            agreement->worst_t =
                std::max(agreement->worst_t, 2.0 * std::abs(hit.t - exact->t) / (candidate.t_hi - candidate.t_lo));
        } else {
            const auto is_exact = [&](const Candidate& c) { return exact && c.triangle == exact->triangle && c.is_sure; };
            const bool is_tie = candidate.is_sure && std::any_of(candidates.begin(), candidates.end(), is_exact);
            ++(is_tie ? agreement->tie_count : agreement->borderline_count);
        }
        return;
    }
    add_wrong(ray, answer + ": the ray is nowhere near that triangle", agreement);
}

void compare_any(const BruteForce& truth, const OracleRay& ray, bool is_hit, Agreement* agreement) {
    ++agreement->ray_count;
    if (is_hit) ++agreement->hit_count;
    const std::optional<OracleHit> exact = truth.closest_hit(ray);
    if (exact.has_value() == is_hit) return;
    const std::vector<Candidate> candidates = truth.candidates(ray);
    const bool is_possible = is_hit ? !candidates.empty() : !std::isfinite(farthest_allowed(candidates));
    if (is_possible) {
        ++agreement->borderline_count;
    } else {
        add_wrong(ray, fmt::format("any hit says {}; exact is {}", is_hit, words(truth, exact)), agreement);
    }
}

}  // namespace zoe::test
