#include "engine/deform/subdivide_limit.h"

#include <algorithm>
#include <cassert>

#include <opensubdiv/sdc/catmarkScheme.h>
#include <opensubdiv/sdc/loopScheme.h>

namespace zoe::subdivide_detail {

namespace {

namespace osd = OpenSubdiv;
using Level = osd::Far::TopologyLevel;
using Refiner = osd::Far::TopologyRefiner;
using Table = osd::Far::StencilTableReal<double>;

/// Weights of a vertex, of the far ends of its edges, and of the far corners of its faces, in the form of OpenSubdiv's
/// schemes.
class Mask {
public:
    using Weight = double;

    explicit Mask(int max_valence) : edges_(max_valence + 1), faces_(max_valence + 1) {}
    int GetNumEdgeWeights() const { return edge_count_; }
    int GetNumFaceWeights() const { return face_count_; }
    void SetNumVertexWeights(int) {}
    void SetNumEdgeWeights(int count) { edge_count_ = count; }
    void SetNumFaceWeights(int count) { face_count_ = count; }
    Weight& VertexWeight(int) { return vertex_; }
    Weight& EdgeWeight(int k) { return edges_[k]; }
    Weight& FaceWeight(int k) { return faces_[k]; }
    bool AreFaceWeightsForFaceCenters() const { return false; }
    void SetFaceWeightsForFaceCenters(bool is_for_centres) { assert(!is_for_centres); }

    Weight vertex() const { return vertex_; }
    /// 0 where this mask has no such.
    Weight edge(int k) const { return k < edge_count_ ? edges_[k] : 0.0; }
    Weight face(int k) const { return k < face_count_ ? faces_[k] : 0.0; }

private:
    int edge_count_ = 0, face_count_ = 0;
    Weight vertex_ = 0.0;
    std::vector<Weight> edges_, faces_;
};

struct Weights {
    double position = 0.0, u = 0.0, v = 0.0;
};

/// Composes masks over the last level with that level's stencils over the cage, one refined vertex after another.
class StencilBuilder {
public:
    StencilBuilder(const Refiner& refiner, const Table& table, bool is_limit, bool has_tangents)
        : refiner_(refiner),
          level_(refiner.GetLevel(refiner.GetMaxLevel())),
          table_(table),
          is_limit_(is_limit),
          has_tangents_(has_tangents),
          position_(refiner.GetMaxValence()),
          u_(refiner.GetMaxValence()),
          v_(refiner.GetMaxValence()),
          sums_(table.GetNumControlVertices()),
          is_touched_(table.GetNumControlVertices(), 0) {
        out_.offsets.push_back(0);
    }

    void append(const View& view) {
        if (is_limit_) {
            // The position comes from the same sector for all views of a vertex, so that they agree.
            const Sector shared = find_sector(level_, view.vertex, 0);
            compute_masks(shared);
            gather(view.vertex, shared, true);
        } else {
            add(view.vertex, {1.0, 0.0, 0.0});
        }
        if (has_tangents_) {
            const Sector sector = find_sector(level_, view.vertex, view.face);
            compute_masks(sector);
            gather(view.vertex, sector, false);
        }
        flush();
    }

    StencilTable take() { return std::move(out_); }

private:
    void compute_masks(const Sector& sector) {
        if (refiner_.GetSchemeType() == osd::Sdc::SCHEME_LOOP) {
            const osd::Sdc::Scheme<osd::Sdc::SCHEME_LOOP> scheme(refiner_.GetSchemeOptions());
            scheme.ComputeVertexLimitMask(sector, position_, u_, v_, sector.rule);
        } else {
            const osd::Sdc::Scheme<osd::Sdc::SCHEME_CATMARK> scheme(refiner_.GetSchemeOptions());
            scheme.ComputeVertexLimitMask(sector, position_, u_, v_, sector.rule);
        }
    }

