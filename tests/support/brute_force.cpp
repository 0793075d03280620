#include "tests/support/brute_force.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

namespace zoe::test {
namespace {

using Vec3 = glm::vec<3, long double>;

bool is_finite(const glm::dvec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}
bool is_finite(const WorldTriangle& t) {
    return is_finite(t.a) && is_finite(t.b) && is_finite(t.c);
}
bool is_usable(const OracleRay& ray) {
    return is_finite(ray.origin) && is_finite(ray.direction) && ray.direction != glm::dvec3(0.0);
}

/// Seen from the origin of the ray, its direction has the three edges on one side: the signed volumes that it spans with
/// each edge agree in sign.
std::optional<long double> intersect(const OracleRay& ray, const WorldTriangle& triangle) {
    const Vec3 o(ray.origin), d(ray.direction);
    const Vec3 a = Vec3(triangle.a) - o, b = Vec3(triangle.b) - o, c = Vec3(triangle.c) - o;
    const long double u = glm::dot(d, glm::cross(c, b));
    const long double v = glm::dot(d, glm::cross(a, c));
    const long double w = glm::dot(d, glm::cross(b, a));
    if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0)) return std::nullopt;
    const Vec3 normal = glm::cross(b - a, c - a);
    const long double slope = glm::dot(normal, d);
    if (u + v + w == 0 || slope == 0) return std::nullopt;
    return glm::dot(normal, a) / slope;
}

double cross(const glm::dvec2& p, const glm::dvec2& q) {
    return p.x * q.y - p.y * q.x;
}

/// From the point (0, 0) to the line between p and q.
double segment_distance(const glm::dvec2& p, const glm::dvec2& q) {
    const glm::dvec2 along = q - p;
    const double square = glm::dot(along, along);
    const double s = square > 0.0 ? std::clamp(-glm::dot(p, along) / square, 0.0, 1.0) : 0.0;
    return glm::length(p + s * along);
}

/// The axes of a ray, of length 1 and at right angles.
struct RayAxes {
    double origin_distance, length;
    glm::dvec3 along, right, up;

    explicit RayAxes(const OracleRay& ray)
        : origin_distance(glm::length(ray.origin)), length(glm::length(ray.direction)), along(ray.direction / length) {
        const glm::dvec3 helper = std::abs(along.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
        right = glm::normalize(glm::cross(along, helper));
        up = glm::cross(right, along);
    }
};

/// The triangle as the ray sees it: corners across the ray (q) and along it (z), the ray at (0, 0).
std::optional<Candidate> candidate(const OracleRay& ray, const RayAxes& axes, const WorldTriangle& triangle) {
    const glm::dvec3& along = axes.along;
    const glm::dvec3 corners[3] = {triangle.a - ray.origin, triangle.b - ray.origin, triangle.c - ray.origin};
    glm::dvec2 q[3];
    for (int i = 0; i < 3; ++i) q[i] = {glm::dot(axes.right, corners[i]), glm::dot(axes.up, corners[i])};

    Candidate result;
    result.tolerance = BruteForce::kRounding * (triangle.magnitude + axes.origin_distance);
    // Most triangles lie as a whole on one side of the ray. Twice the tolerance leaves room for the rounding of q.
    const glm::dvec2 q_lo = glm::min(q[0], glm::min(q[1], q[2])), q_hi = glm::max(q[0], glm::max(q[1], q[2]));
    const double far = 2.0 * result.tolerance;
    if (q_lo.x > far || q_lo.y > far || q_hi.x < -far || q_hi.y < -far) return std::nullopt;

    const double z[3] = {glm::dot(along, corners[0]), glm::dot(along, corners[1]), glm::dot(along, corners[2])};
    const double u = cross(q[2], q[1]), v = cross(q[0], q[2]), w = cross(q[1], q[0]);
    const bool is_inside = (u > 0 && v > 0 && w > 0) || (u < 0 && v < 0 && w < 0);
    const double distance =
        std::min({segment_distance(q[0], q[1]), segment_distance(q[1], q[2]), segment_distance(q[2], q[0])});
    result.edge_distance = is_inside ? distance : -distance;
    if (result.edge_distance < -result.tolerance) return std::nullopt;
    result.is_sure = result.edge_distance > result.tolerance;

    // Where along the ray: rounded corners move the point of the triangle that is hit by at most `shift` across it
    // (the edge functions, rounded too, weigh in on needles), hence along it by the slope; never past the corners.
    const glm::dvec3 normal = glm::cross(triangle.b - triangle.a, triangle.c - triangle.a);
    const double normal_length = glm::length(normal);
    const double size = std::max({glm::length(q[0]), glm::length(q[1]), glm::length(q[2])});
    const double area = std::abs(u + v + w);
    const double needle = area > 0.0 ? 0x1p-21 * size * size * size / area : size;
    result.shift = result.tolerance + std::min(needle, size);
    double lo = std::min({z[0], z[1], z[2]}), hi = std::max({z[0], z[1], z[2]});
    if (normal_length > 0.0 && area > 0.0) {
        const double slope = glm::dot(normal, along) / normal_length;
        result.cosine = std::abs(slope);
        const double depth = glm::dot(normal, corners[0]) / normal_length / slope;
        const double reach = result.shift * std::sqrt(std::max(0.0, 1.0 - slope * slope)) / result.cosine;
        if (depth - reach > lo) lo = std::min(depth - reach, hi);
        if (depth + reach < hi) hi = std::max(depth + reach, lo);
    }
    result.t_lo = (lo - result.tolerance) / axes.length;
    result.t_hi = (hi + result.tolerance) / axes.length;
    if (result.t_hi < ray.t_min || result.t_lo > ray.t_max) return std::nullopt;
    if (result.t_lo < ray.t_min || result.t_hi > ray.t_max) result.is_sure = false;
    return result;
}

}  // namespace

