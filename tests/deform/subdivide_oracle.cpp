#include "tests/deform/subdivide_oracle.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace zoe::test {

using Ring = PolygonMesh::Ring;

std::map<Edge, std::vector<uint32_t>> PolygonMesh::edge_faces() const {
    std::map<Edge, std::vector<uint32_t>> edges;
    for (uint32_t f = 0; f < faces.size(); ++f) {
        for (size_t k = 0; k < faces[f].size(); ++k)
            edges[edge_of(faces[f][k], faces[f][(k + 1) % faces[f].size()])].push_back(f);
    }
    return edges;
}

double PolygonMesh::sharpness(const Edge& edge, size_t face_count) const {
    if (face_count == 1) return kSharp;
    const auto found = creases.find(edge);
    if (found == creases.end()) return 0.0;
    return found->second >= 10.0 ? kSharp : found->second;
}

std::vector<Ring> PolygonMesh::rings() const {
    std::vector<Ring> result(points.size());
    for (uint32_t f = 0; f < faces.size(); ++f) {
        for (const uint32_t v : faces[f]) result[v].faces.push_back(f);
    }
    for (const auto& [edge, sides] : edge_faces()) {
        for (int k = 0; k < 2; ++k) {
            result[edge[k]].neighbours.push_back(edge[1 - k]);
            result[edge[k]].sharpness.push_back(sharpness(edge, sides.size()));
        }
    }
    for (const auto& [v, s] : corners) result[v].corner = s >= 10.0 ? kSharp : s;
    for (Ring& ring : result) {
        if (ring.faces.size() == 1) ring.corner = kSharp;
    }
    return result;
}

glm::dvec3 PolygonMesh::centre(uint32_t face) const {
    glm::dvec3 sum(0.0);
    for (const uint32_t v : faces[face]) sum += points[v];
    return sum / double(faces[face].size());
}

/// Where vertex v goes by the rule for these sharpnesses: corner, crease or smooth.
template <typename Smooth>
glm::dvec3 PolygonMesh::by_rule(uint32_t v, const Ring& ring, const std::vector<double>& sharp, double corner,
                                Smooth smooth) const {
    std::vector<uint32_t> along;
    for (size_t k = 0; k < sharp.size(); ++k) {
        if (sharp[k] > 0.0) along.push_back(ring.neighbours[k]);
    }
    if (corner > 0.0 || along.size() > 2) return points[v];
    if (along.size() == 2) return 0.75 * points[v] + 0.125 * (points[along[0]] + points[along[1]]);
    return smooth(v, ring);
}

template <typename Smooth>
glm::dvec3 PolygonMesh::vertex_point(uint32_t v, const Ring& ring, Smooth smooth) const {
    const glm::dvec3 before = by_rule(v, ring, ring.sharpness, ring.corner, smooth);
    std::vector<double> next;
    double sum = 0.0;
    int count = 0;
    const auto decay = [&](double s) {
        if (s > 0.0 && s <= 1.0) sum += s, ++count;
        return std::max(0.0, s - 1.0);
    };
    for (const double s : ring.sharpness) next.push_back(decay(s));
    const glm::dvec3 after = by_rule(v, ring, next, decay(ring.corner), smooth);
    const double share = count == 0 ? 1.0 : sum / count;
    return share * before + (1.0 - share) * after;
}

/// One level. `edge_rule(edge, sides)` is where a smooth edge's point goes; `smooth` where a smooth vertex goes.
template <typename EdgeRule, typename Smooth>
PolygonMesh PolygonMesh::refined(bool is_loop, EdgeRule edge_rule, Smooth smooth) const {
    PolygonMesh out;
    const std::vector<Ring> around = rings();
    for (uint32_t v = 0; v < points.size(); ++v) out.points.push_back(vertex_point(v, around[v], smooth));
    std::map<Edge, uint32_t> edge_points;
    for (const auto& [edge, sides] : edge_faces()) {
        const double s = std::min(1.0, sharpness(edge, sides.size()));
        const glm::dvec3 middle = 0.5 * (points[edge[0]] + points[edge[1]]);
        const uint32_t made = edge_points[edge] = uint32_t(out.points.size());
        out.points.push_back(s >= 1.0 ? middle : s * middle + (1.0 - s) * edge_rule(edge, sides));
        if (creases.contains(edge)) {
            const double left = sharpness(edge, sides.size()) == kSharp ? kSharp : creases.at(edge) - 1.0;
            for (const uint32_t end : edge) {
                if (left > 0.0) out.creases[edge_of(end, made)] = left;
            }
        }
    }
    for (const auto& [v, s] : corners) {
        if (s > 1.0) out.corners[v] = s >= 10.0 ? s : s - 1.0;
    }
    for (uint32_t v = 0; v < around.size(); ++v) {
        if (around[v].corner == kSharp) out.corners[v] = kSharp;
    }
    for (uint32_t f = 0; f < faces.size(); ++f) {
        const std::vector<uint32_t>& face = faces[f];
        const size_t size = face.size();
        std::vector<uint32_t> middles;
        for (size_t k = 0; k < size; ++k) middles.push_back(edge_points.at(edge_of(face[k], face[(k + 1) % size])));
        if (!is_loop) {
            out.points.push_back(centre(f));
            for (size_t k = 0; k < size; ++k)
                out.faces.push_back({face[k], middles[k], uint32_t(out.points.size() - 1), middles[(k + size - 1) % size]});
        } else {
            for (size_t k = 0; k < size; ++k) out.faces.push_back({face[k], middles[k], middles[(k + size - 1) % size]});
            out.faces.push_back(middles);
        }
    }
    return out;
}

