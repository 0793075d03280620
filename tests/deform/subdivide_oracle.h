#pragma once

#include <array>
#include <map>
#include <vector>

#include <glm/ext/vector_double3.hpp>
#include <glm/vec3.hpp>

#include "engine/deform/cage.h"
#include "engine/math/rng.h"

namespace zoe::test {

using Edge = std::array<uint32_t, 2>;

inline Edge edge_of(uint32_t a, uint32_t b) {
    return a < b ? Edge{a, b} : Edge{b, a};
}

/// A polygon mesh in double precision, subdivided by the textbook, one level at a time: slow, and with no code of the
/// engine's. Boundaries are infinitely sharp edges, and vertices of one face alone stay.
struct PolygonMesh {
    std::vector<glm::dvec3> points;
    std::vector<std::vector<uint32_t>> faces;
    std::map<Edge, double> creases;
    std::map<uint32_t, double> corners;

    PolygonMesh catmull_clark() const;
    PolygonMesh loop() const;

    std::map<Edge, std::vector<uint32_t>> edge_faces() const;
    glm::dvec3 centre(uint32_t face) const;
    Cage cage(SubdivisionScheme scheme = SubdivisionScheme::kCatmullClark) const;
    std::vector<glm::vec3> positions() const { return {points.begin(), points.end()}; }

    /// What is around a vertex.
    struct Ring {
        std::vector<uint32_t> faces;
        std::vector<uint32_t> neighbours;  ///< By edges.
        std::vector<double> sharpness;     ///< Of those edges.
        double corner = 0.0;
    };

private:
    static constexpr double kSharp = 1e9;

    double sharpness(const Edge& edge, size_t face_count) const;
    std::vector<Ring> rings() const;
    template <typename Smooth>
    glm::dvec3 by_rule(uint32_t v, const Ring& ring, const std::vector<double>& sharp, double corner, Smooth smooth) const;
    template <typename Smooth>
    glm::dvec3 vertex_point(uint32_t v, const Ring& ring, Smooth smooth) const;
    template <typename EdgeRule, typename Smooth>
    PolygonMesh refined(bool is_loop, EdgeRule edge_rule, Smooth smooth) const;
};

PolygonMesh cube();
/// A flat sheet of n by n unit quads.
PolygonMesh sheet(uint32_t n);
/// A closed mesh with vertices of many valences: a cube whose faces are pierced or inset at random, then pushed about.
/// kind   the faces that come out: 0 mixed sizes, 3 triangles, 4 quads.
PolygonMesh random_closed(Rng& rng, int edits, int kind);

}  // namespace zoe::test
