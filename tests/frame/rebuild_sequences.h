#pragma once

#include <functional>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "engine/scene/mesh.h"

namespace zoe::test {

/// Vertices frame by frame; the triangles stay.
struct Sequence {
    std::string name;
    std::vector<glm::uvec3> corners;
    std::vector<std::vector<glm::vec3>> frames;
};

/// Motions that refitting takes well and badly: still, ripple, walk cycle, twist, explosion, permuted vertices, and the last
/// three there and back.
std::vector<Sequence> deforming_sequences();

/// The same triangles, each with vertices of its own.
Mesh from_triangles(const Mesh& mesh);

/// What tracing the trees of a sequence costs: costs[b][f - b] is the SAH cost at frame f of the tree built at frame b.
using CostTable = std::vector<std::vector<double>>;
CostTable record_costs(const Sequence& sequence);

}  // namespace zoe::test
