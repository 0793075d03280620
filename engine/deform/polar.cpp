#include "engine/deform/polar.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <glm/ext/vector_double3.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace zoe {

namespace {

constexpr int kMostSweeps = 16;  // Five are enough: errors are squared in each.
constexpr double kFlat = 1e-7;   // An extent below this share of the largest has no direction in floats.

// Turns the columns of `vectors` until they are eigenvectors of a symmetric matrix.
glm::dmat3 eigenvectors(glm::dmat3 m) {
    glm::dmat3 vectors(1.0);
    for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
        const double diagonal = std::abs(m[0][0]) + std::abs(m[1][1]) + std::abs(m[2][2]);
        if (std::abs(m[0][1]) + std::abs(m[0][2]) + std::abs(m[1][2]) <= 1e-17 * diagonal) break;
        for (int p = 0; p < 2; ++p) {
            for (int q = p + 1; q < 3; ++q) {
                if (m[p][q] == 0.0) continue;
                // The smaller of the two angles that make m[p][q] zero.
                const double half = (m[q][q] - m[p][p]) / (2.0 * m[p][q]);
                const double tangent = std::copysign(1.0, half) / (std::abs(half) + std::hypot(half, 1.0));
                const double cosine = 1.0 / std::hypot(tangent, 1.0), sine = tangent * cosine;
                glm::dmat3 turn(1.0);
                turn[p][p] = turn[q][q] = cosine;
                turn[q][p] = sine;
                turn[p][q] = -sine;
                m = glm::transpose(turn) * m * turn;
                vectors = vectors * turn;
            }
        }
    }
    return vectors;
}

// Of two directions.
glm::dmat3 shortest_turn(const glm::dvec3& from, const glm::dvec3& to) {
    const double cosine = glm::dot(from, to);
    if (cosine < -1.0 + 1e-12) {  // Half a turn, about anything across.
        const glm::dvec3 beside = std::abs(from.x) < 0.7 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
        const glm::dvec3 axis = glm::normalize(glm::cross(from, beside));
        return 2.0 * glm::outerProduct(axis, axis) - glm::dmat3(1.0);
    }
    const glm::dvec3 axis = glm::cross(from, to);
    const glm::dmat3 across(0.0, axis.z, -axis.y, -axis.z, 0.0, axis.x, axis.y, -axis.x, 0.0);
    return glm::dmat3(1.0) + across + across * across / (1.0 + cosine);
}

}  // namespace

Polar polar(const glm::dmat3& linear) {
    // Scaled to 1, so that squares neither vanish nor overflow.
    double size = 0.0;
    for (int column = 0; column < 3; ++column) {
        for (int row = 0; row < 3; ++row) size = std::max(size, std::abs(linear[column][row]));
    }
    if (size == 0.0) return {glm::dmat3(1.0), glm::dmat3(0.0)};
    const glm::dmat3 unit = linear / size;
    const glm::dmat3 v = eigenvectors(glm::transpose(unit) * unit);
    const glm::dmat3 image = unit * v;  // Columns at right angles to each other.
    std::array<int, 3> order = {0, 1, 2};
    std::sort(order.begin(), order.end(), [&](int a, int b) { return glm::length(image[a]) > glm::length(image[b]); });
    const glm::dvec3 &v0 = v[order[0]], &v1 = v[order[1]];
    const glm::dvec3 u0 = glm::normalize(image[order[0]]);
    const glm::dvec3 across = image[order[1]] - glm::dot(image[order[1]], u0) * u0;
    glm::dmat3 rotation;
    if (glm::length(across) <= kFlat * glm::length(image[order[0]])) {
        rotation = shortest_turn(v0, u0);
    } else {
        const glm::dvec3 u1 = glm::normalize(across), u2 = glm::cross(u0, u1), v2 = glm::cross(v0, v1);
        const bool is_mirror = glm::dot(unit * v2, u2) < -kFlat * glm::length(image[order[0]]);
        const double sign = is_mirror ? -1.0 : 1.0;
        rotation = glm::dmat3(sign * u0, sign * u1, u2) * glm::transpose(glm::dmat3(v0, v1, v2));
    }
    return {rotation, glm::transpose(rotation) * linear};
}

}  // namespace zoe
