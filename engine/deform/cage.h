#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace zoe {

enum class SubdivisionScheme {
    kCatmullClark,  ///< Faces of any size.
    kLoop,          ///< Triangles only.
};

/// What the surface does where the cage ends.
enum class BoundaryRule {
    kNone,           ///< Faces at the boundary only shape their neighbours: they make no surface.
    kEdge,           ///< The boundary is a smooth curve.
    kEdgeAndCorner,  ///< The same, and a vertex of one face alone stays where it is.
};

/// What texture coordinates do at their seams and boundaries.
enum class UvRule {
    kSmooth,      ///< Curves everywhere.
    kCorners,     ///< Curves that keep their corners.
    kBoundaries,  ///< Polylines; smooth inside only.
    kLinear,      ///< Bilinear everywhere.
};

/// How many sets of texture coordinates a cage, or a mesh, may have.
inline constexpr size_t kMaxUvSets = 8;

/// Face-varying texture coordinates: where the corners of a vertex differ, there is a seam.
struct CageUvs {
    std::vector<glm::vec2> values;
    std::vector<uint32_t> corners;  ///< [corner_count] indices into values, or empty.
};

/// The topology of a subdivision surface's control mesh: plain arrays, no positions, since those change by frame.
/// Source     Catmull, Clark. Recursively Generated B-Spline Surfaces on Arbitrary Topological Meshes. CAD 1978.
///            Loop. Smooth Subdivision Surfaces Based on Triangles. University of Utah 1987.
///            DeRose, Kass, Truong. Subdivision Surfaces in Character Animation. SIGGRAPH 1998 (creases).
struct Cage {
    SubdivisionScheme scheme = SubdivisionScheme::kCatmullClark;
    BoundaryRule boundary = BoundaryRule::kEdgeAndCorner;
    UvRule uv_rule = UvRule::kCorners;
    std::vector<uint32_t> face_sizes;  ///< [face_count] vertices of each face.
    std::vector<uint32_t> vertices;    ///< [corner_count] the faces' vertices one after another, counter-clockwise.
    std::vector<std::array<uint32_t, 2>> crease_edges;  ///< Edges that are creased, by their two vertices.
    std::vector<float> crease_sharpness;                ///< [crease] 0 smooth; 10 and more: sharp at every level.
    std::vector<uint32_t> corner_vertices;              ///< Vertices that are sharpened.
    std::vector<float> corner_sharpness;                ///< [corner vertex] as for creases.
    std::array<CageUvs, kMaxUvSets> uvs;                ///< Those that there are; the others are empty.
};

/// The bounds of what `make_subdivision` accepts.
inline constexpr int kMaxSubdivisionLevel = 8;
inline constexpr uint64_t kMaxStencilEntries = uint64_t{1} << 28;

/// Triangles that `level` rounds of subdivision make of a cage whose faces have `face_sizes`; boundary faces count.
/// Returns    the number, or UINT64_MAX where it has more than 64 bits.
uint64_t count_triangles(const Cage& cage, int level);

/// The cage's faces as triangles, each split from its first vertex: what shows the cage itself.
/// Returns    [sum over the faces of size - 2] face after face.
std::vector<glm::uvec3> split_faces(const Cage& cage);

/// The finest level at which a cage's surface fits into `kMaxStencilEntries`, at most `kMaxSubdivisionLevel`; 0: there is
/// none.
/// Requires   that `check` of the cage is empty at some level.
int finest_level(const Cage& cage, size_t vertex_count);

/// Tells whether a cage can be subdivided: indices in range, proper faces, at most two faces an edge and one fan of faces a
/// vertex, all wound alike, creases that exist, numbers that are numbers, and a bounded result. Vertices without a face are
/// legal.
/// vertex_count   of the cage positions.
/// Returns    the text of the first fault, with the face or edge it is at; empty where there is none.
/// Cost       O(corners log corners).
std::string check(const Cage& cage, size_t vertex_count, int level);

}  // namespace zoe
