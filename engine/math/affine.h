#pragma once

#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include "engine/math/aabb.h"

namespace zoe {

/// An affine map `p -> linear * p + translation`. Names read right to left: world_from_local * local_from_mesh.
struct Affine {
    glm::mat3 linear{1.0f};
    glm::vec3 translation{0.0f};

    glm::vec3 point(const glm::vec3& p) const { return linear * p + translation; }
    glm::vec3 vector(const glm::vec3& v) const { return linear * v; }
    friend bool operator==(const Affine&, const Affine&) = default;
};

/// The same in double precision: for products of many maps, and for places far from the origin.
struct DAffine {
    glm::dmat3 linear{1.0};
    glm::dvec3 translation{0.0};
};

/// Translation, then rotation, then scale, read from the left: what a glTF node or channel holds.
struct Trs {
    glm::vec3 translation{0.0f};
    glm::quat rotation{1.0f, 0.0f, 0.0f, 0.0f};  ///< (w, x, y, z); length 1.
    glm::vec3 scale{1.0f};
    friend bool operator==(const Trs&, const Trs&) = default;
};

Affine operator*(const Affine& a, const Affine& b);
Affine to_affine(const Trs& trs);

DAffine operator*(const DAffine& a, const DAffine& b);
DAffine to_daffine(const Affine& a);
/// The rotation is first made of length 1 to double precision; one of length 0 stays as it is.
DAffine to_daffine(const Trs& trs);
/// Rounded once, moved so that `origin` comes to lie at (0, 0, 0).
Affine to_affine(const DAffine& a, const glm::dvec3& origin);

/// Inverse, worked out in double precision.
/// Returns    false, and leaves `inverse` alone, where the map is singular or not finite (a zero scale hides a node).
bool invert(const Affine& a, Affine* inverse);

/// Translation, rotation and scale of a matrix; a mirror goes into scale.x. Shear is lost.
/// Returns    false where the map has a shear (or is singular) that TRS cannot hold; `trs` is then the nearest.
bool decompose(const Affine& a, Trs* trs);

/// A box around the image of a box. Conservative: padded by what rounding needs.
Aabb transform(const Affine& a, const Aabb& box);

bool is_finite(const Affine& a);

}  // namespace zoe
