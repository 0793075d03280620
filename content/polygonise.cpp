#include "content/polygonise.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace zoe {
namespace {

using Field = std::function<float(const glm::vec3&)>;

constexpr uint32_t kNoVertex = 0xffffffffu;

glm::vec3 gradient(const Field& field, const glm::vec3& p, float h) {
    return glm::vec3(field(p + glm::vec3(h, 0, 0)) - field(p - glm::vec3(h, 0, 0)),
                     field(p + glm::vec3(0, h, 0)) - field(p - glm::vec3(0, h, 0)),
                     field(p + glm::vec3(0, 0, h)) - field(p - glm::vec3(0, 0, h))) /
           (2.0f * h);
}

// The field on the grid's points.
struct Grid {
    glm::ivec3 count;  // Points along each axis.
    glm::vec3 lo;
    float cell;
    std::vector<float> values;

    size_t at(const glm::ivec3& i) const {
        return (static_cast<size_t>(i.z) * static_cast<size_t>(count.y) + static_cast<size_t>(i.y)) *
                   static_cast<size_t>(count.x) +
               static_cast<size_t>(i.x);
    }
    glm::vec3 point(const glm::ivec3& i) const { return lo + cell * glm::vec3(i); }
};

Grid sample_grid(const Field& field, const Aabb& box, float cell) {
    Grid grid;
    grid.lo = box.lo;
    grid.cell = cell;
    grid.count = glm::ivec3(glm::ceil(box.extent() / cell)) + 1;
    grid.values.resize(static_cast<size_t>(grid.count.x) * static_cast<size_t>(grid.count.y) *
                       static_cast<size_t>(grid.count.z));
    for (int z = 0; z < grid.count.z; ++z) {
        for (int y = 0; y < grid.count.y; ++y) {
            for (int x = 0; x < grid.count.x; ++x) grid.values[grid.at({x, y, z})] = field(grid.point({x, y, z}));
        }
    }
    return grid;
}

// Mean of the points where the surface crosses a cell's edges; false where it crosses none.
bool crossing_mean(const Grid& grid, const glm::ivec3& cell, glm::vec3* mean) {
    glm::vec3 sum(0.0f);
    int crossings = 0;
    for (int axis = 0; axis < 3; ++axis) {
        for (int side = 0; side < 4; ++side) {
            glm::ivec3 a = cell;
            a[(axis + 1) % 3] += side & 1;
            a[(axis + 2) % 3] += side >> 1;
            glm::ivec3 b = a;
            b[axis] += 1;
            const float va = grid.values[grid.at(a)], vb = grid.values[grid.at(b)];
            if ((va < 0.0f) == (vb < 0.0f)) continue;
            sum += glm::mix(grid.point(a), grid.point(b), va / (va - vb));
            ++crossings;
        }
    }
    if (crossings == 0) return false;
    *mean = sum / static_cast<float>(crossings);
    return true;
}

}  // namespace

Mesh polygonise(const Field& field, const Aabb& box, float cell) {
    const Grid grid = sample_grid(field, box, cell);
    Mesh mesh;
    std::vector<uint32_t> vertex_of_cell(grid.values.size(), kNoVertex);
    for (int z = 0; z + 1 < grid.count.z; ++z) {
        for (int y = 0; y + 1 < grid.count.y; ++y) {
            for (int x = 0; x + 1 < grid.count.x; ++x) {
                glm::vec3 p;
                if (!crossing_mean(grid, {x, y, z}, &p)) continue;
                const glm::vec3 middle = p;
                for (int step = 0; step < 2; ++step) {  // Newton's steps along the gradient, kept near the cell.
                    const glm::vec3 g = gradient(field, p, 0.1f * cell);
                    const float squared = glm::dot(g, g);
                    if (squared > 1e-12f) p -= field(p) / squared * g;
                    p = glm::clamp(p, middle - 0.5f * cell, middle + 0.5f * cell);
                }
                vertex_of_cell[grid.at({x, y, z})] = static_cast<uint32_t>(mesh.positions.size());
                const glm::vec3 g = gradient(field, p, 0.25f * cell);
                mesh.positions.push_back(p);
                mesh.normals.push_back(glm::dot(g, g) > 1e-20f ? glm::normalize(g) : glm::vec3(0.0f));
            }
        }
    }
    // The four cells around an edge that the surface crosses make a quad.
    for (int z = 1; z + 1 < grid.count.z; ++z) {
        for (int y = 1; y + 1 < grid.count.y; ++y) {
            for (int x = 1; x + 1 < grid.count.x; ++x) {
                for (int axis = 0; axis < 3; ++axis) {
                    const glm::ivec3 a(x, y, z);
                    glm::ivec3 b = a;
                    b[axis] += 1;
                    const bool is_in = grid.values[grid.at(a)] < 0.0f;
                    if (is_in == (grid.values[grid.at(b)] < 0.0f)) continue;
                    glm::ivec3 du(0), dv(0);
                    du[(axis + 1) % 3] = 1;
                    dv[(axis + 2) % 3] = 1;
                    uint32_t q[4] = {vertex_of_cell[grid.at(a - du - dv)], vertex_of_cell[grid.at(a - dv)],
                                     vertex_of_cell[grid.at(a)], vertex_of_cell[grid.at(a - du)]};
                    if (!is_in) std::swap(q[1], q[3]);
                    if (std::find(q, q + 4, kNoVertex) != q + 4) continue;
                    mesh.corners.push_back({q[0], q[1], q[2]});
                    mesh.corners.push_back({q[0], q[2], q[3]});
                }
            }
        }
    }
    return mesh;
}

}  // namespace zoe
