#pragma once

#include <span>

#include "engine/scene/mesh.h"

namespace zoe {

/// A piece of a body that follows a joint: a capsule whose ends may differ in size.
struct BodyPiece {
    int joint;
    glm::vec3 a, b;
    float radius_a, radius_b;
};

/// Makes one smooth skin around all pieces. Each vertex follows the joints of the pieces near it, four at most, with
/// weights that fade over about `softness` metres.
/// blend      how far pieces melt into each other. cell: size of the mesh's quads. All in metres.
Mesh make_body(std::span<const BodyPiece> pieces, int joint_count, float cell, float blend, float softness);

}  // namespace zoe
