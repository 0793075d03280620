#include "engine/deform/cage.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace zoe {

namespace {

constexpr uint32_t kNoCorner = UINT32_MAX;

/// The side of a face that starts at a corner, keyed by its edge.
struct HalfEdge {
    uint32_t low, high;  ///< The edge's vertices, ordered.
    uint32_t corner;
    bool is_same_edge(const HalfEdge& other) const { return low == other.low && high == other.high; }
};

bool is_before(const HalfEdge& a, const HalfEdge& b) {
    if (a.low != b.low) return a.low < b.low;
    return a.high != b.high ? a.high < b.high : a.corner < b.corner;
}

/// By corner: the face it is of, and its neighbours around that face.
struct Corners {
    std::vector<uint32_t> face, next, previous;
};

std::string edge_text(uint32_t a, uint32_t b) {
    return "edge (" + std::to_string(a) + ", " + std::to_string(b) + ")";
}

uint64_t saturating_product(uint64_t a, uint64_t b) {
    return b != 0 && a > UINT64_MAX / b ? UINT64_MAX : a * b;
}

uint64_t saturating_sum(uint64_t a, uint64_t b) {
    return a > UINT64_MAX - b ? UINT64_MAX : a + b;
}

std::string check_sizes(const Cage& cage, size_t vertex_count) {
    if (cage.face_sizes.empty()) return "the cage has no faces";
    if (vertex_count > INT32_MAX) return "the cage has too many vertices";
    uint64_t corner_count = 0;
    for (size_t f = 0; f < cage.face_sizes.size(); ++f) {
        const uint32_t size = cage.face_sizes[f];
        if (size < 3) return "face " + std::to_string(f) + " has " + std::to_string(size) + " vertices";
        if (cage.scheme == SubdivisionScheme::kLoop && size != 3)
            return "face " + std::to_string(f) + " has " + std::to_string(size) + " vertices; Loop needs triangles";
        corner_count += size;
    }
    if (corner_count != cage.vertices.size())
        return "the faces have " + std::to_string(corner_count) + " corners, but there are " +
               std::to_string(cage.vertices.size()) + " vertex indices";
    if (corner_count > INT32_MAX) return "the cage has too many corners";
    for (const uint32_t v : cage.vertices) {
        if (v >= vertex_count) return "vertex index " + std::to_string(v) + " of " + std::to_string(vertex_count);
    }
    return "";
}

std::string check_uvs(const Cage& cage, const CageUvs& uvs) {
    if (uvs.values.empty() && uvs.corners.empty()) return "";
    if (uvs.corners.size() != cage.vertices.size())
        return "there are " + std::to_string(uvs.corners.size()) + " texture coordinate indices for " +
               std::to_string(cage.vertices.size()) + " corners";
    if (uvs.values.size() > INT32_MAX) return "the cage has too many texture coordinates";
    for (const uint32_t uv : uvs.corners) {
        if (uv >= uvs.values.size())
            return "texture coordinate index " + std::to_string(uv) + " of " + std::to_string(uvs.values.size());
    }
    for (const glm::vec2& uv : uvs.values) {
        if (!std::isfinite(uv.x) || !std::isfinite(uv.y)) return "a texture coordinate is not finite";
    }
    return "";
}

Corners connect(const Cage& cage) {
    Corners corners;
    const size_t count = cage.vertices.size();
    corners.face.resize(count);
    corners.next.resize(count);
    corners.previous.resize(count);
    uint32_t first = 0;
    for (uint32_t f = 0; f < cage.face_sizes.size(); ++f) {
        const uint32_t size = cage.face_sizes[f];
        for (uint32_t k = 0; k < size; ++k) {
            corners.face[first + k] = f;
            corners.next[first + k] = first + (k + 1) % size;
            corners.previous[first + k] = first + (k + size - 1) % size;
        }
        first += size;
    }
    return corners;
}

std::string check_distinct(const Cage& cage, size_t vertex_count) {
    std::vector<uint32_t> last_face(vertex_count, UINT32_MAX);
    size_t corner = 0;
    for (uint32_t f = 0; f < cage.face_sizes.size(); ++f) {
        for (uint32_t k = 0; k < cage.face_sizes[f]; ++k, ++corner) {
            const uint32_t v = cage.vertices[corner];
            if (last_face[v] == f) return "face " + std::to_string(f) + " has vertex " + std::to_string(v) + " twice";
            last_face[v] = f;
        }
    }
    return "";
}

std::vector<HalfEdge> sorted_half_edges(const Cage& cage, const Corners& corners) {
    std::vector<HalfEdge> halves(cage.vertices.size());
    for (uint32_t c = 0; c < halves.size(); ++c) {
        const uint32_t from = cage.vertices[c], to = cage.vertices[corners.next[c]];
        halves[c] = {std::min(from, to), std::max(from, to), c};
    }
    std::sort(halves.begin(), halves.end(), is_before);
    return halves;
}

/// Fills in, by corner, the half edge on the other side of the edge that starts there.
std::string pair_half_edges(const Cage& cage, const Corners& corners, const std::vector<HalfEdge>& halves,
                            std::vector<uint32_t>* twins) {
    twins->assign(halves.size(), kNoCorner);
    for (size_t k = 0; k + 1 < halves.size(); ++k) {
        const HalfEdge &a = halves[k], &b = halves[k + 1];
        if (!a.is_same_edge(b)) continue;
        if (k + 2 < halves.size() && a.is_same_edge(halves[k + 2]))
            return "more than two faces share " + edge_text(a.low, a.high);
        if (cage.vertices[a.corner] == cage.vertices[b.corner])
            return "faces " + std::to_string(corners.face[a.corner]) + " and " + std::to_string(corners.face[b.corner]) +
                   " run along " + edge_text(a.low, a.high) + " the same way: their windings differ";
        (*twins)[a.corner] = b.corner;
        (*twins)[b.corner] = a.corner;
    }
    return "";
}

/// All faces of a vertex must be reached by turning around it across edges.
std::string check_fans(const Cage& cage, size_t vertex_count, const Corners& corners, const std::vector<uint32_t>& twins) {
    std::vector<uint32_t> degree(vertex_count, 0), start(vertex_count, kNoCorner);
    for (uint32_t c = 0; c < cage.vertices.size(); ++c) {
        ++degree[cage.vertices[c]];
        start[cage.vertices[c]] = c;
    }
    for (uint32_t v = 0; v < vertex_count; ++v) {
        if (degree[v] == 0) continue;
        uint32_t reached = 1;
        uint32_t c = twins[corners.previous[start[v]]];
        for (; c != kNoCorner && c != start[v]; c = twins[corners.previous[c]]) ++reached;
        if (c == kNoCorner) {  // The cage ends here: turn the other way, too.
            for (uint32_t t = twins[start[v]]; t != kNoCorner; t = twins[corners.next[t]]) ++reached;
        }
        if (reached != degree[v]) return "the faces at vertex " + std::to_string(v) + " touch in that vertex only";
    }
    return "";
}

std::string check_sharpness(const Cage& cage, size_t vertex_count, const std::vector<HalfEdge>& halves) {
    if (cage.crease_edges.size() != cage.crease_sharpness.size())
        return "there are " + std::to_string(cage.crease_sharpness.size()) + " sharpnesses for " +
               std::to_string(cage.crease_edges.size()) + " creases";
    if (cage.corner_vertices.size() != cage.corner_sharpness.size())
        return "there are " + std::to_string(cage.corner_sharpness.size()) + " sharpnesses for " +
               std::to_string(cage.corner_vertices.size()) + " corners";
    for (size_t k = 0; k < cage.crease_edges.size(); ++k) {
        const auto [a, b] = cage.crease_edges[k];
        const std::string where = "crease " + std::to_string(k) + ": ";
        if (!(cage.crease_sharpness[k] >= 0.0f)) return where + "its sharpness is not a number of at least 0";
        const HalfEdge key = {std::min(a, b), std::max(a, b), 0};
        const auto found = std::lower_bound(halves.begin(), halves.end(), key, is_before);
        if (found == halves.end() || !found->is_same_edge(key)) return where + "no face has an " + edge_text(a, b);
    }
    for (size_t k = 0; k < cage.corner_vertices.size(); ++k) {
        const std::string where = "corner " + std::to_string(k) + ": ";
        if (!(cage.corner_sharpness[k] >= 0.0f)) return where + "its sharpness is not a number of at least 0";
        if (cage.corner_vertices[k] >= vertex_count)
            return where + "vertex index " + std::to_string(cage.corner_vertices[k]) + " of " + std::to_string(vertex_count);
    }
    return "";
}

/// Bounds the sum over faces of (vertices made inside) * (cage vertices that those may follow). A vertex made inside of a
/// face follows the vertices of the faces that touch it, no others; so a pole of many faces has a price of its square.
uint64_t bound_entries(const Cage& cage, size_t vertex_count, int level) {
    std::vector<uint64_t> ring_size(vertex_count, 1);
    size_t corner = 0;
    for (const uint32_t size : cage.face_sizes) {
        for (uint32_t k = 0; k < size; ++k) ring_size[cage.vertices[corner++]] += size - 2;
    }
    const bool is_loop = cage.scheme == SubdivisionScheme::kLoop;
    uint64_t total = 0;
    corner = 0;
    for (const uint32_t size : cage.face_sizes) {
        uint64_t support = 0;
        for (uint32_t k = 0; k < size; ++k) support = saturating_sum(support, ring_size[cage.vertices[corner++]]);
        const uint64_t made = is_loop ? uint64_t{1} << (2 * level) : uint64_t{size} << (2 * level - 2);
        total = saturating_sum(total, saturating_product(made, support));
    }
    return total;
}

}  // namespace

