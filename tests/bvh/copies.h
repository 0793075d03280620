#pragma once

#include <vector>

#include "engine/bvh/traverse.h"
#include "tests/bvh/inputs.h"

namespace zoe::test {

/// What the tree over the copies holds.
enum class Top { kWholeBoxes, kTightBoxes, kParts };

/// One mesh, placed many times, under a top level.
class Copies {
public:
    /// box_scale  less than 1: the copies' boxes in the world hold only their middles, and cut off what stands out.
    Copies(TestMesh mesh, const std::vector<Affine>& world_from_local, float box_scale = 1.0f, Top top = Top::kWholeBoxes);
    /// blas       any tree over the mesh.
    Copies(TestMesh mesh, Blas blas, const std::vector<Affine>& world_from_local, float box_scale = 1.0f,
           Top top = Top::kWholeBoxes);
    Copies(const Copies&) = delete;

    const TwoLevels& levels() const { return levels_; }
    const std::vector<PlacedBlas>& placed() const { return placed_; }
    /// [placed]
    const std::vector<Aabb>& bounds() const { return bounds_; }
    const TestMesh& mesh() const { return mesh_; }

    /// By trying every triangle of every copy.
    RawHit brute_force(const Ray& ray) const;

private:
    void improve(size_t copy, const SlabRay& world, const Ray& ray, RawHit* best) const;

    TestMesh mesh_;
    Blas blas_;
    WideBvh top_;
    std::vector<PlacedBlas> placed_, traced_;  // Copies; what the tree holds of them.
    std::vector<Aabb> bounds_, traced_bounds_;
    TwoLevels levels_;
};

/// Equal to the last bit.
bool is_same(const RawHit& a, const RawHit& b);

/// Batches find what brute force does, and so do single rays, with every instruction set.
/// Returns    how many of the rays hit something.
int expect_batches_right(const Copies& copies, const std::vector<Ray>& rays);

std::vector<Affine> random_affines(int count, double scale_lo, double scale_hi, float translation, uint64_t seed);

}  // namespace zoe::test