    /// Adds the masks' terms of the position, or those of the tangents.
    void gather(int vertex, const Sector& sector, bool is_position) {
        const auto weights = [&](auto weight_of) {
            return is_position ? Weights{weight_of(position_), 0.0, 0.0} : Weights{0.0, weight_of(u_), weight_of(v_)};
        };
        const osd::Far::ConstIndexArray edges = level_.GetVertexEdges(vertex), faces = level_.GetVertexFaces(vertex);
        const osd::Far::ConstLocalIndexArray places = level_.GetVertexFaceLocalIndices(vertex);
        add(vertex, weights([](const Mask& m) { return m.vertex(); }));
        for (int k = 0; k < sector.edge_count; ++k) {
            const osd::Far::ConstIndexArray ends = level_.GetEdgeVertices(edges[(sector.first + k) % edges.size()]);
            add(ends[0] == vertex ? ends[1] : ends[0], weights([k](const Mask& m) { return m.edge(k); }));
        }
        for (int k = 0; k < sector.face_count; ++k) {
            const int face = (sector.first + k) % faces.size();
            const osd::Far::ConstIndexArray ring = level_.GetFaceVertices(faces[face]);
            add(ring[(places[face] + 2) % ring.size()], weights([k](const Mask& m) { return m.face(k); }));
        }
    }

    void add(int vertex, const Weights& weights) {
        if (weights.position == 0.0 && weights.u == 0.0 && weights.v == 0.0) return;
        const int begin = table_.GetOffsets()[vertex], end = begin + table_.GetSizes()[vertex];
        for (int k = begin; k < end; ++k) {
            const int index = table_.GetControlIndices()[k];
            if (!is_touched_[index]) {
                is_touched_[index] = 1;
                touched_.push_back(index);
            }
            Weights& sum = sums_[index];
            sum.position += table_.GetWeights()[k] * weights.position;
            sum.u += table_.GetWeights()[k] * weights.u;
            sum.v += table_.GetWeights()[k] * weights.v;
        }
    }

    void push(uint32_t index, const Weights& weights) {
        out_.indices.push_back(index);
        out_.weights.push_back(static_cast<float>(weights.position));
        if (!has_tangents_) return;
        out_.u_weights.push_back(static_cast<float>(weights.u));
        out_.v_weights.push_back(static_cast<float>(weights.v));
    }

    void flush() {
        std::sort(touched_.begin(), touched_.end());
        for (const uint32_t index : touched_) {
            push(index, sums_[index]);
            sums_[index] = {};
            is_touched_[index] = 0;
        }
        while (out_.indices.size() % 4 != 0) push(touched_.back(), {});
        touched_.clear();
        out_.offsets.push_back(static_cast<uint32_t>(out_.indices.size()));
    }

    const Refiner& refiner_;
    const Level& level_;
    const Table& table_;
    bool is_limit_, has_tangents_;
    Mask position_, u_, v_;
    std::vector<Weights> sums_;
    std::vector<uint8_t> is_touched_;
    std::vector<uint32_t> touched_;
    StencilTable out_;
};

}  // namespace

Sector find_sector(const Level& level, int vertex, int face) {
    using osd::Sdc::Crease;
    const osd::Far::ConstIndexArray edges = level.GetVertexEdges(vertex);
    const int edge_count = edges.size(), face_count = level.GetVertexFaces(vertex).size();
    const bool is_interior = edge_count == face_count;
    const Crease::Rule rule = level.GetVertexRule(vertex);
    if ((rule == Crease::RULE_SMOOTH || rule == Crease::RULE_DART) && is_interior)
        return {0, face_count, edge_count, Crease::RULE_SMOOTH};
    if (rule != Crease::RULE_CREASE) return {face, 1, 2, Crease::RULE_CORNER};
    int begin = 0;
    while (begin < edge_count && level.GetEdgeSharpness(edges[begin]) <= 0.0f) ++begin;
    int end = begin + 1;
    while (end < edge_count && level.GetEdgeSharpness(edges[end]) <= 0.0f) ++end;
    assert(end < edge_count);
    if (!is_interior || (face >= begin && face < end)) return {begin, end - begin, end - begin + 1, Crease::RULE_CREASE};
    return {end, edge_count - (end - begin), edge_count - (end - begin) + 1, Crease::RULE_CREASE};
}

StencilTable compose_stencils(const Refiner& refiner, const Table& table, std::span<const View> views, bool is_limit,
                              bool has_tangents) {
    StencilBuilder builder(refiner, table, is_limit, has_tangents);
    for (const View& view : views) builder.append(view);
    return builder.take();
}

}  // namespace zoe::subdivide_detail
