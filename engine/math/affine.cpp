#include "engine/math/affine.h"

#include <cmath>

namespace zoe {

Affine operator*(const Affine& a, const Affine& b) {
    return {a.linear * b.linear, a.point(b.translation)};
}

Affine to_affine(const Trs& trs) {
    glm::mat3 linear = glm::mat3_cast(trs.rotation);
    linear[0] *= trs.scale.x;
    linear[1] *= trs.scale.y;
    linear[2] *= trs.scale.z;
    return {linear, trs.translation};
}

DAffine operator*(const DAffine& a, const DAffine& b) {
    return {a.linear * b.linear, a.linear * b.translation + a.translation};
}

DAffine to_daffine(const Affine& a) {
    return {glm::dmat3(a.linear), glm::dvec3(a.translation)};
}

DAffine to_daffine(const Trs& trs) {
    glm::dquat rotation(trs.rotation);
    const double length = glm::length(rotation);
    if (length > 0.0) rotation /= length;
    glm::dmat3 linear = glm::mat3_cast(rotation);
    for (int axis = 0; axis < 3; ++axis) linear[axis] *= static_cast<double>(trs.scale[axis]);
    return {linear, glm::dvec3(trs.translation)};
}

Affine to_affine(const DAffine& a, const glm::dvec3& origin) {
    return {glm::mat3(a.linear), glm::vec3(a.translation - origin)};
}

bool is_finite(const Affine& a) {
    for (int column = 0; column < 3; ++column) {
        for (int row = 0; row < 3; ++row) {
            if (!std::isfinite(a.linear[column][row])) return false;
        }
        if (!std::isfinite(a.translation[column])) return false;
    }
    return true;
}

bool invert(const Affine& a, Affine* inverse) {
    const glm::dmat3 m(a.linear);
    // Rows of the inverse are cross products of columns over the determinant. The determinant of a well-formed matrix of
    // scale 1e-18 is 1e-54: fine in double, and singular only when it is truly 0.
    const glm::dvec3 row0 = glm::cross(m[1], m[2]);
    const glm::dvec3 row1 = glm::cross(m[2], m[0]);
    const glm::dvec3 row2 = glm::cross(m[0], m[1]);
    const double determinant = glm::dot(m[0], row0);
    // A matrix that is singular up to the rounding of its floats has no inverse that means anything.
    const double bound = glm::length(m[0]) * glm::length(m[1]) * glm::length(m[2]);
    if (!(std::abs(determinant) > 1e-12 * bound)) return false;
    const glm::dmat3 inverse_linear = glm::transpose(glm::dmat3(row0, row1, row2)) / determinant;
    const Affine result{glm::mat3(inverse_linear), glm::vec3(-(inverse_linear * glm::dvec3(a.translation)))};
    if (!is_finite(result)) return false;
    *inverse = result;
    return true;
}

bool decompose(const Affine& a, Trs* trs) {
    const glm::dmat3 m(a.linear);
    glm::dvec3 scale(glm::length(m[0]), glm::length(m[1]), glm::length(m[2]));
    trs->translation = a.translation;
    trs->rotation = glm::quat(1.0f, 0.0f, 0.0f, 0.0f);
    trs->scale = glm::vec3(scale);
    if (!(scale.x > 0 && scale.y > 0 && scale.z > 0)) return false;
    if (glm::determinant(m) < 0) scale.x = -scale.x;
    const glm::dmat3 rotation(m[0] / scale.x, m[1] / scale.y, m[2] / scale.z);
    const double shear = std::abs(glm::dot(rotation[0], rotation[1])) + std::abs(glm::dot(rotation[1], rotation[2])) +
                         std::abs(glm::dot(rotation[2], rotation[0]));
    trs->rotation = glm::quat(glm::normalize(glm::quat_cast(rotation)));
    trs->scale = glm::vec3(scale);
    return shear < 1e-4;
}

Aabb transform(const Affine& a, const Aabb& box) {
    if (box.is_empty()) return {};
    // In double: centre and half extent, then the absolute matrix. What is left to pad is the rounding of a point that is
    // transformed in float (about 4 ulp of the largest term) and of the result (1 ulp).
    const glm::dmat3 m(a.linear);
    const glm::dvec3 lo(box.lo), hi(box.hi);
    const glm::dvec3 centre = 0.5 * (lo + hi), half = 0.5 * (hi - lo);
    Aabb result;
    for (int axis = 0; axis < 3; ++axis) {
        double c = a.translation[axis], h = 0.0, size = std::abs(c);
        for (int k = 0; k < 3; ++k) {
            c += m[k][axis] * centre[k];
            h += std::abs(m[k][axis]) * half[k];
            size += std::abs(m[k][axis]) * glm::max(std::abs(lo[k]), std::abs(hi[k]));
        }
        const double pad = 6.0 * 5.9604645e-8 * size;
        result.lo[axis] = static_cast<float>(c - h - pad);
        result.hi[axis] = static_cast<float>(c + h + pad);
    }
    return result;
}

}  // namespace zoe