BruteForce::BruteForce(std::vector<WorldTriangle> triangles) : triangles_(std::move(triangles)) {
    constexpr size_t kGroupSize = 32;
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    for (size_t begin = 0; begin < triangles_.size(); begin += kGroupSize) {
        Group group{begin, std::min(begin + kGroupSize, triangles_.size()), glm::dvec3(kInfinity), glm::dvec3(-kInfinity),
                    0.0};
        for (size_t i = group.begin; i < group.end; ++i) {
            const WorldTriangle& t = triangles_[i];
            if (!is_finite(t)) continue;
            group.lo = glm::min(group.lo, glm::min(t.a, glm::min(t.b, t.c)));
            group.hi = glm::max(group.hi, glm::max(t.a, glm::max(t.b, t.c)));
            group.magnitude = std::max(group.magnitude, t.magnitude);
        }
        groups_.push_back(group);
    }
}

bool BruteForce::may_touch(const Group& group, const OracleRay& ray) const {
    // Twice the tolerance is a thousand million times the rounding of this test.
    const double pad = 2.0 * kRounding * (group.magnitude + glm::length(ray.origin));
    const double t_pad = 2.0 * pad / glm::length(ray.direction);
    double t_in = ray.t_min - t_pad, t_out = ray.t_max + t_pad;
    for (int k = 0; k < 3; ++k) {
        const double lo = group.lo[k] - pad - ray.origin[k], hi = group.hi[k] + pad - ray.origin[k];
        if (ray.direction[k] == 0.0) {
            if (!(lo <= 0.0 && hi >= 0.0)) return false;
            continue;
        }
        const double t0 = lo / ray.direction[k], t1 = hi / ray.direction[k];
        t_in = std::max(t_in, std::min(t0, t1));
        t_out = std::min(t_out, std::max(t0, t1));
    }
    return t_in <= t_out;
}

std::optional<OracleHit> BruteForce::closest_hit(const OracleRay& ray) const {
    if (!is_usable(ray)) return std::nullopt;
    std::optional<OracleHit> closest;
    const auto key = [&](double t, size_t i) { return std::tuple(t, triangles_[i].node, triangles_[i].primitive); };
    for (const Group& group : groups_) {
        if (!may_touch(group, ray)) continue;
        for (size_t i = group.begin; i < group.end; ++i) {
            if (!is_finite(triangles_[i])) continue;
            const std::optional<long double> hit = intersect(ray, triangles_[i]);
            if (!hit || *hit < ray.t_min || *hit > ray.t_max) continue;
            const double t = static_cast<double>(*hit);
            if (!closest || key(t, i) < key(closest->t, closest->triangle)) closest = OracleHit{t, i};
        }
    }
    return closest;
}

std::vector<Candidate> BruteForce::candidates(const OracleRay& ray) const {
    std::vector<Candidate> found;
    if (!is_usable(ray)) return found;
    const RayAxes axes(ray);
    for (const Group& group : groups_) {
        if (!may_touch(group, ray)) continue;
        for (size_t i = group.begin; i < group.end; ++i) {
            if (!is_finite(triangles_[i])) continue;
            std::optional<Candidate> near = candidate(ray, axes, triangles_[i]);
            if (!near) continue;
            near->triangle = i;
            found.push_back(*near);
        }
    }
    return found;
}

}  // namespace zoe::test
