#include "engine/frame/bounds_at.h"

#include <cmath>
#include <optional>
#include <span>
#include <stdexcept>
#include <vector>

#include "engine/frame/frame.h"
#include "engine/frame/frame_state.h"
#include "engine/math/parallel.h"

namespace zoe {

namespace {

constexpr size_t kGrain = 16384;

// Those that are not finite bound nothing, as in a tree.
Aabb bounds_of(std::span<const glm::vec3> positions, std::span<const glm::uvec3> corners) {
    std::vector<Aabb> parts((corners.size() + kGrain - 1) / kGrain);
    parallel_for(0, corners.size(), kGrain, [&](size_t begin, size_t end) {
        Aabb box;
        for (size_t k = begin; k < end; ++k) {
            const glm::vec3 &a = positions[corners[k].x], &b = positions[corners[k].y], &c = positions[corners[k].z];
            if (is_finite(a) && is_finite(b) && is_finite(c)) box.extend(bounds(Triangle{a, b, c, 0}));
        }
        parts[begin / kGrain] = box;
    });
    Aabb box;
    for (const Aabb& part : parts) box.extend(part);
    return box;
}

// Of the frame whose vertices are there; their trees do not follow.
Aabb bounds(const Scene& scene, FrameState* state) {
    state->shared_bounds.resize(scene.meshes.size());
    Aabb all;
    for (Shape& shape : state->shapes) {
        const std::span<const glm::uvec3> corners = shape.shown->corners;
        if (!shape.is_shared()) {
            if (shape.is_changed) shape.has_blas = false;
            all.extend(bounds_world(shape, *state, bounds_of(shape.positions, corners)));
            continue;
        }
        std::optional<Aabb>& shared = state->shared_bounds[index(shape.mesh)];
        if (!shared) shared = bounds_of(shape.positions, corners);
        all.extend(bounds_world(shape, *state, *shared));
    }
    return all;
}

}  // namespace

Aabb bounds_at(Scene& scene, double time_s) {
    if (!std::isfinite(time_s)) throw std::invalid_argument("bounds_at: the time is not finite");
    FrameStats ignored;
    FrameInMaking frame(scene, &ignored);
    animate(scene, time_s, &frame.state());
    deform(scene, &frame.state(), &ignored);
    const Aabb all = bounds(scene, &frame.state());
    frame.finish();
    return all;
}

}  // namespace zoe
