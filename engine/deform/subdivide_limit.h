#pragma once

#include <algorithm>
#include <memory>
#include <span>

#include <opensubdiv/far/stencilTable.h>
#include <opensubdiv/far/topologyRefiner.h>
#include <opensubdiv/sdc/crease.h>

#include "engine/deform/cage.h"
#include "engine/deform/stencils.h"

// Part of subdivide: how vertices of the last level of refinement follow the cage. Not for others to include.
namespace zoe::subdivide_detail {

/// The cage as OpenSubdiv's topology.
/// level   rounds of refinement; 0: the cage alone.
/// Throws  std::runtime_error where OpenSubdiv refuses the cage.
std::unique_ptr<OpenSubdiv::Far::TopologyRefiner> make_refiner(const Cage& cage, size_t vertex_count, int level);

/// Consecutive faces around a vertex over which the surface is smooth: faces [first, first + face_count) in turn, between
/// edges [first, first + face_count]. As OpenSubdiv's masks ask for it, a neighbourhood of its own.
struct Sector {
    int first = 0, face_count = 0, edge_count = 0;
    OpenSubdiv::Sdc::Crease::Rule rule = OpenSubdiv::Sdc::Crease::RULE_SMOOTH;

    int GetNumEdges() const { return edge_count; }
    int GetNumFaces() const { return face_count; }
    void GetSharpnessPerEdge(float* sharpness) const {
        std::fill(sharpness, sharpness + edge_count, OpenSubdiv::Sdc::Crease::SHARPNESS_SMOOTH);
        sharpness[0] = sharpness[edge_count - 1] = OpenSubdiv::Sdc::Crease::SHARPNESS_INFINITE;
    }
};

/// The sector that the face at place `face` of a vertex's ring is in.
/// level   the last level of refinement, with all of its topology. Sharpness above 0 counts as infinite.
/// Where a sharp crease ends, that is all of the ring, as if it were smooth: the limit is off by some thousandths of an edge
/// at level 1, by less than half as much with each level more, its normal by some degrees.
Sector find_sector(const OpenSubdiv::Far::TopologyLevel& level, int vertex, int face);

/// A vertex of the last level as it is seen from one of the faces in its ring.
struct View {
    int vertex = 0, face = 0;
};

/// Composes the schemes' masks over the last level (limit position, tangents) with that level's stencils over the cage.
/// table     the stencils of the last level's vertices.
/// Returns   a stencil a view. Views of the same vertex have the same position to the last bit.
/// Source    Halstead, Kass, DeRose. Efficient, Fair Interpolation Using Catmull-Clark Surfaces. SIGGRAPH 1993.
StencilTable compose_stencils(const OpenSubdiv::Far::TopologyRefiner& refiner,
                              const OpenSubdiv::Far::StencilTableReal<double>& table, std::span<const View> views,
                              bool is_limit, bool has_tangents);

}  // namespace zoe::subdivide_detail