uint64_t count_triangles(const Cage& cage, int level) {
    uint64_t corner_count = 0;
    for (const uint32_t size : cage.face_sizes) corner_count += size;
    if (level <= 0) return corner_count - 2 * cage.face_sizes.size();
    const bool is_loop = cage.scheme == SubdivisionScheme::kLoop;
    uint64_t count = is_loop ? 4 * cage.face_sizes.size() : 2 * corner_count;
    for (int k = 1; k < level; ++k) count = saturating_product(count, 4);
    return count;
}

int finest_level(const Cage& cage, size_t vertex_count) {
    int level = kMaxSubdivisionLevel;
    while (level > 0 && bound_entries(cage, vertex_count, level) > kMaxStencilEntries) --level;
    return level;
}

std::vector<glm::uvec3> split_faces(const Cage& cage) {
    std::vector<glm::uvec3> triangles;
    size_t first = 0;
    for (const uint32_t size : cage.face_sizes) {
        for (uint32_t k = 2; k < size; ++k) {
            triangles.emplace_back(cage.vertices[first], cage.vertices[first + k - 1], cage.vertices[first + k]);
        }
        first += size;
    }
    return triangles;
}

std::string check(const Cage& cage, size_t vertex_count, int level) {
    if (level < 1 || level > kMaxSubdivisionLevel)
        return "level " + std::to_string(level) + " is not 1 to " + std::to_string(kMaxSubdivisionLevel);
    if (std::string fault = check_sizes(cage, vertex_count); !fault.empty()) return fault;
    if (bound_entries(cage, vertex_count, level) > kMaxStencilEntries)
        return "level " + std::to_string(level) + " would make " + std::to_string(count_triangles(cage, level)) +
               " triangles: too many for their stencils";
    if (std::string fault = check_distinct(cage, vertex_count); !fault.empty()) return fault;
    for (const CageUvs& uvs : cage.uvs) {
        if (std::string fault = check_uvs(cage, uvs); !fault.empty()) return fault;
    }
    const Corners corners = connect(cage);
    const std::vector<HalfEdge> halves = sorted_half_edges(cage, corners);
    std::vector<uint32_t> twins;
    if (std::string fault = pair_half_edges(cage, corners, halves, &twins); !fault.empty()) return fault;
    if (std::string fault = check_fans(cage, vertex_count, corners, twins); !fault.empty()) return fault;
    return check_sharpness(cage, vertex_count, halves);
}

}  // namespace zoe
