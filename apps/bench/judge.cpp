#include "apps/bench/judge.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>

#include "engine/math/parallel.h"
#include "tests/support/brute_force.h"
#include "tests/support/world_triangle.h"

namespace zoe {
namespace {

using test::BruteForce;
using test::WorldTriangle;

/// Triangles that are held at once: bounds the memory.
constexpr size_t kBlockSize = size_t{1} << 20;

/// An instance's map in double, and how large the numbers are that it works with.
struct Placement {
    glm::dmat3 linear;
    glm::dvec3 translation, column_lengths;

    explicit Placement(const Affine& map)
        : linear(map.linear),
          translation(map.translation),
          column_lengths(glm::length(linear[0]), glm::length(linear[1]), glm::length(linear[2])) {}

    glm::dvec3 point(const glm::dvec3& p) const { return linear * p + translation; }
    /// No sum or product on the way from a local point to its place in the world is larger.
    double magnitude(const glm::dvec3& p) const { return glm::dot(glm::abs(p), column_lengths) + glm::length(translation); }
};

WorldTriangle place(const Instance& instance, const Placement& placement, size_t primitive) {
    const glm::uvec3& corners = instance.mesh->corners[primitive];
    const glm::dvec3 a(instance.positions[corners.x]), b(instance.positions[corners.y]), c(instance.positions[corners.z]);
    return {.a = placement.point(a),
            .b = placement.point(b),
            .c = placement.point(c),
            .node = index(instance.node),
            .primitive = static_cast<uint32_t>(primitive),
            .magnitude = std::max({placement.magnitude(a), placement.magnitude(b), placement.magnitude(c)})};
}

/// All triangles of a frame in a row, instance after instance.
class TriangleRow {
public:
    explicit TriangleRow(const Tlas& tlas) : tlas_(tlas) {
        for (const Instance& instance : tlas.instances) ends_.push_back(size() + instance.mesh->corners.size());
    }

    size_t size() const { return ends_.empty() ? 0 : ends_.back(); }

    /// Returns    triangles [begin, end) of the row.
    std::vector<WorldTriangle> slice(size_t begin, size_t end) const {
        std::vector<WorldTriangle> triangles(end - begin);
        parallel_for(begin, end, size_t{1} << 14, [&](size_t from, size_t to) {
            // The first instance that ends after `from`; empty ones never do.
            auto k = static_cast<size_t>(std::upper_bound(ends_.begin(), ends_.end(), from) - ends_.begin());
            for (size_t i = from; i < to; ++k) {
                const Instance& instance = tlas_.instances[k];
                const Placement placement(instance.world_from_local);
                const size_t first = ends_[k] - instance.mesh->corners.size();
                for (const size_t stop = std::min(to, ends_[k]); i < stop; ++i) {
                    triangles[i - begin] = place(instance, placement, i - first);
                }
            }
        });
        return triangles;
    }

private:
    const Tlas& tlas_;
    std::vector<size_t> ends_;  ///< [instance_count] where each one's triangles end.
};

/// A hit that is right, or that rounding may make right.
struct PossibleHit {
    uint32_t node, primitive;
    double t_lo, t_hi;
};

/// What may be answered for a ray.
struct Truth {
    std::vector<PossibleHit> hits;
    double limit = std::numeric_limits<double>::infinity();  ///< Something is surely hit at or before it.

    bool has_sure_hit() const { return limit < std::numeric_limits<double>::infinity(); }

