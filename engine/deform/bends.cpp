#include "engine/deform/bends.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <glm/geometric.hpp>

#include "engine/deform/subdivide_limit.h"

namespace zoe {

namespace {

namespace osd = OpenSubdiv;
using Level = osd::Far::TopologyLevel;

// Where a quadratic has second differences of 1 along the edges of a triangle, it is at most half of the sum of the edges'
// products of barycentric coordinates away from it: 1/6 where all three are. Of a quad split in two, the diagonal's
// difference is both sides' and twice the twist: 1/8 each, and 1/4. While an edge stays sharp, what it will be rounded off
// by is a third.
constexpr float kTriangleTurn = 1.0f / 6.0f, kQuadTurn = 1.0f / 4.0f, kTwist = 1.0f / 4.0f, kSharpTurn = 1.0f / 3.0f;

constexpr float kNearest = 1e-6f;  // Metres from the eye, so that what is around it has finite pixels.

// What a round leaves of a bend at a vertex of so many edges: the square of the largest eigenvalue below 1, or that of the
// next frequency, whichever is larger; a quarter where the surface is regular.
float decay_of(int valence, bool is_loop) {
    const auto eigenvalue = [&](int frequency) {
        const double c = std::cos(2.0 * std::numbers::pi * frequency / valence);
        return is_loop ? 0.375 + 0.25 * c : (c + 5.0 + std::sqrt((c + 9.0) * (c + 1.0))) / 16.0;
    };
    const double second = valence > 3 ? eigenvalue(2) : 0.0;
    return static_cast<float>(std::max({0.25, eigenvalue(1) * eigenvalue(1), second}));
}

class BendFinder {
public:
    BendFinder(const Level& level, bool is_loop) : level_(level), is_loop_(is_loop) {}

    void look_at_vertex(int vertex) {
        const osd::Far::ConstIndexArray edges = level_.GetVertexEdges(vertex);
        const int count = edges.size(), face_count = level_.GetVertexFaces(vertex).size();
        if (face_count == 0) return;
        ends_.clear();
        for (const int edge : edges) {
            const osd::Far::ConstIndexArray ends = level_.GetEdgeVertices(edge);
            ends_.push_back(static_cast<uint32_t>(ends[0] == vertex ? ends[1] : ends[0]));
        }
        // The three sharpest edges.
        int order[3] = {-1, -1, -1};
        for (int k = 0; k < count; ++k) {
            int at = k;
            for (int& place : order) {
                if (place < 0 || sharpness_of(edges[at]) > sharpness_of(edges[place])) std::swap(at, place);
                if (at < 0) break;
            }
        }
        const auto sharpness_at = [&](int place) { return order[place] < 0 ? 0.0f : sharpness_of(edges[order[place]]); };
        const float corner = level_.GetVertexSharpness(vertex);
        const float smooth_from = std::max(corner, sharpness_at(1)), crease_from = std::max(corner, sharpness_at(2));
        if (sharpness_at(1) > 0.0f) {
            const int between = std::abs(order[0] - order[1]);
            const int sector = std::max(between, face_count == count ? count - between : 0);
            add(vertex, ends_[order[0]], ends_[order[1]], ends_[order[1]], decay_of(2 * sector, is_loop_), crease_from);
        }
        if (face_count != count) return;
        const float decay = decay_of(count, is_loop_);
        for (int k = 0; k < (count % 2 == 0 ? count / 2 : count); ++k) {
            add(vertex, ends_[k], ends_[(k + count / 2) % count], ends_[(k + (count + 1) / 2) % count], decay, smooth_from);
        }
    }

    void look_at_face(int face) {
        const osd::Far::ConstIndexArray ring = level_.GetFaceVertices(face);
        const int size = ring.size();
        const auto at = [&](int k) { return static_cast<uint32_t>(ring[k % size]); };
        for (int k = 0; k < (size == 4 ? 1 : size); ++k) {
            const uint32_t v = at(k), before = at(k + size - 1), after = at(k + 1);
            // A triangle's twist is that of the quads that a round makes of it, four times as large.
            if (size == 3) {
                bends_.push_back({v, v, before, after, 2.0f / 3.0f, kTwist, decay_of(3, false), 0.0f, true});
            } else {
                bends_.push_back({v, at(k + size / 2), before, after, -1.0f, kTwist, decay_of(size, false), 0.0f, true});
            }
        }
    }

    std::vector<Bend> take() { return std::move(bends_); }

private:
    float sharpness_of(int edge) const { return level_.GetEdgeSharpness(edge); }

    void add(int vertex, uint32_t a, uint32_t b, uint32_t c, float decay, float sharpness) {
        if (sharpness >= osd::Sdc::Crease::SHARPNESS_INFINITE) return;
        const float weight = sharpness > 0.0f ? kSharpTurn : is_loop_ ? kTriangleTurn : kQuadTurn;
        bends_.push_back({static_cast<uint32_t>(vertex), a, b, c, 0.5f, weight, decay, sharpness, false});
    }

    const Level& level_;
    bool is_loop_;
    std::vector<uint32_t> ends_;
    std::vector<Bend> bends_;
};

}  // namespace

std::vector<Bend> find_bends(const Cage& cage, size_t vertex_count) {
    const auto refiner = subdivide_detail::make_refiner(cage, vertex_count, 0);
    const bool is_loop = cage.scheme == SubdivisionScheme::kLoop;
    BendFinder finder(refiner->GetLevel(0), is_loop);
    for (int v = 0; v < refiner->GetLevel(0).GetNumVertices(); ++v) finder.look_at_vertex(v);
    for (int f = 0; !is_loop && f < refiner->GetLevel(0).GetNumFaces(); ++f) finder.look_at_face(f);
    return finder.take();
}

void estimate_errors(std::span<const Bend> bends, std::span<const glm::vec3> positions, const Seen& seen,
                     std::span<float, kMaxSubdivisionLevel + 1> errors) {
    float turns[kMaxSubdivisionLevel + 1] = {}, twists[kMaxSubdivisionLevel + 1] = {};
    for (const Bend& bend : bends) {
        const glm::vec3 v = positions[bend.v];
        const glm::vec3 a = seen.world_from_local.linear * (positions[bend.a] - v);
        const glm::vec3 b = seen.world_from_local.linear * (positions[bend.b] - v);
        const glm::vec3 c = seen.world_from_local.linear * (positions[bend.c] - v);
        const float length = glm::length(a + bend.share * (b + c));
        if (!(length > 0.0f)) continue;
        // The surface around is within the ring of the vertex.
        const float reach = std::sqrt(std::max({glm::dot(a, a), glm::dot(b, b), glm::dot(c, c)}));
        const float distance = glm::length(seen.world_from_local.point(v) - seen.eye_world) - reach;
        float error = bend.weight * length * seen.pixels_at_1m / std::max(distance, kNearest) * std::exp2(-bend.sharpness);
        float* const worst = bend.is_twist ? twists : turns;
        for (int level = 1; level <= kMaxSubdivisionLevel; ++level) {
            const float smooth = std::clamp(static_cast<float>(level) - bend.sharpness, 0.0f, 1.0f);  // Of this round.
            if (smooth >= 1.0f) {
                error *= bend.decay;
            } else if (smooth > 0.0f) {
                error *= std::pow(bend.decay, smooth);
            }
            worst[level] = std::max(worst[level], error);
        }
    }
    errors[0] = std::numeric_limits<float>::infinity();
    for (int level = 1; level <= kMaxSubdivisionLevel; ++level) errors[level] = turns[level] + twists[level];
}

}  // namespace zoe