PolygonMesh PolygonMesh::catmull_clark() const {
    return refined(
        false,
        [&](const Edge& edge, const std::vector<uint32_t>& sides) {
            return 0.25 * (points[edge[0]] + points[edge[1]] + centre(sides[0]) + centre(sides[1]));
        },
        [&](uint32_t v, const Ring& ring) {
            const double n = double(ring.neighbours.size());
            glm::dvec3 centres(0.0), middles(0.0);
            for (const uint32_t f : ring.faces) centres += centre(f) / n;
            for (const uint32_t other : ring.neighbours) middles += 0.5 * (points[v] + points[other]) / n;
            return (centres + 2.0 * middles + (n - 3.0) * points[v]) / n;
        });
}

PolygonMesh PolygonMesh::loop() const {
    return refined(
        true,
        [&](const Edge& edge, const std::vector<uint32_t>& sides) {
            glm::dvec3 point = 0.375 * (points[edge[0]] + points[edge[1]]);
            for (const uint32_t f : sides) {
                for (const uint32_t v : faces[f]) {
                    if (v != edge[0] && v != edge[1]) point += 0.125 * points[v];
                }
            }
            return point;
        },
        [&](uint32_t v, const Ring& ring) {
            const double n = double(ring.neighbours.size());
            const double inner = 0.375 + 0.25 * std::cos(2.0 * std::numbers::pi / n);
            const double beta = (0.625 - inner * inner) / n;
            glm::dvec3 point = (1.0 - n * beta) * points[v];
            for (const uint32_t other : ring.neighbours) point += beta * points[other];
            return point;
        });
}

Cage PolygonMesh::cage(SubdivisionScheme scheme) const {
    Cage made{.scheme = scheme};
    for (const std::vector<uint32_t>& face : faces) {
        made.face_sizes.push_back(uint32_t(face.size()));
        made.vertices.insert(made.vertices.end(), face.begin(), face.end());
    }
    for (const auto& [edge, s] : creases) {
        made.crease_edges.push_back(edge);
        made.crease_sharpness.push_back(float(s));
    }
    for (const auto& [v, s] : corners) {
        made.corner_vertices.push_back(v);
        made.corner_sharpness.push_back(float(s));
    }
    return made;
}

PolygonMesh cube() {
    PolygonMesh mesh;
    for (int k = 0; k < 8; ++k) mesh.points.push_back({k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1});
    mesh.faces = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
    return mesh;
}

PolygonMesh sheet(uint32_t n) {
    PolygonMesh mesh;
    for (uint32_t y = 0; y <= n; ++y) {
        for (uint32_t x = 0; x <= n; ++x) mesh.points.push_back({x, y, 0});
    }
    for (uint32_t y = 0; y < n; ++y) {
        for (uint32_t x = 0; x < n; ++x) {
            const uint32_t first = y * (n + 1) + x;
            mesh.faces.push_back({first, first + 1, first + n + 2, first + n + 1});
        }
    }
    return mesh;
}

PolygonMesh random_closed(Rng& rng, int edits, int kind) {
    PolygonMesh mesh = cube();
    const auto add_centre = [&](uint32_t f) {
        mesh.points.push_back(mesh.centre(f));
        return uint32_t(mesh.points.size() - 1);
    };
    const auto pierce = [&](uint32_t f) {
        const std::vector<uint32_t> face = mesh.faces[f];
        const uint32_t middle = add_centre(f);
        mesh.faces[f] = {face[0], face[1], middle};
        for (size_t k = 1; k < face.size(); ++k) mesh.faces.push_back({face[k], face[(k + 1) % face.size()], middle});
    };
    for (int round = 0; round < edits; ++round) {
        const uint32_t f = rng.below(uint32_t(mesh.faces.size()));
        if (rng.below(2) == 0) {
            pierce(f);
            continue;
        }
        const std::vector<uint32_t> face = mesh.faces[f];
        const glm::dvec3 middle = mesh.centre(f);
        for (size_t k = 0; k < face.size(); ++k) {
            mesh.faces[f][k] = uint32_t(mesh.points.size());
            mesh.points.push_back(0.5 * (middle + mesh.points[face[k]]));
        }
        for (size_t k = 0; k < face.size(); ++k) {
            const size_t next = (k + 1) % face.size();
            mesh.faces.push_back({face[k], face[next], mesh.faces[f][next], mesh.faces[f][k]});
        }
    }
    if (kind == 3) {
        for (uint32_t f = uint32_t(mesh.faces.size()); f-- > 0;) {
            if (mesh.faces[f].size() > 3) pierce(f);
        }
    }
    if (kind == 4) mesh = mesh.catmull_clark();
    for (glm::dvec3& p : mesh.points) {
        // As floats, so that the engine starts from the same numbers.
        for (int axis = 0; axis < 3; ++axis) p[axis] = float(p[axis] + rng.uniform(-0.05f, 0.05f));
    }
    return mesh;
}

}  // namespace zoe::test