    void add(const BruteForce& triangles, const test::OracleRay& ray) {
        for (const test::Candidate& candidate : triangles.candidates(ray)) {
            const WorldTriangle& triangle = triangles.triangles()[candidate.triangle];
            hits.push_back({triangle.node, triangle.primitive, candidate.t_lo, candidate.t_hi});
            if (candidate.is_sure) limit = std::min(limit, candidate.t_hi);
        }
    }
};

test::OracleRay oracle_ray(const Ray& ray) {
    return {
        .origin = glm::dvec3(ray.origin), .direction = glm::dvec3(ray.direction), .t_min = ray.t_min, .t_max = ray.t_max};
}

bool is_miss(const Hit& answer) {
    return !answer && answer.t == std::numeric_limits<float>::infinity();
}
bool is_shadow_hit(const Hit& answer) {
    return !answer && answer.t == 0.0f;
}

/// Tells whether rounding can lead from the truth to this answer. A NaN fails every comparison.
bool is_right(const Truth& truth, const Disagreement& disagreement, const Hit& answer) {
    if (is_miss(answer)) return !truth.has_sure_hit();
    if (disagreement.kind == RayKind::kShadow) return is_shadow_hit(answer) && !truth.hits.empty();
    if (!(answer.t >= disagreement.ray.t_min && answer.t <= disagreement.ray.t_max)) return false;
    return std::any_of(truth.hits.begin(), truth.hits.end(), [&](const PossibleHit& hit) {
        return hit.node == index(answer.node) && hit.primitive == answer.primitive && answer.t >= hit.t_lo &&
               answer.t <= hit.t_hi && hit.t_lo <= truth.limit;
    });
}

std::string words(const glm::vec3& v) {
    return fmt::format("({:.9g}, {:.9g}, {:.9g})", v.x, v.y, v.z);
}

std::string words(const Hit& answer, RayKind kind) {
    if (is_miss(answer)) return "miss";
    if (kind == RayKind::kShadow && is_shadow_hit(answer)) return "hit";
    if (!answer) return fmt::format("no node, t {:.9g}", answer.t);
    return fmt::format("node {} primitive {} t {:.9g}", index(answer.node), answer.primitive, answer.t);
}

const char* words(Verdict verdict) {
    constexpr std::array texts = {"ours is right, rounding does not explain the peer's",
                                  "the peer's is right, rounding does not explain ours", "rounding may lead to either",
                                  "neither is right, rounding explains none"};
    return texts[static_cast<size_t>(verdict)];
}

}  // namespace

const char* name(Verdict verdict) {
    constexpr std::array names = {"ours", "peers", "either", "neither"};
    return names[static_cast<size_t>(verdict)];
}

std::vector<Verdict> judge(const Tlas& tlas, std::span<const Disagreement> disagreements) {
    if (disagreements.empty()) return {};
    // Block by block: what is possible is collected over all triangles before anything is decided.
    std::vector<Truth> truths(disagreements.size());
    const TriangleRow row(tlas);
    for (size_t begin = 0; begin < row.size(); begin += kBlockSize) {
        const BruteForce triangles(row.slice(begin, std::min(begin + kBlockSize, row.size())));
        parallel_for(0, disagreements.size(), 1, [&](size_t from, size_t to) {
            for (size_t i = from; i < to; ++i) truths[i].add(triangles, oracle_ray(disagreements[i].ray));
        });
    }

    std::vector<Verdict> verdicts;
    for (size_t i = 0; i < disagreements.size(); ++i) {
        const bool is_ours_right = is_right(truths[i], disagreements[i], disagreements[i].ours);
        const bool is_peers_right = is_right(truths[i], disagreements[i], disagreements[i].peers);
        verdicts.push_back(is_ours_right ? (is_peers_right ? Verdict::kEither : Verdict::kOurs)
                                         : (is_peers_right ? Verdict::kPeers : Verdict::kNeither));
    }
    return verdicts;
}

std::string describe(const Disagreement& disagreement, Verdict verdict) {
    const Ray& ray = disagreement.ray;
    return fmt::format("frame {} {} ray {}: origin {} direction {} t [{:.9g}, {:.9g}]; ours: {}; peer's: {}; {}",
                       disagreement.frame, name(disagreement.kind), disagreement.ray_index, words(ray.origin),
                       words(ray.direction), ray.t_min, ray.t_max, words(disagreement.ours, disagreement.kind),
                       words(disagreement.peers, disagreement.kind), words(verdict));
}

}  // namespace zoe
