#pragma once

#include <string>
#include <vector>

#include "engine/frame/frame.h"
#include "engine/math/rng.h"

namespace zoe::test {

/// A closed ball of radius 1 about the origin: `slices` around, half as many from pole to pole.
Mesh ball(int slices);
/// One triangle that faces +z at z = 0 and holds the origin.
Mesh facing_triangle();

/// A node that shows a mesh, placed by a matrix.
NodeId add_node(Scene& scene, MeshId mesh, const Affine& local, NodeId parent = kNone<NodeId>);
Affine placed(const glm::vec3& translation, const glm::vec3& scale = glm::vec3(1.0f));

/// The warning that holds some text, and how often it was given; empty where there is none.
std::string warning_with(const Scene& scene, const std::string& text);
uint64_t warning_count(const Scene& scene, const std::string& text);

/// Nothing in it is NaN, and a hit's numbers are in their ranges.
bool is_sane(const Hit& hit, const Ray& ray);

/// The closest hit by brute force in double: every triangle's corners taken to the world exactly, no engine code.
struct ExactHit {
    double t = 0.0;
    uint32_t node = 0xffffffffu;
    double edge = 0.0;      ///< The smallest of the three weights: how far inside the triangle, 0 on an edge.
    double cosine = 0.0;    ///< Between ray and normal: near 0 the ray grazes.
    double second_t = 0.0;  ///< Of the next triangle along the ray.
};
ExactHit exact_hit(const Tlas& tlas, const Ray& ray);

}  // namespace zoe::test
