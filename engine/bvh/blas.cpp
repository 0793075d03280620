#include "engine/bvh/blas.h"

#include <atomic>
#include <cassert>
#include <cmath>
#include <utility>

#include "engine/bvh/build_binned.h"
#include "engine/bvh/build_sweep.h"
#include "engine/bvh/refit.h"
#include "engine/math/parallel.h"

namespace zoe {

namespace {

constexpr size_t kGrain = 4096;

bool is_finite(const Triangle& t) {
    return zoe::is_finite(t.a) && zoe::is_finite(t.b) && zoe::is_finite(t.c);
}

Triangle triangle_at(std::span<const glm::vec3> positions, const glm::uvec3& corners, uint32_t primitive) {
    return {positions[corners.x], positions[corners.y], positions[corners.z], primitive};
}

// An empty box for a triangle that is not finite: it bounds nothing and is never hit.
Aabb box_of(const Triangle& triangle) {
    return is_finite(triangle) ? bounds(triangle) : Aabb{};
}

void fit_boxes(std::span<const glm::vec3> positions, std::span<const glm::uvec3> corners, Blas* blas) {
    blas->boxes.resize(corners.size());
    parallel_for(0, corners.size(), kGrain, [&](size_t begin, size_t end) {
        for (size_t k = begin; k < end; ++k) blas->boxes[k] = box_of(triangle_at(positions, corners[k], 0));
    });
}

// Puts this frame's triangles into the order of the leaves.
void place_triangles(std::span<const glm::vec3> positions, std::span<const glm::uvec3> corners, Blas* blas) {
    blas->triangles.resize(corners.size());
    std::atomic<uint32_t> not_finite_count{0};
    parallel_for(0, corners.size(), kGrain, [&](size_t begin, size_t end) {
        uint32_t not_finite_here = 0;
        for (size_t slot = begin; slot < end; ++slot) {
            const uint32_t primitive = blas->bvh.primitives[slot];
            blas->triangles[slot] = triangle_at(positions, corners[primitive], primitive);
            if (!is_finite(blas->triangles[slot])) ++not_finite_here;
        }
        not_finite_count += not_finite_here;
    });
    blas->not_finite_count = not_finite_count;
}

}  // namespace

void build_blas(std::span<const glm::vec3> positions, std::span<const glm::uvec3> corners, BlasBuilder builder, Blas* blas) {
    fit_boxes(positions, corners, blas);
    blas->bvh = builder == BlasBuilder::kSweep ? build_sweep(blas->boxes, {}, std::move(blas->bvh))
                                               : build_binned(blas->boxes, {}, std::move(blas->bvh));
    place_triangles(positions, corners, blas);
}

void refit_blas(std::span<const glm::vec3> positions, std::span<const glm::uvec3> corners, Blas* blas) {
    assert(corners.size() == blas->triangles.size());
    fit_boxes(positions, corners, blas);
    refit(blas->bvh, blas->boxes);
    place_triangles(positions, corners, blas);
}

}  // namespace zoe
