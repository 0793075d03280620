#pragma once

#include <glm/ext/matrix_double3x3.hpp>

namespace zoe {

/// linear = rotation * stretch, to rounding.
struct Polar {
    glm::dmat3 rotation{1.0};  ///< Determinant 1.
    glm::dmat3 stretch{1.0};   ///< Symmetric; minus a positive matrix where `linear` mirrors.
};

/// Splits a linear map into a stretch along axes at right angles and a rotation. Where it flattens, the rotation is that of
/// the plane that is left, or the shortest way of a line, or, of nothing, none.
/// Requires   finite numbers.
/// Cost       a Jacobi eigenvalue iteration: about a microsecond.
/// Source     Shoemake, Duff. Matrix Animation and Polar Decomposition. Graphics Interface 1992. Deviation: by the
///            eigenvectors of the square, which a singular matrix has, too.
Polar polar(const glm::dmat3& linear);

}  // namespace zoe
