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

/// Motions that refitting takes well and badly: still, ripple, walk cycle, twist, explosion, permuted vertices; some of them
/// there and back, or the other way round; and a ball whose first pose is the worst to build a tree for.
std::vector<Sequence> deforming_sequences();

/// A ball whose triangles change places and return, again and again.
Sequence permuted_and_back();

/// A ball that swells and bends in waves; of every third seed its triangles change places again and again, too.
Sequence random_sequence(uint64_t seed);

/// The same triangles, each with vertices of its own.
Mesh from_triangles(const Mesh& mesh);

}  // namespace zoe::test
