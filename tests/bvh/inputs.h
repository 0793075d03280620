#pragma once

#include <functional>
#include <string>
#include <vector>

#include "engine/bvh/blas.h"
#include "engine/bvh/traverse.h"
#include "engine/math/rng.h"

namespace zoe::test {

struct TestMesh {
    std::string name;
    std::vector<glm::vec3> positions;
    std::vector<glm::uvec3> corners;

    void add(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c);
    Triangle triangle(uint32_t primitive) const;
    /// Of the finite triangles; empty boxes for the others, as the builders take them.
    std::vector<Aabb> boxes() const;
};

TestMesh random_soup(int triangle_count, float size, uint64_t seed);
/// Large triangles across many small ones: what spatial splits are for.
TestMesh large_among_small(uint64_t seed);

/// Triangle k stands at z = k, and is hit from above and below.
TestMesh stack_of_triangles(int count);
/// A tree as deep as it has boxes: every inner node has one leaf and the rest of the chain. A ray from above goes down the
/// chain over a stack of triangles first, and keeps every leaf for later.
Bvh chain_over(const std::vector<Aabb>& boxes);

/// Every kind of input that builders are known to fail on.
std::vector<TestMesh> nasty_meshes();

struct NamedBuilder {
    std::string name;
    std::function<Bvh(std::span<const Aabb>)> build;
    bool may_be_deep = false;         ///< Depth is not bounded by the logarithm.
    bool needs_finite_boxes = false;  ///< Takes no empty or non-finite box.
};

/// Every builder, with usual and with extreme settings.
std::vector<NamedBuilder> all_builders();
bool accepts(const NamedBuilder& builder, std::span<const Aabb> boxes);

/// A BLAS with a tree from anywhere.
Blas blas_from(const Bvh& bvh, const TestMesh& mesh);
Blas blas_from(const StaticBvh& bvh, const TestMesh& mesh);

/// The closest hit by trying every triangle in order with the engine's kernel: ties go to the lower primitive.
BlasHit brute_force(const TestMesh& mesh, const Ray& ray);
BlasHit closest_hit(const Blas& blas, const Ray& ray);
bool any_hit(const Blas& blas, const Ray& ray);

/// Equal to the last bit.
bool is_same(const BlasHit& a, const BlasHit& b);
std::string to_string(const BlasHit& hit);

/// Rays at corners, edges and insides of a mesh's triangles, parallel to axes, past it, and with short ends.
std::vector<Ray> rays_at(const TestMesh& mesh, int count, uint64_t seed);

}  // namespace zoe::test
